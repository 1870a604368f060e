"""Virtual people drawn from the distributions of the constants that differ between persons."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache, partial
from statistics import NormalDist
from types import MappingProxyType
from typing import Literal

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.files.records import Record, shipped_records
from thermicon.base.numbers.arrays import Array, own_arrays
from thermicon.circuit import Rig

from .channels import CHANNELS, Channel
from .constants import Both, record_of
from .observer import Observer, load_thresholds, observer_records


@dataclass(frozen=True, slots=True, eq=False)
class People:
    """Persons as columns of shape (n,): decision time in s, lapse 0–1, and multipliers.

    Of thresholds and criteria (median 1), memory noise, contact resistance, outermost layer and path to the cord.
    """

    threshold_cold: Array
    threshold_warm: Array
    memory: Array
    contact_resistance: Array
    outer_layer: Array
    criterion_cold: Array
    criterion_warm: Array
    path: Array
    decision_s: Array
    lapse: Array

    def __post_init__(self) -> None:
        own_arrays(self, *(field.name for field in fields(self)))
        for field in fields(self):
            own = getattr(self, field.name)
            if own.ndim != 1 or own.shape != self.threshold_cold.shape or not np.isfinite(own).all():
                raise ValueError(f"people: {field.name} must be one finite number for each person")

    def __len__(self) -> int:
        return int(self.threshold_cold.size)

    @classmethod
    def nominal(cls, n: int = 1, observer: Observer | None = None) -> People:
        """The nominal person, n times: every multiplier 1, decision time and lapse as the observer has them."""
        median = Observer.load() if observer is None else observer
        own = {"decision_s": median.decision_s, "lapse": median.lapse}
        return cls(**{field.name: np.full(n, own.get(field.name, 1.0)) for field in fields(cls)})

    def threshold(self, channel: Channel) -> Array:
        """Multipliers (n,) of a channel's thresholds."""
        return self.threshold_cold if channel == "cold" else self.threshold_warm

    def criterion(self, channel: Channel) -> Array:
        """Multipliers (n,) of a channel's criterion."""
        return self.criterion_cold if channel == "cold" else self.criterion_warm

    def part(self, start: int, stop: int) -> People:
        """The persons from one number up to another."""
        return People(**{field.name: getattr(self, field.name)[start:stop] for field in fields(self)})

    def corneum_m(self, rig: Rig) -> Array:
        """Thickness (n,) of each person's stratum corneum on the rig's site, m."""
        return rig.skin.corneum_m * self.outer_layer

    def rigs(self, rig: Rig, depths_m: Sequence[Both[float] | None] | None = None) -> list[Rig]:
        """The rig as each person meets it: own contact, outermost layer, and depths (m) of receptors, if given."""
        columns = (self.contact_resistance.tolist(), self.outer_layer.tolist(), depths_m or [None] * len(self))
        return [_as_met(rig, *each) for each in zip(*columns, strict=True)]

    def __repr__(self) -> str:
        return f"People({len(self)})"


@lru_cache(maxsize=1024)
def _as_met(rig: Rig, contact: float, layer: float, depths_m: Both[float] | None) -> Rig:
    """The rig with contact resistance and outermost layer multiplied; kept, since a ranking asks for it twice."""
    keys: dict[str, float | str] = {
        "contact.resistance_m2K_per_W": contact * rig.contact.resistance_m2K_per_W,
        "skin.layer.0.thickness_mm": layer * rig.skin.layers[0].thickness_m * 1e3,
    }
    if depths_m is not None and not rig.skin.own:  # a rig that places its own receptors keeps them
        cold_mm, warm_mm = (1e3 * depth for depth in depths_m)
        keys |= {"skin.depth_from": "surface", "skin.cold_receptor_mm": cold_mm, "skin.warm_receptor_mm": warm_mm}
    return rig.with_(**keys)


