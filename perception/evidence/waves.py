"""A fixed set of waves: square, sine and triangle, on both sides of baseline and on one, with two periods.

All have one size, so that within a group nothing differs but the shape. The set is shipped as
`wave-confusions`; sizes and periods of published waves were not available in numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array

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
