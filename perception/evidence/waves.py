"""A fixed set of waves: square, sine and triangle, on both sides of baseline and on one, with two periods.

All have one size, so that within a group nothing differs but the shape. The set is shipped as
`wave-confusions`; sizes and periods of published waves were not available in numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..identification.confusion import normalised
from ..observer.channels import USUAL_NORM
from .identified import Identified, Score, named
from .predicted import Predicted

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

LIBRARY = "wave-confusions"
SHAPES = ("square", "sine", "triangle")
GROUPS = tuple((poles, period) for poles in ("bipolar", "unipolar") for period in (4, 8))
"""About baseline or below it, and period in s."""
TAIL_S = 2.0
PAIRS = tuple(combinations(SHAPES, 2))


@dataclass(frozen=True, slots=True)
class Likeness:
    """How alike two shapes of a group are at the skin: differences over the swing, largest and root mean square."""

    group: str
    pair: tuple[str, str]
    largest: float
    rms: float


@dataclass(frozen=True, slots=True)
class SkinWaves:
    """Skin temperatures of one group, °C (shapes, rows) on a clock in s, as a display makes them."""

    group: str
    time_s: Array
    skin_C: Array
    display_C: Array


def wave_name(shape: str, poles: str, period: int) -> str:
    """Name of an icon of the set.

    >>> wave_name("sine", "bipolar", 4)
    'sine-bipolar-4s'
    """
    return f"{shape}-{poles}-{period}s"


def with_others(icons: IconSet, others: IconSet) -> IconSet:
    """Two sets of one frame as one, the first ones first."""
    from thermicon.icons import IconSet

    return IconSet(icons.name, icons.title, icons.context, icons.metadata, (*icons.entries, *others.entries))


def skin_waves(rig: Rig) -> tuple[SkinWaves, ...]:
    """What the display of a rig makes of the waves, a group at a time."""
    from thermicon.circuit import simulate
    from thermicon.circuit.solver.simulate import duration_s
    from thermicon.icons import load_library

    icons, made = load_library(LIBRARY), []
    for poles, period in GROUPS:
        own = [icons[wave_name(shape, poles, period)] for shape in SHAPES]
        end = max(duration_s(icon, rig) for icon in own) + TAIL_S
        traces = [simulate(icon, rig, tail_s=end - duration_s(icon, rig)) for icon in own]
        rows = min(trace.time_s.size for trace in traces)
        skin, display = (
            np.stack([getattr(trace, f"{place}_C")[:rows] for trace in traces]) for place in ("skin", "display")
        )
        made.append(SkinWaves(f"{poles}, {period} s", traces[0].time_s[:rows], skin, display))
    return tuple(made)


def likeness(waves: tuple[SkinWaves, ...]) -> tuple[Likeness, ...]:
    """Differences of every pair of shapes in every group, over the swing that is prescribed."""
    found = []
    for group in waves:
        during = group.time_s <= group.time_s[-1] - TAIL_S
        swing = float(np.ptp(group.display_C[SHAPES.index("triangle")]))
        for pair in PAIRS:
            first, second = (group.skin_C[SHAPES.index(shape)][during] for shape in pair)
            apart = (first - second) / swing
            rms = float(np.sqrt((apart**2).mean()))
            found.append(Likeness(group.group, pair, float(np.abs(apart).max()), rms))
    return tuple(found)


def wave_shapes(found: Identified, alike: Sequence[Likeness]) -> tuple[Predicted, ...]:
    """How alike the shapes are at the skin, and whether they are each other's main confusions."""
    said = f"named from memory, {len(found.labels)} icons, {found.probability.shape[0]} people, {USUAL_NORM}"
    made = []
    for pair in PAIRS:
        both = " and ".join(pair)
        largest = max(one.largest for one in alike if one.pair == pair)
        made.append(
            Predicted(
                "wave shapes", f"largest difference of {both}", "both", largest, "1", None, None,
                found.variable, "skin temperature over the swing, largest of four groups",
            )
        )  # fmt: skip
        made.append(
            found.predicted(
                "wave shapes", f"confusion of {both} over any other", "1", _main(found.labels, pair), conditions=said
            )
        )
        made.append(
            found.predicted(
                "wave shapes",
                f"confusion of {both}",
                "proportion",
                _mixed(found.labels, pair),
                conditions=said,
                top=1.0,
            )
        )
    for shape in SHAPES:
        places = [found.labels.index(wave_name(shape, *group)) for group in GROUPS]
        scores = [named(place) for place in places]
        made.append(
            found.predicted(
                "wave shapes", f"proportion correct, {shape}", "proportion", _mean(scores), conditions=said, top=1.0
            )
        )
    return tuple(made)


def _against(
    pooled: Array, labels: Sequence[str], pair: tuple[str, str], group: tuple[str, int]
) -> tuple[float, float]:
    own = [labels.index(wave_name(shape, *group)) for shape in SHAPES]
    first, second = (labels.index(wave_name(shape, *group)) for shape in pair)
    mixed = 0.5 * (pooled + pooled.T)
    others = [k for k in range(len(labels)) if k not in own]
    return float(mixed[first, second]), float(mixed[[first, second]][:, others].max())


def _main(labels: Sequence[str], pair: tuple[str, str]) -> Score:
    def least(probability: Array) -> float:
        pooled = normalised(probability.mean(axis=0))
        return min(mixed / other for mixed, other in (_against(pooled, labels, pair, group) for group in GROUPS))

    return least


def _mixed(labels: Sequence[str], pair: tuple[str, str]) -> Score:
    def mean(probability: Array) -> float:
        pooled = normalised(probability.mean(axis=0))
        return float(np.mean([_against(pooled, labels, pair, group)[0] for group in GROUPS]))

    return mean


def _mean(scores: Sequence[Score]) -> Score:
    return lambda p: float(np.mean([score(p) for score in scores]))
