"""What a new laboratory will find: a prediction repeated with draws from the posterior, people and laboratory included.

Each draw invites a random sample of the same few people. Draws are laid about the prediction for many people: what a
draw adds is its difference from the nominal observer with the same people and noise.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..observer.channels import Norm
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from .depths import rungs
from .laboratory_draws import EVERY, MANY, LaboratoryDraws, laboratory_draws, people_for_intervals, scored
from .population import RATE_HZ, ReceptorTemperatures
from .task import USUAL, Task

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

DRAWS = 128
"""The ends of the interval scatter by one to two points of per cent correct from seed to seed."""
COVER = (2.5, 97.5)

Interval = tuple[float, float]
NEW_LABORATORY = (
    *("detected_interval_new_laboratory", "onset_interval_new_laboratory_s"),
    "proportion_correct_interval_new_laboratory",
)
"""Keys of the intervals of an icon in the JSON of `rank`."""


@dataclass(frozen=True, slots=True)
class NewLaboratory:
    """95 % intervals of what a new laboratory will find: people, constants and laboratory together.

    Proportion correct and bits of the set, as the mean over `people` invited, detected share of every icon in file
    order, its onset in the draws in which it is felt (None where it is not felt in most), d′ of every pair (icons,
    icons) and how often it is `confused`, on the diagonal named correctly, lower and upper.
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
    each: LaboratoryDraws

    def pair(self, i: int, j: int, of: str = "d_prime") -> Interval:
        """Interval of the d′ of one pair, or of how often it is `confused`."""
        low, high = getattr(self, of)
        return float(low[i, j]), float(high[i, j])

    @property
    def persons(self) -> dict[str, Array]:
        """Proportion correct, bits and least detection (n,) of single people, of all draws together."""
        return {
            "correct": self.each.persons_correct.reshape(-1),
            "bits": self.each.persons_bits.reshape(-1),
            "detected": self.each.persons_detected.reshape(-1),
        }

    def ahead_of(self, other: NewLaboratory) -> float:
        """How often a person names these icons better than the other's, on the same draws; a tie counts half.

        People are paired where both sets were judged by equally many.
        """
        mine, theirs = self.each.persons_correct[..., None], other.each.persons_correct[:, None]
        if mine.shape[1] == theirs.shape[2]:
            mine, theirs = self.each.persons_correct, other.each.persons_correct
        return float((mine > theirs).mean() + 0.5 * (mine == theirs).mean())

    def rows(self, names: Sequence[str]) -> list[dict[str, Any]]:
        """The intervals of every icon, by the keys of `rank --json`."""
        named = [self.pair(k, k, "confused") for k in range(len(names))]
        keys = ("name", *NEW_LABORATORY)
        return [
            dict(zip(keys, row, strict=True)) for row in zip(names, self.detected, self.onset_s, named, strict=True)
        ]

    def __repr__(self) -> str:
        (low, high), (least, most) = self.proportion_correct, self.information_bits
        return (
            f"NewLaboratory({self.draws} draws, {self.people} people each: "
            f"{100 * low:.1f}–{100 * high:.1f} % correct, {least:.2f}–{most:.2f} bits)"
        )


@dataclass(frozen=True, slots=True)
class Nominal:
    """What intervals are laid about: the prediction for many people at the nominal constants."""

    proportion_correct: float
    information_bits: float
    detected: Array
    d_prime: Array
    onset_s: Array
    confused: Array = field(default_factory=lambda: np.array(math.nan))


def new_laboratory(
    icons: Sequence[Icon],
    rig: Rig,
    end_s: float,
    crowd: People,
    predicted: Nominal,
    norm: Norm,
    *,
    tracking: str | None = None,
    model: ObserverModel | None = None,
    draws: int = DRAWS,
    seed: int = 0,
    task: Task = USUAL,
    step: Callable[[], None] | None = None,
) -> NewLaboratory:
    """Intervals about `predicted`, from `draws` sets of constants, evenly spaced; `step` is called after each.

    The first few people of the crowd feel the icons, played on the rig until `end_s`, at every EVERY-th instant; each
    draw adds to the prediction what it changes against the nominal observer on the same people and noise. Norm,
    tracking, task and seed are as in `rank`.
    Raises `ValueError` for fewer than two draws, which have no interval, and for an observer without draws.
    """
    if draws < 2:
        raise ValueError(f"an interval needs at least two draws of the constants, not {draws}")
    own = ObserverModel.load() if model is None else model
    if own.posterior is None:
        raise ValueError(f"{own.name} has no posterior draws, from which an interval for a new laboratory is made")
    count = len(icons)
    persons = crowd.part(0, min(len(crowd), people_for_intervals(count)))
    few = ReceptorTemperatures.at_depths(
        icons, persons, rig, rungs([own.nominal, *own.some_draws(draws)], persons.corneum_m(rig)), end_s,
        RATE_HZ / (EVERY if count <= MANY else 2 * EVERY), tracking,
    )  # fmt: skip
    each = laboratory_draws(
        lambda _: few, persons, norm, own, draws=draws, seed=seed, task=task, resampled=True, step=step
    )
    # Means over all the people of the nominal observer: their sample belongs to the draw.
    centre = scored(few, persons, own.nominal, norm, seed, task, np.arange(len(persons)))
    about: tuple[Any, ...] = astuple(predicted)
    most = (1.0, math.log2(count), 1.0, math.inf, math.inf, 1.0)
    raw = (each.proportion_correct, each.information_bits, each.detected, each.d_prime, each.onset_s, each.confused)
    correct, bits, detected, apart, onset, confused = (
        np.clip(values + (nominal - own_values), 0.0, top)
        for values, nominal, own_values, top in zip(raw, about, centre[:6], most, strict=True)
    )
    apart_ends, confused_ends = (tuple(np.percentile(values, COVER, axis=0)) for values in (apart, confused))
    return NewLaboratory(
        draws=draws,
        people=len(persons),
        posterior=own.posterior.header.status,
        proportion_correct=_ends(correct),
        information_bits=_ends(bits),
        detected=tuple(_ends(detected[:, icon]) for icon in range(count)),
        # Over the draws in which an icon is felt, where these are the most.
        onset_s=tuple(
            _ends(each[np.isfinite(each)]) if 2 * np.isfinite(each).sum() > each.size else None for each in onset.T
        ),
        d_prime=apart_ends,
        confused=confused_ends,
        each=replace(
            each,
            proportion_correct=correct,
            information_bits=bits,
            detected=detected,
            d_prime=apart,
            onset_s=onset,
            confused=confused,
            persons_correct=np.clip(each.persons_correct + (predicted.proportion_correct - centre[0]), 0.0, 1.0),
            persons_bits=np.clip(each.persons_bits + (predicted.information_bits - centre[1]), 0.0, most[1]),
        ),
    )


def _ends(values: Array) -> Interval:
    low, high = np.percentile(values, COVER)
    return float(low), float(high)
