"""The style of all figures."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..messages import usage

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COOL, WARM = "#2166ac", "#e08214"
BROAD = "#b9bec4"
"""A broad line below a thin one: the first of two, or what was predicted before."""
INK, GREY, TARGET, LIMIT = "#1a1a1a", "#6a6a6a", "#cfe3cf", "#b2182b"
PLACES: dict[str, tuple[str, Any, float]] = {
    "display": (GREY, (0, (6, 2)), 1.2),
    "skin": (INK, "-", 1.6),
    "cold receptor": (COOL, "-.", 1.4),
    "warm receptor": (WARM, "--", 1.4),
}
"""Colour, dashes and width of what is measured at each place: dashes differ too, so that it can be printed in grey."""
MM = {"mm": 1.0, "cm": 10.0, "in": 25.4}
NARROWEST_MM, WIDEST_MM = 40.0, 500.0
"""Below, labels are wider than panels; above, no printer takes it."""
NARROW_MM, PANEL_MM = 120.0, 42.0
"""Narrower figures have their keys below the panels; a panel with labels needs about this width."""


@dataclass(frozen=True, slots=True)
class Look:
    """The purpose of a figure: print, so many mm wide, or a screen (None)."""

    width_mm: float | None = None

    def across(self, panels: int) -> int:
        """The number of panels side by side where there is room.

        >>> Look().across(3), Look(85.0).across(3), Look(180.0).across(3)
        (3, 2, 3)
        """
        return panels if self.width_mm is None else min(panels, max(1, int(self.width_mm // PANEL_MM)))

    @property
    def narrow(self) -> bool:
        """Whether keys do not fit beside the panels."""
        return self.width_mm is not None and self.width_mm < NARROW_MM


SCREEN = Look()


def read_width_mm(text: str) -> float:
    """Read a width with its unit, in mm.

    >>> read_width_mm("85mm"), read_width_mm("8.5 cm")
    (85.0, 85.0)
    """
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(mm|cm|in)\s*", text)
    if match is None:
        raise usage(f"{text!r} is not a width with a unit, such as 85mm, 18cm or 7in", "--paper")
    width = round(float(match[1]) * MM[match[2]], 6)
    if not NARROWEST_MM <= width <= WIDEST_MM:
        raise usage(f"{text.strip()} is outside {NARROWEST_MM:g} to {WIDEST_MM:g} mm", "--paper")
    return width


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of so many inches, outside of pyplot, whose parts make room for one another."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def plain(*axes: Axes) -> None:
    """Give axes a faint grid, and no frame at the top and at the right."""
    for ax in axes:
        ax.grid(alpha=0.25, linewidth=0.6)
        ax.spines[["top", "right"]].set_visible(False)


def on_one_clock(figure: Figure, axes: Sequence[Axes], time: str, title: str) -> None:
    """Dress panels below one another on one axis of time: grid, keys beside them, name of the axis, title."""
    for ax in axes:
        plain(ax)
        ax.margins(x=0.0)
        # at the right, outside, where it covers no line
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8, handlelength=2.6)
    axes[-1].set_xlabel(time)
    figure.align_ylabels(list(axes))
    figure.suptitle(title, fontsize=11, wrap=True)
