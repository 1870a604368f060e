"""Intervals for a new laboratory: a prediction repeated with draws from the posterior.

Each draw is tested on a sample of the same few people; its difference from the nominal observer on them is added.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..observer.channels import FORM, MemoryChoice
from ..observer.draws import NEGLIGIBLE
from ..observer.mechanisms.memory import PAIRS
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from .depths import rungs
from .laboratory_draws import (
    EVERY,
    MANY,
    OFFSETS,
    DrawnLaboratory,
    LaboratoryDraws,
    laboratory_draws,
    people_for_intervals,
    scored,
)
from .population import RATE_HZ, ReceptorTemperatures, TrackTemperatures
from .task import USUAL, Task
from .tracks import Tracks

DRAWS = 128
"""The ends of the interval scatter by one to two points of per cent correct from seed to seed."""
COVER = (2.5, 97.5)

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

Interval = tuple[float, float]
NEW_LABORATORY = (
    *("detected_interval_new_laboratory", "onset_interval_new_laboratory_s"),
    *("proportion_correct_interval_new_laboratory", "felt_and_named_interval_new_laboratory"),
)
"""Keys of the intervals of an icon in the JSON of `rank`."""


@dataclass(frozen=True, slots=True, eq=False)
class NewLaboratory:
    """95 % intervals of what a new laboratory will find: people, constants and laboratory together.

    Scores are means over `people` invited, `onset_s` is None where an icon is not felt in most draws, `d_prime` and
    `confused` (icons, icons; the diagonal: named correctly) are lower and upper ends.
    """

    draws: int
    people: int
    posterior: str
    proportion_correct: Interval
    information_bits: Interval
    detected: tuple[Interval, ...]
    onset_s: tuple[Interval | None, ...]
    d_prime: tuple[Array, Array]
    confused: tuple[Array, Array]
    felt_and_named: Interval
    each_felt_and_named: tuple[Interval, ...]
    each: LaboratoryDraws

    @property
    def covers(self) -> tuple[str, ...]:
        """What varies between the draws, and is therefore in the intervals."""
        found, pairs = ["people", "constants"], self.pair_spread
        found += ["laboratory"] * bool(np.ptp(self._column(OFFSETS[0])) > NEGLIGIBLE)
        found += ["form of memory"] * bool(np.ptp(self._column(FORM)))
        return (*found, *["pairs of icons"] * (pairs is not None and len(self.detected) > 1))

    @property
    def pair_spread(self) -> Interval | None:
        """95 % of τ in these laboratories, ln; None where their pairs are those of the model."""
        spreads = self._column(PAIRS) if PAIRS in self.each.names else np.zeros(1)
        return interval_of(spreads) if spreads.max() > 0.0 else None

    def _column(self, name: str) -> Array:
        return self.each.values[:, self.each.names.index(name)]

    def pair(self, i: int, j: int, of: str = "d_prime") -> Interval:
        """Interval of the d′ of one pair, or of how often it is `confused`."""
        low, high = getattr(self, of)
        return float(low[i, j]), float(high[i, j])

    @property
    def persons(self) -> dict[str, Array]:
        """Felt and named, named, bits and least detection (n,) of single people, of all draws together."""
        return {
            "felt_and_named": self.each.persons_felt_and_named.reshape(-1),
            "named": self.each.persons_correct.reshape(-1),
            "bits": self.each.persons_bits.reshape(-1),
            "detected": self.each.persons_detected.reshape(-1),
        }

    def ahead_of(self, other: NewLaboratory) -> float:
        """The share of draws in which a person feels and names these better than the other's; a tie counts half."""
        own, others = self.each.persons_felt_and_named, other.each.persons_felt_and_named
        mine, theirs = (own, others) if own.shape == others.shape else (own[..., None], others[:, None])
        return float((mine > theirs).mean() + 0.5 * (mine == theirs).mean())

    def rows(self, names: Sequence[str]) -> list[dict[str, Any]]:
        """The intervals of every icon, by the keys of `rank --json`."""
        named = [self.pair(k, k, "confused") for k in range(len(names))]
        each = zip(names, self.detected, self.onset_s, named, self.each_felt_and_named, strict=True)
        keys, rows = ("name", *NEW_LABORATORY), each
        return [dict(zip(keys, row, strict=True)) for row in rows]

    def __repr__(self) -> str:
        (low, high), (least, most) = self.felt_and_named, self.information_bits
        return (
            f"NewLaboratory({self.draws} draws, {self.people} people each: "
            f"{100 * low:.1f}–{100 * high:.1f} % felt and named, {least:.2f}–{most:.2f} bits)"
        )


