"""The observer: every constant of the perceptual chain, read from the calibrated parameter file.

The file `data/observer.toml` is written by `thermicon.perception.validation.calibrate`; each number there
says what it was calibrated on, or that it is assumed, and carries its interval.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from thermicon.circuit.records import RecordError, Table, load_records

from .channels import CHANNELS, NORMS, Channel, Norm, check_norm
from .variants import Model, Variable, check_variant, drive_unit, source_of

__all__ = ["CHANNELS", "NORMS", "Channel", "Norm", "Observer", "Receptor", "check_norm", "load_thresholds"]
DATA = Path(__file__).parents[1] / "data"
FOREARM_SITES = ("forearm", "wrist", "arm")


@dataclass(frozen=True, slots=True)
class Receptor:
    """Constants of one channel: times s, velocity m/s, exponents and factors 1.

    `threshold_drive` is the drive that feels like a threshold, in K, W/m² or impulses as the
    observer's variant has it. `gain_scale` is in multiples of it. `forearm_factor` multiplies
    thresholds at sites of the forearm. `neutral_flux` (W/m² into the skin) bounds complete
    adaptation where heat flow is what is felt; static and dynamic gain are those of Ring & de Dear.
    """

    slow_s: float
    fast_s: float
    fast_weight: float
    threshold_drive: float
    velocity_m_per_s: float
    area_exponent: float
    gain_strength: float = 0.0
    gain_s: float = 5.0
    gain_scale: float = 1.0
    forearm_factor: float = 1.0
    neutral_flux: tuple[float, float] | None = None
    static_Hz_per_K: float = 2.0
    dynamic_Hz_s_per_K: float = 60.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.fast_weight <= 1.0:
            raise ValueError(f"fast_weight = {self.fast_weight:g} must lie in 0 to 1")
        if not self.gain_strength >= 0.0:
            raise ValueError(f"gain_strength = {self.gain_strength:g} must be 0 or more")
        for name in ("slow_s", "fast_s", "threshold_drive", "velocity_m_per_s", "gain_s", "gain_scale"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} = {getattr(self, name):g} must be above 0")
        if not self.forearm_factor > 0.0:
            raise ValueError(f"forearm_factor = {self.forearm_factor:g} must be above 0")
        if self.neutral_flux is not None and not self.neutral_flux[0] < self.neutral_flux[1]:
            raise ValueError(
                f"the neutral heat flow {self.neutral_flux[0]:g} to {self.neutral_flux[1]:g} W/m² is empty"
            )


@dataclass(frozen=True, slots=True)
class Observer:
    """A nominal person: SI units inside, sensation in units of the sensory noise (d′).

    `a` is the slope of sensation, `criterion` the yes/no criterion in d′, `memory_noise` the noise
    of identification in log units of sensation for each norm of distance. `variable` says what
    the receptors go by, temperature or heat flow, and `model` how.

    >>> person = Observer.load()
    >>> person.receptor("cold").velocity_m_per_s
    2.1
    >>> Observer.load(variable="heat flow").drive_unit
    'W/m²'
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
    variable: Variable = "temperature"
    model: Model = "adapting"
    count_s: float = 20.0
    static_from_C: float = 33.0

    def __post_init__(self) -> None:
        if not self.a > 0.0:
            raise ValueError(f"the slope of sensation a = {self.a:g} must be above 0")
        if not self.neutral_low_C < self.neutral_high_C:
            raise ValueError(f"the neutral zone {self.neutral_low_C:g} to {self.neutral_high_C:g} °C is empty")
        if not 0.0 <= self.lapse < 1.0:
            raise ValueError(f"lapse = {self.lapse:g} must lie in 0 to 1")
        if not self.count_s > 0.0:
            raise ValueError(f"impulses must be counted over more than {self.count_s:g} s")
        check_variant(self.variable, self.model)
        if self.variable == "heat flow" and (self.cold.neutral_flux is None or self.warm.neutral_flux is None):
            raise ValueError("an observer of heat flow needs the neutral heat flow of both channels")

    @classmethod
    def load(
        cls, path: Path | str | None = None, *, variable: Variable = "temperature", model: Model = "adapting"
    ) -> Observer:
        """The shipped observer, or one from another parameter file, in one of its variants.

        Raises `RecordError` for a file without what is needed, `ValueError` for a variant that is not there.
        """
        if path is None:
            return _shipped(variable, model)
        return cls.from_table(load_records(Path(path)), variable=variable, model=model)

    @classmethod
    def from_table(cls, table: Table, *, variable: Variable = "temperature", model: Model = "adapting") -> Observer:
        """Build from calibrated records; a missing one is a `RecordError` that names it."""
        check_variant(variable, model)
        variant = source_of(variable, model)

        def number(quantity: str, channel: str = "", site: str = "", method: str = "") -> float:
            return table.one(quantity, channel=channel, site=site, method=method).central

        def receptor(channel: Channel) -> Receptor:
            fast = channel == "cold"
            flux = table.one("neutral heat flow", channel=channel).interval if variable == "heat flow" else None
            return Receptor(
                slow_s=number("slow adaptation time constant", channel),
                fast_s=number("fast adaptation time constant", channel) if fast else 1.0,
                fast_weight=number("fast adaptation weight", channel) if fast else 0.0,
                threshold_drive=number(f"drive of a threshold step{variant}", channel),
                velocity_m_per_s=number("conduction velocity", channel),
                area_exponent=number("area exponent", channel),
                gain_strength=number(f"gain control strength{variant}") if model == "adapting" else 0.0,
                gain_s=number("gain control time constant"),
                gain_scale=number("gain control scale"),
                forearm_factor=number(f"threshold at the wrist{variant}", channel),
                neutral_flux=flux,
                static_Hz_per_K=abs(number("static gain", channel)),
                dynamic_Hz_s_per_K=abs(number("dynamic gain", channel)),
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
            memory_max=number(f"memory noise{variant}", method="max"),
            memory_rms=number(f"memory noise{variant}", method="rms"),
            memory_integral=number(f"memory noise{variant}", method="integral"),
            variable=variable,
            model=model,
            count_s=number("window of counted impulses"),
            static_from_C=number("start of static discharge"),
        )

    @property
    def b(self) -> float:
        """Second constant of sensation, so that a threshold-size fast step gives d′ = 1."""
        return 1.0 / math.expm1(1.0 / self.a)

    @property
    def drive_unit(self) -> str:
        """Unit of receptor drive and of `threshold_drive`: K, W/m² or impulses."""
        return drive_unit(self.variable, self.model)

    def receptor(self, channel: Channel) -> Receptor:
        """Constants of one channel."""
        return self.cold if channel == "cold" else self.warm

    def neutral(self, channel: Channel) -> tuple[float, float]:
        """Range of complete adaptation, in °C or, where heat flow is felt, in W/m² into the skin."""
        flux = self.receptor(channel).neutral_flux
        if self.variable == "temperature" or flux is None:
            return self.neutral_low_C, self.neutral_high_C
        return flux

    def path_m(self, site: str) -> float:
        """Path to the cord, m: forearm sites have their own, every other site has the hand's."""
        return self.path_forearm_m if on_forearm(site) else self.path_hand_m

    def site_factor(self, channel: Channel, site: str | None) -> float:
        """How much larger thresholds are at a site than on the thenar; 1 where nothing is known of the site."""
        return self.receptor(channel).forearm_factor if site is not None and on_forearm(site) else 1.0

    def memory_noise(self, norm: Norm) -> float:
        """Memory noise of a norm, log units."""
        return {"max": self.memory_max, "rms": self.memory_rms, "integral": self.memory_integral}[check_norm(norm)]

    def __repr__(self) -> str:
        variant = (
            "" if (self.variable, self.model) == ("temperature", "adapting") else f"{self.variable}, {self.model}; "
        )
        return (
            f"Observer({variant}a {self.a:.3g}, criterion {self.criterion:.3g} d′, "
            f"memory noise {self.memory_max:.3g} log units, "
            f"threshold drive cold {self.cold.threshold_drive:.3g} {self.drive_unit}, "
            f"warm {self.warm.threshold_drive:.3g} {self.drive_unit})"
        )


def on_forearm(site: str) -> bool:
    """Whether a site is one of the forearm's.

    >>> on_forearm("left wrist"), on_forearm("thenar")
    (True, False)
    """
    return any(name in site.lower() for name in FOREARM_SITES)


def load_thresholds() -> Table:
    """The shipped table of published numbers.

    >>> load_thresholds().one("detection threshold", channel="cold", site="thenar").central
    0.11
    """
    return load_records(DATA / "thresholds.toml")


@lru_cache(maxsize=1)
def _file() -> Table:
    path = DATA / "observer.toml"
    if not path.exists():
        raise RecordError("observer.toml: not there: write it with python -m thermicon.perception.validation.calibrate")
    return load_records(path)


@lru_cache(maxsize=8)
def _shipped(variable: Variable, model: Model) -> Observer:
    return Observer.from_table(_file(), variable=variable, model=model)
