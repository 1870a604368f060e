"""The observer: the constants of a person as mechanisms.

Each number of `data/observer.toml` says what it was calibrated on, or that it is assumed, and carries its interval.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from thermicon.base.files.records import RecordError, RecordTable, load_records

from .chain import SensoryChain
from .channels import CHANNELS, MEMORY_FORMS, VARIABLES, Channel, MemoryForm, Variable, check_variable, source_of
from .constants import fields_from, objection_to, values_in, values_of
from .mechanisms.mechanism import Mechanism

__all__ = ["CHANNELS", "MEMORY_FORMS", "Channel", "MemoryForm", "Observer", "load_thresholds"]
DATA = Path(__file__).parents[1] / "data"
CURE = (
    f"begin with a copy of the shipped file, {DATA / 'observer.toml'}, and change numbers there; or infer all of them "
    "again from your evidence with python -m thermicon.perception.evidence fit and python -m "
    "thermicon.perception.evidence observer"
)


@dataclass(frozen=True, kw_only=True)
class Observer(SensoryChain):
    """A nominal person: SI units inside, sensation in units of the sensory noise (d′).

    An observer is loaded with `Observer.load`, which takes a variant. Its fields are the constants of its mechanisms,
    which are the bases of its chain; those of which each channel has its own are a pair. Each has its source in the
    parameter file, and its equation in the module of its mechanism.

    Attributes
    ----------
    variable
        What the receptors go by, `temperature` or `heat flow`.
    sensitivity_between, criterion_between, correlation
        Spreads between people (ln), and the correlation of cold and warm.
    wrong_labels, lingering
        Share of coolings that are called warm, and what warmth adds to it, ln per d′.
    decision_s, choice_s, decision_noise, decision_between
        Time to an answer and what a choice adds, s, and their SDs (ln) between trials and people.
    velocity_m_per_s, path_hand_m, path_forearm_m
        Conduction in nerves, m per s, over paths to the cord, m.
    criterion, unhurried, caution_after_pulse, noise_correlation_s, criterion_floor
        Criterion of hurried and of unhurried answers, d′, its factor after a pulse, the noise's correlation, s, and the
        least criterion of anybody, d′.
    threshold_drive, gain_noise, a, p
        Drive that feels like a threshold, SD (ln) of the gain, slope of sensation in d′ and its exponent.
    rating_at_threshold, rating_exponent, mean_rating, rating_scatter
        Ratings, points of 100.
    timing_noise, rated_share, missing_cost, episode_bar, lapse, pair_spread
        Memory: noise of rates (ln), λ, cost of a missing episode, the bar in d′, share of trials with any name; how
        much the odds of confusing a pair differ between laboratories (ln).
    lost_per_decade, area_exponent, reference_area_m2, least_area_m2, forearm_factor
        What sensitivity depends on: age (ln), area in m², and site.
    limit_C, softness_K, integration_s, adaptation_s, neutral_C, neutral_flux
        Limits of quality in °C and their softness in K; time constants, s; range of complete adaptation, °C and W/m².
    corneum_share, depth_m
        Where receptors lie: share of the stratum corneum that counts, and depth below it, m.
    contact_m2K_per_W, effusivity
        Skin of laboratories: contact resistance, and a multiple.

    Raises
    ------
    ValueError
        For a constant out of its range.

    Examples
    --------
    >>> person = Observer.load()
    >>> 0.5 < person.velocity_m_per_s.of("warm") < 2.5
    True
    >>> Observer.load(variable="heat flow").drive_unit
    'W/m²'
    """

    def __post_init__(self) -> None:
        check_variable(self.variable)
        if self.variable == "heat flow" and self.neutral_flux is None:
            raise ValueError("an observer of heat flow needs the neutral heat flow of both channels")
        for name, within, value in values_of(self):
            if isinstance(value, tuple):
                if not value[0] < value[1]:
                    raise ValueError(f"{name}: {value[0]:g} to {value[1]:g} is empty")
            elif why := objection_to(within, value):
                raise ValueError(f"{name} = {value:g} {why}")

    @classmethod
    def load(cls, path: Path | str | None = None, *, variable: Variable = "temperature") -> Observer:
        """The shipped observer, or one from another parameter file, in one of its variants.

        Raises `RecordError` for a file without what is needed, `ValueError` for a variant that does not exist.
        """
        return _shipped(variable) if path is None else cls.from_table(read_records(Path(path)), variable=variable)

    @classmethod
    def from_table(cls, table: RecordTable, *, variable: Variable = "temperature") -> Observer:
        """Build from calibrated records; a missing one is a `RecordError` that names it."""
        try:
            return cls.from_values(values_in(table, cls, check_variable(variable)), variable)
        except RecordError as wrong:
            raise RecordError(f"{wrong}; the file is incomplete or of another version. Cure: {CURE}") from None

    @classmethod
    def from_values(cls, values: Mapping[str, Any], variable: Variable = "temperature") -> Observer:
        """Build from constants by the names of priors and draws; those left out are the shipped ones."""
        return cls(**fields_from(cls, {**shipped_values(variable), **values}, variable))

    @property
    def drive_unit(self) -> str:
        """Unit of receptor drive and of `threshold_drive`: K or W/m²."""
        return "K" if self.variable == "temperature" else "W/m²"

    def __repr__(self) -> str:
        variant, unit = "" if self.variable == VARIABLES[0] else f"{self.variable}; ", self.drive_unit
        return (
            f"Observer({variant}a {self.a:.3g}, p {self.p:.3g}, criterion {self.criterion:.3g} d′, "
            f"memory noise {self.timing_noise:.3g} log units, threshold drive cold "
            f"{self.threshold_drive.cold:.3g} {unit}, warm {self.threshold_drive.warm:.3g} {unit})"
        )


MECHANISMS = tuple(kind for kind in Observer.__mro__ if issubclass(kind, Mechanism) and vars(kind).get("equation"))
"""Every mechanism: the bases of the chain."""


@lru_cache(maxsize=1)
def load_thresholds() -> RecordTable:
    """The shipped table of published numbers."""
    return load_records(DATA / "thresholds.toml")


@lru_cache(maxsize=1)
def observer_records() -> RecordTable:
    """The records of the shipped observer and of how people differ."""
    return load_records(DATA / "observer.toml")


def read_records(path: Path) -> RecordTable:
    """Records of an observer's file; a RecordError where a quantity has another unit than the shipped one."""
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


def variant_records(variable: Variable = "temperature") -> RecordTable:
    """The shipped records without those of other variants: all that an observer of this variant makes use of."""
    variant = source_of(variable)
    others = tuple(ending for each in VARIABLES if (ending := source_of(each)) not in ("", variant))
    shipped = observer_records()
    return RecordTable(shipped.name, tuple(record for record in shipped if not record.quantity.endswith(others)))


@lru_cache(maxsize=2)
def shipped_values(variable: Variable) -> Mapping[str, Any]:
    """Constants of the shipped observer in a variant, by name."""
    return MappingProxyType(values_in(observer_records(), Observer, variable))


@lru_cache(maxsize=2)
def _shipped(variable: Variable) -> Observer:
    return Observer.from_values(shipped_values(variable), variable)
