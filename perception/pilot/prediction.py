"""What a new experiment of a laboratory will find, from a sample of laboratories: scores of a set with intervals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from ..arrays import Array
from .playing import Confusions

COVER = (2.5, 97.5)
Three = tuple[float, float, float]
"""Mean, and both ends of a 95 % interval."""


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
