"""The observer: every constant of the perceptual chain, read from the calibrated parameter file.

The file `data/observer.toml` is written by `thermicon.perception.calibrate`; each number there
says what it was calibrated on, or that it is assumed, and carries its interval.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Literal, get_args

from thermicon.circuit.records import RecordError, Table, load_records

Channel = Literal["cold", "warm"]
Norm = Literal["max", "rms", "integral"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)
NORMS: tuple[Norm, ...] = get_args(Norm)
DATA = Path(__file__).parent / "data"
FOREARM_SITES = ("forearm", "wrist", "arm")


@dataclass(frozen=True, slots=True)
class Receptor:
    """Constants of one channel: times s, drive K, velocity m/s, exponent of area (1)."""

    slow_s: float
    fast_s: float
    fast_weight: float
    threshold_drive_K: float
    velocity_m_per_s: float
    area_exponent: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.fast_weight <= 1.0:
            raise ValueError(f"fast_weight = {self.fast_weight:g} must lie in 0 to 1")
        for name in ("slow_s", "fast_s", "threshold_drive_K", "velocity_m_per_s"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} = {getattr(self, name):g} must be above 0")


@dataclass(frozen=True, slots=True)
class Observer:
    """A nominal person: SI units inside, sensation in units of the sensory noise (d′).

    `a` is the slope of sensation, `criterion` the yes/no criterion in d′, `memory_noise` the noise
    of identification in log units of sensation for each norm of distance.

    >>> person = Observer.load()
    >>> person.receptor("cold").velocity_m_per_s
    2.1
    """

    cold: Receptor
    warm: Receptor
    integration_s: float
    neutral_low_C: float
    neutral_high_C: float
    a: float
    reference_area_m2: float
    criterion: float
    noise_correlation_s: float
    path_hand_m: float
    path_forearm_m: float
    decision_s: float
    onset_uncertainty_s: float
    lapse: float
    memory_max: float
    memory_rms: float
    memory_integral: float

    def __post_init__(self) -> None:
        if not self.a > 0.0:
            raise ValueError(f"the slope of sensation a = {self.a:g} must be above 0")
        if not self.neutral_low_C < self.neutral_high_C:
            raise ValueError(f"the neutral zone {self.neutral_low_C:g} to {self.neutral_high_C:g} °C is empty")
        if not 0.0 <= self.lapse < 1.0:
            raise ValueError(f"lapse = {self.lapse:g} must lie in 0 to 1")

    @classmethod
    def load(cls, path: Path | str | None = None) -> Observer:
        """The shipped observer, or one from another parameter file. Raises `RecordError`."""
        return _shipped() if path is None else cls.from_table(load_records(Path(path)))

    @classmethod
    def from_table(cls, table: Table) -> Observer:
        """Build from calibrated records; a missing one is a `RecordError` that names it."""

        def number(quantity: str, channel: str = "", site: str = "", method: str = "") -> float:
            return table.one(quantity, channel=channel, site=site, method=method).central

        def receptor(channel: Channel) -> Receptor:
            fast = channel == "cold"
            return Receptor(
                slow_s=number("slow adaptation time constant", channel),
                fast_s=number("fast adaptation time constant", channel) if fast else 1.0,
                fast_weight=number("fast adaptation weight", channel) if fast else 0.0,
                threshold_drive_K=number("drive of a threshold step", channel),
                velocity_m_per_s=number("conduction velocity", channel),
                area_exponent=number("area exponent", channel),
            )

        low, high = table.one("neutral zone").interval
        return cls(
            cold=receptor("cold"),
            warm=receptor("warm"),
            integration_s=number("integration time constant"),
            neutral_low_C=low,
            neutral_high_C=high,
            a=number("slope of sensation"),
            reference_area_m2=number("reference area") * 1e-4,
            criterion=number("criterion"),
            noise_correlation_s=number("noise correlation time"),
            path_hand_m=number("path length to the cord", site="hand"),
            path_forearm_m=number("path length to the cord", site="forearm"),
            decision_s=number("decision time"),
            onset_uncertainty_s=number("onset uncertainty"),
            lapse=number("lapse rate"),
            memory_max=number("memory noise", method="max"),
            memory_rms=number("memory noise", method="rms"),
            memory_integral=number("memory noise", method="integral"),
        )

    @property
    def b(self) -> float:
        """Second constant of sensation, so that a threshold-size fast step gives d′ = 1."""
        return 1.0 / math.expm1(1.0 / self.a)

    def receptor(self, channel: Channel) -> Receptor:
        """Constants of one channel."""
        return self.cold if channel == "cold" else self.warm

    def path_m(self, site: str) -> float:
        """Path to the cord, m: forearm sites have their own, every other site has the hand's."""
        return self.path_forearm_m if any(name in site.lower() for name in FOREARM_SITES) else self.path_hand_m

    def memory_noise(self, norm: Norm) -> float:
        """Memory noise of a norm, log units."""
        return {"max": self.memory_max, "rms": self.memory_rms, "integral": self.memory_integral}[check_norm(norm)]

    def __repr__(self) -> str:
        return (
            f"Observer(a {self.a:.3g}, criterion {self.criterion:.3g} d′, "
            f"memory noise {self.memory_max:.3g} log units, "
            f"threshold drive cold {self.cold.threshold_drive_K:.3g} K, warm {self.warm.threshold_drive_K:.3g} K)"
        )


def check_norm(norm: str) -> Norm:
    """The norm itself, or an error that lists the norms there are."""
    for known in NORMS:
        if norm == known:
            return known
    raise ValueError(f"there is no norm {norm!r}: choose one of {', '.join(NORMS)}")


def load_thresholds() -> Table:
    """The shipped table of published numbers.

    >>> load_thresholds().one("detection threshold", channel="cold", site="thenar").central
    0.11
    """
    return load_records(DATA / "thresholds.toml")


@lru_cache(maxsize=1)
def _shipped() -> Observer:
    path = DATA / "observer.toml"
    if not path.exists():
        raise RecordError("observer.toml: not there: write it with python -m thermicon.perception.calibrate")
    return Observer.from_table(load_records(path))
