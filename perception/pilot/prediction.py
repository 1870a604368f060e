"""What samples of laboratories say before and after data: scores of sets in a new experiment, and constants.

Which constants the data moved or narrowed is measured by how far their distribution went from what it was.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from ..arrays import Array
from .playing import Confusions

COVER = (2.5, 97.5)
Three = tuple[float, float, float]
"""Mean or median, and both ends of a 95 % interval."""
CHANCE = 6.0
"""Bits times draws that the largest of some fifty constants seems to gain by chance alone."""


@dataclass(frozen=True, slots=True)
class SetPrediction:
    """Scores of a set as means over people who did not take part, each with 95 % of the laboratories.

    `icons` has the proportion correct of each icon, `pairs` the confusions of each pair (mean of both directions).
    """

    title: str
    people: int
    proportion_correct: Three
    information_bits: Three
    icons: Mapping[str, Three]
    pairs: Mapping[tuple[str, str], Three]

    @classmethod
    def of(cls, title: str, played: Confusions) -> SetPrediction:
        """Summarise the laboratories of a sample."""
        pooled, names = played.pooled, played.icons
        mixed = 0.5 * (pooled + np.swapaxes(pooled, 1, 2))
        return cls(
            title,
            int(played.probability.shape[1]),
            three(played.correct),
            three(played.bits),
            {name: three(pooled[:, k, k]) for k, name in enumerate(names)},
            {(names[a], names[b]): three(mixed[:, a, b]) for a, b in combinations(range(len(names)), 2)},
        )

    @property
    def width(self) -> float:
        """Width of the interval of the proportion correct."""
        return self.proportion_correct[2] - self.proportion_correct[1]

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "people": self.people,
            "proportion_correct": list(self.proportion_correct),
            "information_bits": list(self.information_bits),
            "icons": {name: list(each) for name, each in self.icons.items()},
            "pairs": [{"a": a, "b": b, "confused": list(each)} for (a, b), each in self.pairs.items()],
        }


@dataclass(frozen=True, slots=True)
class ChangedPrediction:
    """The prediction of one set before and after answers were seen."""

    before: SetPrediction
    after: SetPrediction

    @classmethod
    def of(cls, title: str, before: Confusions, after: Confusions) -> ChangedPrediction:
        """Summarise the laboratories of the samples before and after."""
        return cls(SetPrediction.of(title, before), SetPrediction.of(title, after))

    @property
    def narrower(self) -> float:
        """By which factor the interval of the proportion correct got narrower (below 1: wider)."""
        return self.before.width / self.after.width if self.after.width > 0.0 else float("inf")

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "title": self.before.title,
            "before": self.before.to_dict(),
            "after": self.after.to_dict(),
            "narrower": self.narrower,
        }


def three(values: Array) -> Three:
    """Mean and 95 % of some values."""
    low, high = np.percentile(values, COVER).tolist()
    return float(values.mean()), low, high


def median_three(values: Array) -> Three:
    """Median and 95 % of some values."""
    middle, low, high = np.percentile(values, [50.0, *COVER]).tolist()
    return middle, low, high


@dataclass(frozen=True, slots=True)
class ChangedConstant:
    """One constant before and after: median and 95 %. `shift` is in SDs of before, `narrowed` the SD left over it.

    `bits` is the information gained, the divergence of two normals with these means and SDs (on a log scale for
    positive constants).
    """

    name: str
    before: Three
    after: Three
    shift: float
    narrowed: float
    bits: float
    unit: str = ""

    def to_dict(self) -> dict[str, object]:
        """Plain data for JSON."""
        return {
            "constant": self.name,
            "unit": self.unit,
            "before": list(self.before),
            "after": list(self.after),
            "shift_sd": self.shift,
            "sd_left": self.narrowed,
            "bits": self.bits,
        }


def changed(
    names: Sequence[str], before: Array, after: Array, effective: float, units: Sequence[str] = ()
) -> tuple[ChangedConstant, ...]:
    """Constants that changed by more than chance, the most changed first; columns of both arrays belong to `names`.

    `effective` is how many independent draws stand behind `after`; `units` (none: empty) belong to `names` too.

    >>> rng = np.random.default_rng(0)
    >>> old, new = rng.standard_normal((400, 2)), rng.standard_normal((400, 2)) * [0.5, 1.0] + [1.0, 0.0]
    >>> [each.name for each in changed(["a", "b"], old, new, 400.0)]
    ['a']
    """
    known = units or [""] * len(names)
    found = [replace(_change(name, before[:, k], after[:, k]), unit=known[k]) for k, name in enumerate(names)]
    least = CHANCE * (1.0 / effective + 1.0 / len(before))
    return tuple(sorted((each for each in found if each.bits >= least), key=lambda each: -each.bits))


def _change(name: str, before: Array, after: Array) -> ChangedConstant:
    logs = bool((before > 0.0).all() and (after > 0.0).all())
    old, new = (np.log(each) if logs else each for each in (before, after))
    spread, left = float(old.std()), float(new.std())
    if not spread > 0.0 or not left > 0.0:
        return ChangedConstant(name, median_three(before), median_three(after), 0.0, 1.0, 0.0)
    shift, ratio = float(new.mean() - old.mean()) / spread, left / spread
    bits = (0.5 * (ratio**2 + shift**2 - 1.0) - math.log(ratio)) / math.log(2.0)
    return ChangedConstant(name, median_three(before), median_three(after), shift, ratio, bits)