@checked
def draw_people(
    n: int,
    seed: int = 0,
    *,
    age_years: float | None = None,
    observer: Observer | None = None,
    offsets: Sequence[float] = (0.0, 0.0),
    how: Literal["random", "sobol"] = "random",
) -> People:
    """Draw n virtual people; person i is the same whatever n is.

    Sensitivities and criteria of the two channels are correlated, as people's thresholds are. What differs between
    people comes from records: `people_records` has the one behind every column.

    Parameters
    ----------
    n
        Number of people.
    seed
        Seed of the draw.
    age_years
        Age of all of them, which multiplies thresholds as `age_factor` says; None leaves age out, which is people of 20
        to 30 years.
    observer
        The median person, whose constants say how people differ; None: the shipped one.
    offsets
        How much more sensitive (ln) all of them are to cold and to warmth, as people of one laboratory may be.
    how
        ``random``, or ``sobol``: people of quasi-random sensitivity, criterion and decision time, evenly spread, who
        differ in nothing else.

    Returns
    -------
    People
        Multipliers of thresholds, criteria, memory noise, contact, skin and nerve path, decision times and lapses.

    Raises
    ------
    ValueError
        For fewer than one person, and an age outside 18 to 100 years.

    Examples
    --------
    >>> a, b = draw_people(3, seed=1), draw_people(200, seed=1)
    >>> bool((a.memory == b.memory[:3]).all())
    True
    """
    if n < 1:
        raise ValueError(f"at least one person is needed, not {n}")
    record = people_records()
    column, normal = _columns(n, seed) if how == "random" else _sobol(n, seed)
    median = Observer.load() if observer is None else observer
    shared = median.correlation

    def lognormal(name: str, sd: float) -> Array:
        return np.exp(sd * normal[name])

    def both(what: str, sd_cold: float, sd_warm: float) -> tuple[Array, Array]:
        cold, own = (normal[f"{what}_{channel}"] for channel in CHANNELS)
        warm = shared * cold + math.sqrt(1.0 - shared**2) * own
        return np.exp(sd_cold * cold), np.exp(sd_warm * warm)

    def triangular(name: str) -> Array:
        (low, high), mode, uniform = record[name].interval, record[name].central, column[name]
        left = low + np.sqrt(uniform * (high - low) * (mode - low))
        right = high - np.sqrt((1.0 - uniform) * (high - low) * (high - mode))
        return np.where(uniform < (mode - low) / (high - low), left, right)

    aged = [1.0 if age_years is None else median.age_factor(age_years, channel) for channel in CHANNELS]
    cold, warm = (math.exp(-offset) for offset in offsets)
    threshold_cold, threshold_warm = both("threshold", *median.sensitivity_between)
    criterion_cold, criterion_warm = both("criterion", median.criterion_between, median.criterion_between)
    least, most = record["memory"].interval
    return People(
        threshold_cold=cold * (aged[0] * threshold_cold),
        threshold_warm=warm * (aged[1] * threshold_warm),
        criterion_cold=criterion_cold,
        criterion_warm=criterion_warm,
        memory=(least + (most - least) * column["memory"]) / record["memory"].central,
        contact_resistance=lognormal("contact_resistance", math.log1p(record["contact_resistance"].central)),
        outer_layer=lognormal("outer_layer", math.log1p(record["outer_layer"].central)),
        path=triangular("path") / record["path"].central,
        decision_s=median.decision_s * lognormal("decision_s", median.decision_between),
        lapse=triangular("lapse"),
    )


@lru_cache(maxsize=8)
def _columns(n: int, seed: int) -> tuple[dict[str, Array], dict[str, Array]]:
    """Uniform and standard normal numbers (n,) of every field; kept, since all draws have people of one seed."""
    names = tuple(people_records())
    streams = np.random.SeedSequence([seed, 0]).spawn(len(names))
    column = {name: np.random.default_rng(stream).random(n) for name, stream in zip(names, streams, strict=True)}
    normal = {name: normal_scores(column[name]) for name in NORMAL}
    for each in (*column.values(), *normal.values()):
        each.setflags(write=False)
    return column, normal


@lru_cache(maxsize=8)
def _sobol(n: int, seed: int) -> tuple[dict[str, Array], dict[str, Array]]:
    """The same from a Sobol sequence, in columns of mean 0 and SD 1; what else differs is in the middle."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    points = qmc.Sobol(len(SPREAD), seed=seed).random_base2(math.ceil(math.log2(n)))[:n]
    normal = ndtri(np.clip(points, 1e-6, 1.0 - 1e-6))
    normal = (normal - normal.mean(axis=0)) / normal.std(axis=0)
    normal[:, :2] *= -1.0  # a high number is a sensitive person
    middle = {name: np.full(n, 0.5) for name in people_records()}
    return middle, {name: np.zeros(n) for name in NORMAL} | dict(zip(SPREAD, normal.T, strict=True))


SPREAD = (*(f"{what}_{channel}" for what in ("threshold", "criterion") for channel in CHANNELS), "decision_s")
"""Fields in which people of a Sobol sequence differ."""
NORMAL = (*SPREAD, "contact_resistance", "outer_layer")
"""Fields whose logarithm is normal."""


@lru_cache(maxsize=1)
def people_records() -> Mapping[str, Record]:
    """The record behind every field of `People`; `use` says whether it is data or assumed."""
    table, own = load_thresholds(), partial(record_of, observer_records(), Observer)
    records = {
        "threshold_cold": own("sensitivity_between", "cold"),
        "threshold_warm": own("sensitivity_between", "warm"),
        "criterion_cold": own("criterion_between"),
        "criterion_warm": own("criterion_between"),
        "memory": table.one("spread of memory noise between people"),
        "contact_resistance": table.one("contact resistance spread"),
        "outer_layer": shipped_records("skin-spread.toml").one("outermost layer thickness spread"),
        "path": own("path_hand_m"),
        "decision_s": own("decision_between"),
        "lapse": own("lapse"),
    }
    return MappingProxyType(records)


def normal_scores(shares: Array, outermost: float = 1e-12) -> Array:
    """Standard normal numbers from shares of people, or of an interval, that stay so far within 0 and 1."""
    inside = np.clip(shares, outermost, 1.0 - outermost)
    return np.array([NormalDist().inv_cdf(share) for share in inside.ravel().tolist()]).reshape(shares.shape)
