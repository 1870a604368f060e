"""The constants on which a ranking depends most.

Contact and outermost layer differ from person to person, so that a regression of the proportion named on people says
what another contact would do to all of them. The area of contact acts on thresholds alone in the model of perception
(Stevens' summation), and thresholds differ between people too. Constants of the observer differ from draw to draw.

The doubt that a constant carries is the share of the variance between draws that would go if it were measured: the
variance explained by a parabola in its normal scores, without what chance alone explains. Constants of one draw belong
together, so that the shares of constants that trade off overlap and need not add up to 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig

from ..identification.laboratory_draws import LaboratoryDraws
from ..observer.channels import CHANNELS, FORM
from ..observer.mechanisms.site import on_forearm
from ..observer.observer import Observer
from ..observer.people import People, people_records
from ..sensation.coverage import nearest_site, outside_site

FEWEST_PEOPLE, FEWEST_DRAWS = 100, 64
"""Fewer do not distinguish an effect of some points from chance."""
LEAST_T = 4.0
"""An effect is named where it exceeds this many standard errors: of 50 that do nothing, one in 300 rankings does."""
LEAST_POINTS = 0.02
MOST = 3
TWICE = 2.0
COLUMNS = (
    *("threshold_cold", "threshold_warm", "criterion_cold", "criterion_warm", "memory"),
    *("contact_resistance", "outer_layer", "path", "decision_s"),
)
"""Multipliers of people that the regression accounts for, as logarithms."""
NOT_VARIED = (
    "module, driver and heat sink",
    "room and resting temperature of the skin",
    "what the skin touched before",
)


TERMS = 2
LEAST_SHARE = 0.02
"""Smaller shares are within what chance makes of 128 draws."""


def doubts(each: LaboratoryDraws) -> list[dict[str, str | float]]:
    """Constants that act on the set, with the share (0–1) of the variance of the proportion named that would go.

    Those of at least 2 %, the largest first, with the keys of the ranking file.
    """
    shares = explained(each.values, each.proportion_correct).tolist()
    found = [
        {"constant": name, "share_of_variance": share}
        for name, share, acts in zip(each.names, shares, each.acting(), strict=True)
        if acts and share >= LEAST_SHARE
    ]
    return sorted(found, key=lambda doubt: (-doubt["share_of_variance"], doubt["constant"]))


def explained(values: Array, predicted: Array) -> Array:
    """Adjusted shares (constants,) of the variance of `predicted` (draws,) that each column of `values` explains."""
    return np.array([explained_together(values[:, [place]], predicted) for place in range(values.shape[1])])


def explained_together(values: Array, predicted: Array) -> float:
    """Adjusted share of the variance of `predicted` (draws,) that some columns of `values` explain together.

    Parabolas in the normal scores of each; interactions are left out.
    """
    varied = [column for column in values.T if np.ptp(column) > 0.0]
    draws, terms = predicted.size, TERMS * len(varied)
    off = predicted - predicted.mean()
    total = float(off @ off)
    if total <= 0.0 or not varied or draws <= terms + 2:
        return 0.0
    scores = np.stack([scores_of(column) for column in varied], axis=1)
    design = np.hstack([scores, scores**2 - (scores**2).mean(axis=0)])
    left = off - design @ np.linalg.lstsq(design, off, rcond=None)[0]
    return max(1.0 - float(left @ left) / total * (draws - 1) / (draws - terms - 1), 0.0)


def scores_of(values: Array) -> Array:
    """Normal scores (draws,) of the ranks of some values; equal ones have the mean of theirs.

    >>> scores_of(np.array([1.0, 0.0, 1.0, 0.0])).round(2).tolist()
    [0.73, -0.73, 0.73, -0.73]
    """
    count, scores = values.size, np.empty(values.size)
    scores[np.argsort(values, kind="stable")] = [NormalDist().inv_cdf((k + 0.5) / count) for k in range(count)]
    _, places, equal = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.bincount(places, scores) / equal)[places])


@dataclass(frozen=True, slots=True)
class Assumption:
    """A quantity that was assumed, two values of it, and the proportion named (0–1) to be expected at both.

    `key` is its key in the rig file, empty for a constant of the observer; `source` says what it was read from,
    `people` or `draws`; `standard_error` is that of the difference.
    """

    name: str
    key: str
    unit: str
    value: float | None
    low: float
    high: float
    correct_at_low: float
    correct_at_high: float
    standard_error: float
    source: str

    @property
    def moves(self) -> float:
        """How far the proportion named moves between both values."""
        return abs(self.correct_at_high - self.correct_at_low)


@dataclass(frozen=True, slots=True)
class Assumptions:
    """The assumptions that move a ranking most, the site's evidence, and what was not varied.

    `site` is None where thresholds of the site are on record; else it names the site, the nearest recorded one and
    the proportion named if thresholds were twice as high (None: too few people to say).
    """

    moving: tuple[Assumption, ...]
    site: Mapping[str, Any] | None
    not_varied: tuple[str, ...] = NOT_VARIED


def assumptions_of(
    correct: Array, crowd: People, rig: Rig, observer: Observer, draws: LaboratoryDraws | None
) -> Assumptions:
    """Find what moves the proportion named of a set most, at most three things; none where all are within chance.

    `correct` (people,) is that of the people of the crowd, on a rig with its uncertainty of contact. Summation over
    area is the nominal observer's; `draws` are predictions by draws of the posterior (None: there are none).
    """
    found = [] if draws is None else _of_draws(draws)
    fitted = PeopleFit.of(correct, crowd)
    if fitted is not None:
        found += _of_people(fitted, rig, observer)
    named = [each for each in found if each.moves >= max(LEAST_POINTS, LEAST_T * each.standard_error)]
    moving = sorted(named, key=lambda each: (-each.moves, each.name))[:MOST]
    return Assumptions(tuple(moving), _site(rig.site, fitted))


@dataclass(frozen=True, slots=True)
class PeopleFit:
    """Parabolas of the proportion named in the logarithms of people's multipliers; (people, columns)."""

    columns: Array
    correct: Array
    weights: Array
    covariance: Array

    @classmethod
    def of(cls, correct: Array, crowd: People) -> PeopleFit | None:
        """Fit them; None for too few people, or where all are named alike."""
        columns = np.stack([np.log(getattr(crowd, name)) for name in COLUMNS], axis=1)
        design = _design(columns)
        people, terms = design.shape
        if people < max(FEWEST_PEOPLE, 3 * terms) or np.ptp(correct) == 0.0:
            return None
        inverse = np.linalg.pinv(design.T @ design)
        weights = inverse @ design.T @ correct
        left = correct - design @ weights
        return cls(columns, correct, weights, inverse * float(left @ left) / (people - terms))

    def shifted(self, **shifts: float) -> Array:
        """Change of the mean terms where everyone's logarithms are moved so far, (terms,)."""
        moved = self.columns + np.array([shifts.get(name, 0.0) for name in COLUMNS])
        return np.asarray((_design(moved) - _design(self.columns)).mean(axis=0))

    def at(self, terms: Array) -> float:
        """Proportion named to be expected there, 0–1."""
        return float(np.clip(self.correct.mean() + terms @ self.weights, 0.0, 1.0))

    def error(self, terms: Array) -> float:
        """Standard error of the change along some terms."""
        return math.sqrt(max(float(terms @ self.covariance @ terms), 0.0))


