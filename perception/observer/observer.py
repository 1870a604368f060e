"""The observer: every constant of the perceptual chain, read from the calibrated parameter file.

The file `data/observer.toml` is written by `thermicon.perception.evidence observer`; each number there
says what it was calibrated on, or that it is assumed, and carries its interval.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from numpy.typing import ArrayLike

from thermicon.circuit.records import RecordError, Table, load_records

from ..arrays import Array
from .channels import (
    CHANNELS,
    NORMS,
    VARIABLES,
    Channel,
    Norm,
    Variable,
    check_norm,
    check_variable,
    source_of,
)
from .parts import BAR, MISSING, NOISE, OF_MEMORY, SHARE, EpisodeMemory, Ratings, Receptor, Transducer, conduction_s

__all__ = ["CHANNELS", "NORMS", "Channel", "Norm", "Observer", "Receptor", "check_norm", "load_thresholds"]
DATA = Path(__file__).parents[1] / "data"
CURE = (
    f"begin with a copy of the shipped file, {DATA / 'observer.toml'}, and change numbers there; or infer all of them "
    "again from your evidence with python -m thermicon.perception.evidence fit and python -m "
    "thermicon.perception.evidence observer"
)
INFERRED: Mapping[str, str] = {
    "integration_s": "integration time",
    "a": "slope of sensation",
    "p": "transducer exponent",
    "gain_noise": "gain noise",
    "criterion": "criterion of speeded answers",
    "noise_correlation_s": "noise correlation time",
    "decision_s": "decision time",
    "choice_s": "choice time",
    "decision_noise": "decision time between trials",
}
"""Fields of an observer by the constants of the inference, under whose names they stand in files."""
OF_CHANNEL: Mapping[str, str] = {
    "threshold_drive": "threshold drive",
    "velocity_m_per_s": "conduction velocity",
    "area_exponent": "area exponent",
    "limit_C": "limit",
    "forearm_factor": "threshold on the forearm",
}
OF_BOTH: Mapping[str, str] = {"adaptation_s": "slow adaptation time", "softness_K": "softness of the limits"}
"""Fields of a receptor: constants of which each channel has its own, and those that both share."""
OF_RATINGS = ("rating at threshold", "rating exponent", "mean rating")
FOREARM_SITES = ("forearm", "wrist", "arm")


@dataclass(frozen=True, slots=True)
class Observer:
    """A nominal person: SI units inside, sensation in units of the sensory noise (d′).

    An observer is loaded with `Observer.load`, which takes a variant; its fields are the constants of the chain from
    receptor to answer, each with its source in the parameter file.

    Attributes
    ----------
    cold, warm
        Constants of each channel.
    integration_s
        Time constant of integration at the receptors, s.
    neutral_low_C, neutral_high_C
        Range of complete adaptation, °C.
    a, reference_area_m2
        Slope of sensation, d′, and the area of contact that thresholds are given for, m².
    criterion, noise_correlation_s
        Change of sensation that is answered with yes, d′, and the correlation time of the sensory noise, s.
    path_hand_m, path_forearm_m
        Length of the nerve to the cord, m.
    decision_s
        Time from the brain's signal to the answer, s.
    lapse, memory
        Share of trials in which any name is given, 0–1, and how well episodes are remembered.
    p, gain_noise
        Exponent of sensation near threshold, and the SD (ln) of the gain from presentation to presentation.
    choice_s, decision_noise
        What a choice adds to `decision_s`, s, and the SD (ln) of decision times from trial to trial.
    variable
        What the receptors go by, `temperature` or `heat flow`.

    Raises
    ------
    ValueError
        For a constant out of its range.

    Examples
    --------
    >>> person = Observer.load()
    >>> 0.5 < person.receptor("warm").velocity_m_per_s < 2.5
    True
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
    lapse: float
    memory: EpisodeMemory
    p: float = 1.0
    gain_noise: float = 0.0
    choice_s: float = 0.0
    decision_noise: float = 0.0
    variable: Variable = "temperature"

    def __post_init__(self) -> None:
        for name in ("a", "p"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"the sensation needs {name} above 0, not {getattr(self, name):g}")
        if not self.gain_noise >= 0.0:
            raise ValueError(f"gain_noise = {self.gain_noise:g} must be 0 or more")
        if not self.neutral_low_C < self.neutral_high_C:
            raise ValueError(f"the neutral zone {self.neutral_low_C:g} to {self.neutral_high_C:g} °C is empty")
        if not 0.0 <= self.lapse < 1.0:
            raise ValueError(f"lapse = {self.lapse:g} must lie in 0 to 1")
        check_variable(self.variable)
        if self.variable == "heat flow" and (self.cold.neutral_flux is None or self.warm.neutral_flux is None):
            raise ValueError("an observer of heat flow needs the neutral heat flow of both channels")

    @classmethod
    def load(cls, path: Path | str | None = None, *, variable: Variable = "temperature") -> Observer:
        """The shipped observer, or one from another parameter file, in one of its variants.

        Raises `RecordError` for a file without what is needed, `ValueError` for a variant that does not exist.
        """
        return _shipped(variable) if path is None else cls.from_table(read_records(Path(path)), variable=variable)

    @classmethod
    def from_table(cls, table: Table, *, variable: Variable = "temperature") -> Observer:
        """Build from calibrated records; a missing one is a `RecordError` that names it."""
        return cls.from_constants(constants_of(table, variable), variable)

    @classmethod
    def from_constants(cls, values: Mapping[str, Any], variable: Variable = "temperature") -> Observer:
        """Build from constants by the names of `constants_of`; further ones are left alone."""

        def receptor(channel: Channel) -> Receptor:
            names = {**{field: f"{channel} {name}" for field, name in OF_CHANNEL.items()}, **OF_BOTH}
            constants = {field: values[name] for field, name in names.items() if name in values}
            if variable == "heat flow":
                constants |= {"limit_C": None, "neutral_flux": values[f"{channel} neutral heat flow"]}
            return Receptor(**constants)

        def ratings(channel: Channel) -> Ratings:
            unit, exponent, rated = (values[f"{channel} {name}"] for name in OF_RATINGS)
            # What repeated ratings scatter by, with the part that gain noise makes of it.
            scatter = math.hypot(values["scatter of ratings"], exponent * rated * values["gain noise"])
            return Ratings(unit, exponent, rated, scatter)

        low, high = values["neutral zone"]
        remembered = {field: values[name] for field, name in OF_MEMORY.items()}
        return cls(
            **{field: values[name] for field, name in INFERRED.items()},
            cold=receptor("cold"),
            warm=receptor("warm"),
            neutral_low_C=low,
            neutral_high_C=high,
            reference_area_m2=values["reference area"] * 1e-4,
            path_hand_m=values["path of the hand"],
            path_forearm_m=values["path of the forearm"],
            lapse=values["lapse rate"],
            memory=EpisodeMemory(**remembered, cold=ratings("cold"), warm=ratings("warm")),
            variable=variable,
        )

    @property
    def transducer(self) -> Transducer:
        """How drive in multiples of threshold becomes sensation."""
        return Transducer(self.a, self.p)

    def delay_s(self, channel: Channel, path_m: ArrayLike) -> Array:
        """Conduction over paths to the cord, and from there to the brain, s, of the same shape."""
        return conduction_s(channel, self.receptor(channel).velocity_m_per_s, path_m)

    @property
    def drive_unit(self) -> str:
        """Unit of receptor drive and of `threshold_drive`: K or W/m²."""
        return "K" if self.variable == "temperature" else "W/m²"

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

    def __repr__(self) -> str:
        variant, unit = "" if self.variable == VARIABLES[0] else f"{self.variable}; ", self.drive_unit
        return (
            f"Observer({variant}a {self.a:.3g}, p {self.p:.3g}, criterion {self.criterion:.3g} d′, "
            f"memory noise {self.memory.timing:.3g} log units, threshold drive cold "
            f"{self.cold.threshold_drive:.3g} {unit}, warm {self.warm.threshold_drive:.3g} {unit})"
        )


