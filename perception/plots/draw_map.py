"""The picture of a perceptual map."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit.solver.draw import COOL, new_axes

from .draw_heat import short

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..identification.map import PerceptualMap

SHARE = 0.5
"""The share of people that an ellipse holds, if their maps scatter normally."""
INK, QUIET = "#1a1a1a", "#8a8a8a"
POINT = 9.0
"""Size of a name in points."""
FEW, SMALL, LARGE = 10, (7.2, 5.6), (10.0, 7.8)
"""Largest number of icons for the small size (inches)."""
NEAR = 8.0
"""A name farther than this many points from its dot is joined to it by a line."""


def plot_map(found: PerceptualMap, ax: Axes | None = None) -> Axes:
    """Icons where they lie in d′, dots with names, an ellipse for half of the people, the stress in the title."""
    axes = new_axes(ax, SMALL if len(found.labels) <= FEW else LARGE)
    if found.covariance is not None:
        for point, covariance in zip(found.points, found.covariance, strict=True):
            _ellipse(axes, point, covariance)
    axes.scatter(found.points[:, 0], found.points[:, 1], s=26, color=INK, zorder=3)
    _frame(axes, found)
    axes.set(xlabel="d′", ylabel="d′")
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_title(f"perceptual map (stress {found.stress:.2f})", loc="left")
    if found.covariance is not None:
        note = f"ellipses: {100 * SHARE:.0f} % of {found.people} people"
        axes.annotate(note, (1.0, 1.01), xycoords="axes fraction", ha="right", va="bottom", fontsize=8, color="#444444")
    _names(axes, found)
    return axes


def _ellipse(axes: Axes, point: Array, covariance: Array) -> None:
    from matplotlib.patches import Ellipse

    values, vectors = np.linalg.eigh(covariance)
    radius = np.sqrt(-2.0 * np.log(1.0 - SHARE) * np.maximum(values, 0.0))
    angle = float(np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1])))
    centre = (float(point[0]), float(point[1]))
    shape = {"width": 2.0 * float(radius[1]), "height": 2.0 * float(radius[0]), "angle": angle}
    axes.add_patch(Ellipse(centre, **shape, facecolor=COOL, alpha=0.10, edgecolor="none", zorder=1))
    axes.add_patch(Ellipse(centre, **shape, facecolor="none", edgecolor=COOL, lw=0.8, alpha=0.6, zorder=1))


def _frame(axes: Axes, found: PerceptualMap) -> None:
    """Equal scales that hold dots and ellipses, at least 1 d′, in the shape of the axes, so that nothing is empty."""
    half = np.zeros_like(found.points)
    if found.covariance is not None:
        half = np.sqrt(-2.0 * np.log(1.0 - SHARE) * np.diagonal(found.covariance, axis1=1, axis2=2))
    low, high = (found.points - half).min(axis=0), (found.points + half).max(axis=0)
    middle, size = (low + high) / 2.0, np.maximum(2.0, 1.2 * (high - low))
    _limit(axes, middle, size)
    inches = _inches(axes)
    _limit(axes, middle, (size / inches).max() * inches)
    axes.set_aspect("equal", adjustable="box")


def _limit(axes: Axes, middle: Array, size: Array) -> None:
    axes.set_xlim(middle[0] - size[0] / 2.0, middle[0] + size[0] / 2.0)
    axes.set_ylim(middle[1] - size[1] / 2.0, middle[1] + size[1] / 2.0)


def _inches(axes: Axes) -> Array:
    """Width and height of axes once the layout of their figure has settled."""
    figure: Any = axes.get_figure(root=True)
    figure.draw_without_rendering()
    box = axes.get_position()
    return np.array([figure.get_figwidth() * box.width, figure.get_figheight() * box.height])


def _names(axes: Axes, found: PerceptualMap) -> None:
    points_across = 72.0 * _inches(axes)
    low = np.array([axes.get_xlim()[0], axes.get_ylim()[0]])
    scale = (np.array([axes.get_xlim()[1], axes.get_ylim()[1]]) - low) / points_across
    names = [short(name, 34) for name in found.labels]
    size = POINT if len(names) <= 24 else 6.5
    dots = (found.points - low) / scale
    offsets = label_offsets(dots, names, points_across, size)
    for dot, name, offset in zip(dots, names, offsets, strict=True):
        x, y = low + dot * scale
        gap = np.abs(offset) - np.array([text_width(name, size), size]) / 2.0
        far = np.hypot(*np.maximum(gap, 0.0)) > NEAR
        line = {"arrowstyle": "-", "lw": 0.5, "color": QUIET, "shrinkA": 0.0, "shrinkB": 2.0} if far else None
        axes.annotate(
            name,
            (float(x), float(y)),
            xytext=(float(offset[0]), float(offset[1])),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=size,
            color=INK,
            arrowprops=line,
            zorder=4,
            annotation_clip=False,
            bbox={"facecolor": "w", "alpha": 0.7, "edgecolor": "none", "pad": 0.4},
        )


def label_offsets(dots: Array, names: Sequence[str], room: Array, size: float = POINT) -> Array:
    """Where the middle of each name goes, in points from its dot: the place that covers least, near ones first.

    `dots` (n, 2) and `room` (2,) are in points from the lower left corner; those with most neighbours come first.
    """
    boxes: list[tuple[float, float, float, float]] = []
    offsets = np.zeros_like(dots)
    gaps = np.linalg.norm(dots[:, None] - dots[None], axis=-1)
    crowded = (gaps < 80.0).sum(axis=1)
    for k in sorted(range(len(names)), key=lambda k: (-crowded[k], k)):
        wide, high = text_width(names[k], size) + 4.0, 1.3 * size
        least = np.inf
        for distance, angle in product((0.0, 9.0, 20.0, 34.0, 52.0, 74.0, 100.0), range(0, 360, 30)):
            towards = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
            offset = towards * (np.array([wide, high]) / 2.0 + 5.0 + distance)
            x, y = dots[k] + offset
            box = (x - wide / 2, y - high / 2, x + wide / 2, y + high / 2)
            covered = sum(
                max(0.0, min(box[2], other[2]) - max(box[0], other[0]))
                * max(0.0, min(box[3], other[3]) - max(box[1], other[1]))
                for other in boxes
            )
            hidden = sum(box[0] - 3 < px < box[2] + 3 and box[1] - 3 < py < box[3] + 3 for px, py in dots)
            outside = max(0.0, -box[0]) + max(0.0, -box[1]) + max(0.0, box[2] - room[0]) + max(0.0, box[3] - room[1])
            cost = covered + 400.0 * hidden + 60.0 * outside + distance + 0.5 * (angle % 90 != 0)
            if cost < least - 1e-9:
                offsets[k], least, taken = offset, cost, box
        boxes.append(taken)
    return offsets


def text_width(text: str, size: float) -> float:
    """Width in points of a text set in the letters of figures."""
    from matplotlib.textpath import TextPath

    return float(TextPath((0.0, 0.0), text, size=size).get_extents().width) if text.strip() else 0.0