@dataclass(frozen=True, slots=True)
class Nominal:
    """The centre of intervals: the prediction for many people at the nominal constants."""

    proportion_correct: float
    information_bits: float
    detected: Array
    d_prime: Array
    onset_s: Array
    confused: Array
    each_felt_and_named: Array


def new_laboratory(
    tracks: Tracks,
    end_s: float,
    crowd: People,
    predicted: Nominal,
    memory: MemoryChoice,
    *,
    tracking: str | None = None,
    model: ObserverModel | None = None,
    draws: int = DRAWS,
    seed: int = 0,
    task: Task = USUAL,
    step: Callable[[], None] | None = None,
    cluster: tuple[str, str] | None = None,
) -> NewLaboratory:
    """Intervals about `predicted`, from `draws` sets of constants, evenly spaced; `step` is called after each.

    The first few people of the crowd feel the icons, at every EVERY-th instant; the rest is as in `rank`, and `cluster`
    as in `laboratory_draws`. Raises `ValueError` for fewer than two draws, which have no interval, and for an observer
    without draws.
    """
    if draws < 2:
        raise ValueError(f"an interval needs at least two draws of the constants, not {draws}")
    own, count = ObserverModel.of(model), len(tracks.names)
    status = own.drawn.header.status
    persons = crowd.part(0, min(len(crowd), people_for_intervals(count)))
    observers, rate_Hz = [own.nominal, *own.some_draws(draws)], RATE_HZ / (EVERY if count <= MANY else 2 * EVERY)

    def played(icons: Sequence[Icon], rig: Rig) -> ReceptorTemperatures:
        depths_m = rungs(observers, persons.corneum_m(rig))
        return ReceptorTemperatures.at_depths(icons, persons, rig, depths_m, end_s, rate_Hz, tracking)

    few = TrackTemperatures.of(tracks, played)
    each = laboratory_draws(
        lambda _: few, persons, memory, own, draws=draws, seed=seed, task=task, resampled=True, step=step,
        cluster=cluster,
    )  # fmt: skip
    # Means over all the people of the nominal observer: their sample belongs to the draw.
    shares, everybody, none = own.form_shares(memory), np.arange(len(persons)), np.zeros((count, count))
    forms = list(shares)
    average = replace(own.nominal, pair_spread=0.0)
    by_form = [
        scored(few, DrawnLaboratory(average, persons, form), forms[0], none, seed, task, everybody) for form in forms
    ]
    weights = list(shares.values())
    centre = [np.average(scores, axis=0, weights=weights) for scores in zip(*by_form, strict=True)]
    tops = (1.0, math.log2(count), 1.0, math.inf, math.inf, 1.0)
    shifts = {name: getattr(predicted, name) - own for name, own in zip(Nominal.__slots__, centre[:7], strict=True)}
    moved: dict[str, Any] = {}
    for name, top in zip(Nominal.__slots__, tops, strict=False):
        moved[name] = np.clip(getattr(each, name) + shifts[name], 0.0, top)
    persons_correct = np.clip(each.persons_correct + shifts["proportion_correct"], 0.0, 1.0)
    # What is felt and named was named: shifts of their own must not take it above that.
    alert_shift, named = shifts["each_felt_and_named"], np.diagonal(moved["confused"], axis1=1, axis2=2)
    moved["each_felt_and_named"] = np.clip(each.each_felt_and_named + alert_shift, 0.0, named)
    alert = np.clip(each.felt_and_named + alert_shift.mean(), 0.0, moved["proportion_correct"])
    persons_alert = np.clip(each.persons_felt_and_named + alert_shift.mean(), 0.0, persons_correct)
    apart, confused = (tuple(np.percentile(moved[name], COVER, axis=0)) for name in ("d_prime", "confused"))
    return NewLaboratory(
        draws=draws,
        people=len(persons),
        posterior=status,
        proportion_correct=interval_of(moved["proportion_correct"]),
        information_bits=interval_of(moved["information_bits"]),
        detected=tuple(map(interval_of, moved["detected"].T)),
        # Over the draws in which an icon is felt, where these are the most.
        onset_s=tuple(
            interval_of(each[np.isfinite(each)]) if 2 * np.isfinite(each).sum() > each.size else None
            for each in moved["onset_s"].T
        ),
        d_prime=apart,
        confused=confused,
        felt_and_named=interval_of(alert),
        each_felt_and_named=tuple(map(interval_of, moved["each_felt_and_named"].T)),
        each=replace(
            each,
            **moved,
            felt_and_named=alert,
            persons_correct=persons_correct,
            persons_bits=np.clip(each.persons_bits + shifts["information_bits"], 0.0, tops[1]),
            persons_felt_and_named=persons_alert,
        ),
    )


def interval_of(values: Array) -> Interval:
    """The middle 95 % of values (n,)."""
    low, high = np.percentile(values, COVER)
    return float(low), float(high)