def on_forearm(site: str) -> bool:
    """Whether a site is one of the forearm's, such as `left wrist`."""
    return any(name in site.lower() for name in FOREARM_SITES)


def constants_of(table: Table, variable: Variable) -> dict[str, Any]:
    """Constants of an observer by the names that draws have them under, and intervals of what a variant adapts to.

    A variant's own number stands under the quantity's name with the variant's ending, where it has one. A missing
    quantity is a `RecordError` that names it.
    """
    variant, known = source_of(check_variable(variable)), {record.quantity for record in table}

    def number(quantity: str, **keys: str) -> float:
        own = f"{quantity}{variant}"
        return table.one(own if own in known else quantity, **keys).central

    shared = (*INFERRED.values(), *OF_BOTH.values(), SHARE, MISSING, BAR, "scatter of ratings", "reference area")
    try:
        found: dict[str, Any] = {name: number(name) for name in (*shared, "lapse rate")}
        found |= {NOISE: number("memory noise", method="episodes"), "neutral zone": table.one("neutral zone").interval}
        found |= {f"path of the {site}": number("path length to the cord", site=site) for site in ("hand", "forearm")}
        for channel in CHANNELS:
            for name in (*OF_CHANNEL.values(), *OF_RATINGS):
                if name != "limit" or variable == "temperature":
                    found[f"{channel} {name}"] = number(name, channel=channel)
            if variable == "heat flow":
                found[f"{channel} neutral heat flow"] = table.one("neutral heat flow", channel=channel).interval
    except RecordError as wrong:
        raise RecordError(f"{wrong}. Cure: {CURE}") from None
    return found


@lru_cache(maxsize=1)
def load_thresholds() -> Table:
    """The shipped table of published numbers."""
    return load_records(DATA / "thresholds.toml")


@lru_cache(maxsize=1)
def observer_records() -> Table:
    """The records of the shipped observer and of how people differ."""
    return load_records(DATA / "observer.toml")


def read_records(path: Path) -> Table:
    """Records of an observer's file; a RecordError where a quantity has another unit than the shipped one.

    Values are not converted.
    """
    table = load_records(path)
    shipped = {record.quantity: record.unit for record in observer_records()}
    for record in table:
        unit = shipped.get(record.quantity, record.unit)
        if record.unit != unit:
            raise RecordError(
                f"{table.name}: {record.quantity}: unit {record.unit!r}, but this quantity is in {unit!r}: convert the "
                "value and its interval, and write that unit"
            )
    return table


@lru_cache(maxsize=4)
def variant_records(variable: Variable = "temperature") -> Table:
    """The shipped records without those of other variants: all that an observer of this variant makes use of."""
    variant = source_of(variable)
    others = tuple(ending for each in VARIABLES if (ending := source_of(each)) not in ("", variant))
    shipped = observer_records()
    return Table(shipped.name, tuple(record for record in shipped if not record.quantity.endswith(others)))


@lru_cache(maxsize=2)
def shipped_constants(variable: Variable) -> Mapping[str, Any]:
    """Constants of the shipped observer in a variant."""
    return MappingProxyType(constants_of(observer_records(), variable))


@lru_cache(maxsize=2)
def _shipped(variable: Variable) -> Observer:
    return Observer.from_constants(shipped_constants(variable), variable)
