"""Which constants the answers moved or narrowed, measured by how far their distribution went from what it was."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array

CHANCE = 6.0
"""Bits times draws that the largest of some fifty constants seems to gain by chance alone."""


@dataclass(frozen=True, slots=True)
class ChangedConstant:
    """One constant before and after: median and 95 %. `shift` is in SDs of before, `narrowed` the SD left over it.

    `bits` is the information gained, the divergence of two normals with these means and SDs (on a log scale for
    positive constants).
    """

    name: str
    before: tuple[float, float, float]
    after: tuple[float, float, float]
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
        return ChangedConstant(name, _ends(before), _ends(after), 0.0, 1.0, 0.0)
    shift, ratio = float(new.mean() - old.mean()) / spread, left / spread
    bits = (0.5 * (ratio**2 + shift**2 - 1.0) - math.log(ratio)) / math.log(2.0)
    return ChangedConstant(name, _ends(before), _ends(after), shift, ratio, bits)


def _ends(values: Array) -> tuple[float, float, float]:
    middle, low, high = np.percentile(values, [50.0, 2.5, 97.5]).tolist()
    return middle, low, high