def _design(columns: Array) -> Array:
    cold, warm = columns[:, :1], columns[:, 1:2]
    return np.hstack([np.ones_like(cold), columns, columns**2, cold * warm])


def _of_people(fitted: PeopleFit, rig: Rig, observer: Observer) -> list[Assumption]:
    area_cm2, resistance, layer = rig.contact.area_m2 * 1e4, rig.contact.resistance_m2K_per_W, rig.skin.layers[0]
    by, thicker = 1.0 + rig.uncertainty.contact_resistance_relative, 1.0 + people_records()["outer_layer"].central
    mm = layer.thickness_m * 1e3

    def of_area(factor: float) -> Array:
        areas, moved = (rig.contact.area_m2, factor * rig.contact.area_m2), {}
        for channel in CHANNELS:
            own, other = (observer.sensitivity(channel, area_m2, rig.site) for area_m2 in areas)
            moved[f"threshold_{channel}"] = math.log(own / other)
        return fitted.shifted(**moved)

    def of(column: str) -> Callable[[float], Array]:
        return lambda factor: fitted.shifted(**{column: math.log(factor)})

    thickness = f"thickness of the {layer.name}"
    each = (
        ("area of contact", "contact.area_cm2", "cm²", area_cm2, TWICE, of_area),
        ("contact resistance", "contact.resistance_m2K_per_W", "m²K/W", resistance, by, of("contact_resistance")),
        (thickness, "skin.layer.0.thickness_mm", "mm", mm, thicker, of("outer_layer")),
    )
    found = []
    for name, key, unit, value, factor, terms_of in each:
        low, high = terms_of(1.0 / factor), terms_of(factor)
        correct, error = (fitted.at(low), fitted.at(high)), fitted.error(high - low)
        found.append(Assumption(name, key, unit, value, value / factor, value * factor, *correct, error, "people"))
    return found


def _of_draws(draws: LaboratoryDraws) -> list[Assumption]:
    """Effects of constants between the ends of their 95 %, as parabolas in their normal scores.

    The form of memory has no ends, and a ranking says what each form predicts.
    """
    count = len(draws)
    predicted = draws.proportion_correct
    if count < FEWEST_DRAWS or np.ptp(predicted) == 0.0:
        return []
    found = []
    for name, values, acts in zip(draws.names, draws.values.T, draws.acting(), strict=True):
        if not acts or name == FORM:
            continue
        scores = scores_of(values)
        design = np.stack([np.ones(count), scores, scores**2], axis=1)
        inverse = np.linalg.pinv(design.T @ design)
        weights = inverse @ design.T @ predicted
        left = predicted - design @ weights
        ends = np.array([[1.0, z, z * z] for z in (-1.96, 1.96)])
        across = ends[1] - ends[0]
        error = math.sqrt(float(across @ inverse @ across) * float(left @ left) / (count - 3))
        low, high = np.percentile(values, (2.5, 97.5))
        at_low, at_high = np.clip(ends @ weights, 0.0, 1.0).tolist()
        found.append(Assumption(name, "", "", None, float(low), float(high), at_low, at_high, error, "draws"))
    return found


def _site(site: str, fitted: PeopleFit | None) -> Mapping[str, Any] | None:
    if not outside_site(site):
        return None
    doubled = dict.fromkeys(("threshold_cold", "threshold_warm"), math.log(TWICE))
    twice = None
    if fitted is not None:
        terms = fitted.shifted(**doubled)
        change = abs(fitted.at(terms) - float(fitted.correct.mean()))
        if change >= max(LEAST_POINTS, LEAST_T * fitted.error(terms)):
            twice = fitted.at(terms)
    nearest, why = nearest_site(site)
    return {
        "site": site,
        "nearest_recorded": nearest,
        "why": why,
        "thresholds_of": "forearm" if on_forearm(site) else "thenar",
        "proportion_correct_at_twice_the_thresholds": twice,
    }
