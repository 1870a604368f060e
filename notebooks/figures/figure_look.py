"""How a figure is to look: on a screen, or in print at a width."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ..messages import usage

MM = {"mm": 1.0, "cm": 10.0, "in": 25.4}
NARROWEST_MM, WIDEST_MM = 40.0, 500.0
"""Below, labels are wider than panels; above, no printer takes it."""
NARROW_MM, PANEL_MM = 120.0, 42.0
"""Narrower figures have their keys below the panels; a panel with labels needs about this width."""


@dataclass(frozen=True, slots=True)
class Look:
    """Style, width in mm (None: as drawn, on paper at most 180), title, type of files in a folder."""

    style: str = "screen"
    width_mm: float | None = None
    title: bool = True
    kind: str = "png"

    def across(self, panels: int) -> int:
        """How many panels fit beside one another, of those that stand so where there is room.

        >>> Look().across(3), Look(width_mm=85.0).across(3), Look(width_mm=180.0).across(3)
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
