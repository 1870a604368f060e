"""The perceptual map as a small vector picture for the page: dots with names that keep clear of one another, ellipses.

The figure of ``perception`` is for print and takes most of a second; this one is made at every change of a set.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from thermicon.perception.arrays import Array
    from thermicon.perception.identification.map import PerceptualMap

WIDTH, LOWEST, HIGHEST, EDGE = 330.0, 110.0, 300.0, 14.0
LETTER, LINE, DOT = 5.9, 13.0, 3.5
"""Width and height that a name takes for each letter and line, and the radius of a dot, in pixels."""
HALF = float(np.sqrt(2.0 * np.log(2.0)))
"""Axes of the ellipse that holds half of the people, in standard deviations."""
MOST_LETTERS, SHOWN = 20, 0.5
RADII = (6.5, 20.0, 34.0, 48.0)
"""How far from its dot a name stands, in pixels; beyond the first it has a line to it."""
Box = tuple[float, float, float, float]


def map_svg(found: PerceptualMap) -> str:
    """Return the map as SVG in the colours of the page; one d′ is as long across as it is upwards.

    >>> import numpy as np
    >>> from thermicon.perception.identification.map import perceptual_map
    >>> map_svg(perceptual_map([[0, 3], [3, 0]], ["near", "far"])).count("<circle")
    2
    """
    points, spread = found.points, found.covariance
    reach = np.zeros_like(points) if spread is None else HALF * np.sqrt(np.diagonal(spread, 0, 1, 2))
    inside = SHOWN * reach  # of wide ellipses a part is cut off, or the dots of a dense set would be one heap
    low, high = (points - inside).min(axis=0), (points + inside).max(axis=0)
    names = distinct(found.labels)
    # Names stand beside their dots, so the middle of the picture is left for these.
    side = min(0.3 * WIDTH, 0.5 * LETTER * max(map(len, names)) + 2 * EDGE)
    room = WIDTH - 2 * side, HIGHEST - 5 * EDGE
    scale = min(room[k] / max(float(high[k] - low[k]), 1e-9) for k in (0, 1))
    middle = 0.5 * (low + high)
    height = max(LOWEST, float(high[1] - low[1]) * scale + 5 * EDGE)
    centre = np.array([0.5 * WIDTH - 0.25 * side, 0.5 * (height - EDGE)])
    places = centre + (points - middle) * scale * np.array([1.0, -1.0])
    each = [] if spread is None else list(zip(places, spread, strict=True))
    parts = [_ellipse(place, covariance, scale) for place, covariance in each]
    parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{DOT}" fill="currentColor"/>' for x, y in places]
    parts += _names(places, names, height)
    parts.append(_ruler(scale, height))
    said = escape(f"perceptual map of {', '.join(found.labels)}", quote=True)
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {height:.0f}" width="{WIDTH:g}" role="img" aria-label="{said}" '
        f'font-size="11" fill="currentColor">{"".join(parts)}</svg>'
    )


def distinct(names: Sequence[str]) -> list[str]:
    """Names short enough to stand beside a picture; as much of each stays as distinguishes it.

    >>> distinct(["ramp_extent=-2_rate=3_count=1", "ramp_extent=2_rate=3_count=1", "dip"])[2]
    'dip'
    """
    from thermicon.perception.plots.draw_heat import short

    for most in (MOST_LETTERS, 24, 28, 36):
        made = [short(name, most) for name in names]
        if len(set(made)) == len(names):
            return made
    return list(names)


def _ellipse(place: Sequence[float], covariance: Array, scale: float) -> str:
    values, vectors = np.linalg.eigh(covariance)
    across, along = HALF * scale * np.sqrt(np.maximum(values, 0.0))
    angle = -np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
    x, y = place
    return (
        f'<ellipse rx="{along:.1f}" ry="{across:.1f}" transform="translate({x:.1f} {y:.1f}) rotate({angle:.1f})" '
        'fill="var(--th-cool)" fill-opacity="0.12" stroke="var(--th-cool)" stroke-opacity="0.55"/>'
    )


def _names(places: Sequence[Sequence[float]], names: Sequence[str], height: float) -> list[str]:
    """Each name on the side of its dot where it covers least of what is there."""
    taken: list[Box] = [(x - DOT, y - DOT, x + DOT, y + DOT) for x, y in places]
    made = []
    for (x, y), name in zip(places, names, strict=True):
        wide, sides = LETTER * len(name), list[tuple[float, float]]()
        for gap in RADII:
            slant = 0.75 * gap + 4.0
            sides += [(x + gap, y), (x - gap - wide, y), (x - 0.5 * wide, y - gap - 4), (x - 0.5 * wide, y + gap + 4)]
            sides += [(x + slant, y - slant), (x + slant, y + slant)]
            sides += [(x - slant - wide, y - slant), (x - slant - wide, y + slant)]
        boxes = [(left, at - 0.5 * LINE, left + wide, at + 0.5 * LINE) for left, at in sides]
        best = min(range(len(boxes)), key=lambda k: (round(_covered(boxes[k], taken, height)), k))
        taken.append(boxes[best])
        left, at = sides[best]
        if best >= len(sides) // len(RADII):
            to = min(max(x, left), left + wide)
            line = f'<path d="M{x:.1f} {y:.1f}L{to:.1f} {at:.1f}" stroke="currentColor" stroke-opacity="0.4"/>'
            made.append(line)
        made.append(f'<text x="{left:.1f}" y="{at + 3.8:.1f}">{escape(name)}</text>')
    return made


def _covered(box: Box, taken: Sequence[Box], height: float) -> float:
    """Area that a box takes of others, and far more for what lies outside of the picture."""
    left, top, right, bottom = box
    shared = sum(
        max(0.0, min(right, other[2]) - max(left, other[0])) * max(0.0, min(bottom, other[3]) - max(top, other[1]))
        for other in taken
    )
    outside = max(0.0, -left) + max(0.0, right - WIDTH) + max(0.0, -top) + max(0.0, bottom - height)
    return shared + 100.0 * outside


def _ruler(scale: float, height: float) -> str:
    """How long a d′ is: 1, 2 or 5 of them, or a tenth or ten times as many."""
    sizes = [step * 10.0**power for power in range(-3, 4) for step in (1, 2, 5)]
    size = next((size for size in sizes if size * scale >= 40.0), sizes[-1])
    y, end = height - 8.0, EDGE + min(size * scale, WIDTH - 2 * EDGE - 60.0)
    return (
        f'<path d="M{EDGE} {y - 4}V{y}H{end:.1f}V{y - 4}" fill="none" stroke="currentColor"/>'
        f'<text x="{end + 6:.1f}" y="{y + 1}">d′ {size:g}</text>'
    )
