"""Virtual people: what differs between persons, each number from a record or said to be assumed."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import lru_cache
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.records import Record

from ..arrays import Array
from .observer import load_thresholds

if TYPE_CHECKING:
    from thermicon.circuit import Rig

STANDARD = NormalDist()
VELOCITY_SPAN = 1.5
"""Conduction velocities are cut off at this many SD: slower fibres would not reach the cord in a trial."""

YOUNG_YEARS, OLD_YEARS = 25.0, 65.0


@dataclass(frozen=True, slots=True)
class People:
    """Persons as columns of shape (n,); multipliers are relative to the nominal observer or rig.

    Multipliers of thresholds (median 1), of memory noise, of contact resistance, of the thickness
    of the outermost layer and of the path to the cord; conduction velocities in m/s, decision time
    in s, lapse 0–1.
    """

    threshold_cold: Array
    threshold_warm: Array
    memory: Array
    contact_resistance: Array
    outer_layer: Array
    velocity_cold_m_per_s: Array
    velocity_warm_m_per_s: Array
    path: Array
    decision_s: Array
    lapse: Array

    def __post_init__(self) -> None:
        for field in fields(self):
            own = np.array(getattr(self, field.name), dtype=np.float64)
            if own.ndim != 1 or own.shape != self.threshold_cold.shape or not np.isfinite(own).all():
                raise ValueError(f"people: {field.name} must be one finite number for each person")
            own.setflags(write=False)
            object.__setattr__(self, field.name, own)

    def __len__(self) -> int:
        return int(self.threshold_cold.size)

    def part(self, start: int, stop: int) -> People:
        """The persons from one number up to another."""
        return People(**{field.name: getattr(self, field.name)[start:stop] for field in fields(self)})

    def rigs(self, rig: Rig) -> list[Rig]:
        """The rig as each person meets it: own contact resistance and own outermost layer."""
        columns = (self.contact_resistance.tolist(), self.outer_layer.tolist())
        return [_as_met(rig, contact, layer) for contact, layer in zip(*columns, strict=True)]

    def __repr__(self) -> str:
        return (
            f"People({len(self)}: threshold multipliers cold {_span(self.threshold_cold)}, "
            f"warm {_span(self.threshold_warm)}, memory noise {_span(self.memory)} of nominal, "
            f"velocity warm {_span(self.velocity_warm_m_per_s)} m/s)"
        )


@lru_cache(maxsize=1024)
def _as_met(rig: Rig, contact: float, layer: float) -> Rig:
    """The rig with contact resistance and outermost layer multiplied; kept, since a ranking asks for it twice."""
    return rig.with_(
        **{
            "contact.resistance_m2K_per_W": contact * rig.contact.resistance_m2K_per_W,
            "skin.layer.0.thickness_mm": layer * rig.skin.layers[0].thickness_m * 1e3,
        }
    )


def draw_people(n: int, seed: int = 0, *, age_years: float | None = None) -> People:
    """Draw n virtual people; person i is the same whatever n is, and channels are independent.

    `age_years` raises both thresholds of a person by a factor for which there is no data: at 65 years
    anything from none to a doubling, in proportion (of logarithms) before and after, none by 25.
    None leaves age out, which is people of 20 to 30 years.

    >>> a, b = draw_people(3, seed=1), draw_people(200, seed=1)
    >>> bool((a.memory == b.memory[:3]).all())
    True
    """
    if n < 1:
        raise ValueError(f"at least one person is needed, not {n}")
    record = people_records()
    streams = np.random.SeedSequence([seed, 0]).spawn(len(record))
    column = {name: np.random.default_rng(stream).random(n) for name, stream in zip(record, streams, strict=True)}

    aged = 1.0 if age_years is None else _aged(np.random.default_rng(np.random.SeedSequence([seed, 4])), n, age_years)

    def lognormal(name: str, sd: float) -> Array:
        return np.exp(sd * _normal(column[name]))

    def velocity(name: str) -> Array:
        spread = record[name].interval[1] - record[name].central
        return record[name].central + spread * _normal_within(column[name], VELOCITY_SPAN)

    def triangular(name: str) -> Array:
        low, high = record[name].interval
        return _triangular(column[name], low, record[name].central, high)

    return People(
        threshold_cold=aged * lognormal("threshold_cold", math.log(10.0) * record["threshold_cold"].central),
        threshold_warm=aged * lognormal("threshold_warm", math.log(10.0) * record["threshold_warm"].central),
        memory=_uniform(column["memory"], *record["memory"].interval) / record["memory"].central,
        contact_resistance=lognormal("contact_resistance", math.log1p(record["contact_resistance"].central)),
        outer_layer=lognormal("outer_layer", math.log1p(record["outer_layer"].central)),
        velocity_cold_m_per_s=velocity("velocity_cold_m_per_s"),
        velocity_warm_m_per_s=velocity("velocity_warm_m_per_s"),
        path=triangular("path") / record["path"].central,
        decision_s=triangular("decision_s"),
        lapse=triangular("lapse"),
    )


def people_records() -> dict[str, Record]:
    """The record behind every field of `People`; `use` says whether it is data or assumed.

    >>> people_records()["memory"].use
    'assumed'
    """
    table = load_thresholds()
    spread = table.one("between-person spread")
    return {
        "threshold_cold": spread,
        "threshold_warm": spread,
        "memory": table.one("spread of memory noise between people"),
        "contact_resistance": table.one("contact resistance spread"),
        "outer_layer": table.one("horny layer thickness spread"),
        "velocity_cold_m_per_s": table.one("conduction velocity", channel="cold", site="leg"),
        "velocity_warm_m_per_s": table.one("conduction velocity", channel="warm", site="leg"),
        "path": table.one("path length to the cord", site="hand"),
        "decision_s": table.one("decision and motor time"),
        "lapse": table.one("lapse rate"),
    }


def age_factor(age_years: float, share: float = 0.5) -> float:
    """Threshold at an age over that at 25 years; `share` (0–1) places it in the assumed interval.

    >>> age_factor(25.0), age_factor(65.0, share=0.0)
    (1.0, 1.0)
    """
    if not 18.0 <= age_years <= 100.0:
        raise ValueError(f"an age of {age_years:g} years is not covered: give 18 to 100")
    low, high = _old_age()
    old = (max(age_years, YOUNG_YEARS) - YOUNG_YEARS) / (OLD_YEARS - YOUNG_YEARS)
    return math.exp(old * (math.log(low) + share * math.log(high / low)))


@lru_cache(maxsize=1)
def _old_age() -> tuple[float, float]:
    return load_thresholds().one("threshold in old age").interval


def _aged(rng: np.random.Generator, n: int, age_years: float) -> Array:
    return np.array([age_factor(age_years, share) for share in rng.random(n).tolist()], dtype=np.float64)


def _normal(uniform: Array) -> Array:
    within = np.clip(uniform, 1e-12, 1.0 - 1e-12)
    return np.array([STANDARD.inv_cdf(p) for p in within.tolist()], dtype=np.float64)


def _normal_within(uniform: Array, span: float) -> Array:
    tail = 0.5 * math.erfc(span / math.sqrt(2.0))
    return _normal(tail + uniform * (1.0 - 2.0 * tail))


def _uniform(uniform: Array, low: float, high: float) -> Array:
    return low + (high - low) * uniform


def _triangular(uniform: Array, low: float, mode: float, high: float) -> Array:
    split = (mode - low) / (high - low)
    left = low + np.sqrt(uniform * (high - low) * (mode - low))
    right = high - np.sqrt((1.0 - uniform) * (high - low) * (high - mode))
    return np.where(uniform < split, left, right)


def _span(column: Array) -> str:
    return f"{column.min():.2g}–{column.max():.2g}"
