"""How a figure is to look in print: the options of every command that draws one, and their checks."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from ..messages import usage

STYLES = ("screen", "paper")
MM = {"mm": 1.0, "cm": 10.0, "in": 25.4}
NARROWEST_MM, WIDEST_MM = 40.0, 500.0
"""Below, labels are wider than panels; above, no printer takes it."""
NARROW_MM, PANEL_MM = 120.0, 42.0
"""Narrower figures have their keys below the panels; a panel with labels needs about this width."""
KINDS = ("png", "pdf", "svg")

FigureFile = Annotated[
    Path | None,
    typer.Option("--figure", metavar="OUT", readable=False, help="Draw the figure: .pdf, .svg or .png."),
]
FigureFolder = Annotated[
    Path | None,
    typer.Option(
        "--figure",
        metavar="DIR|OUT",
        readable=False,
        help="Write all figures to the folder DIR, or that of the set to a .pdf, .svg or .png file.",
    ),
]
FigureFormat = Annotated[
    str | None,
    typer.Option("--figure-format", metavar="|".join(KINDS), help="Type of the files in a folder.  [default: png]"),
]
FigureWidth = Annotated[
    str | None, typer.Option("--width", metavar="WIDTH", help="Width of the figure, such as 85mm, 18cm or 7in.")
]
FigureStyle = Annotated[
    str,
    typer.Option("--style", metavar="|".join(STYLES), help="Style of the figure; paper adds panel letters."),
]
NoTitle = Annotated[bool, typer.Option("--no-title", help="Draw the figure without its title.")]


@dataclass(frozen=True, slots=True)
class Look:
    """Style, width in mm (None: as drawn, on paper at most 180), title, type of files in a folder."""

    style: str = "screen"
    width_mm: float | None = None
    title: bool = True
    kind: str = KINDS[0]

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


def figure_look(
    figure: Path | None,
    width: str | None,
    style: str,
    no_title: bool,
    kind: str | None = None,
) -> Look:
    """Check the options of a figure; without ``--figure`` there is nothing that they could change."""
    given = (
        ("--width", width),
        ("--style", style != STYLES[0]),
        ("--no-title", no_title),
        ("--figure-format", kind),
    )
    if figure is None:
        for option, value in given:
            if value:
                raise usage("belongs to a figure; name its file with --figure", option)
    if style not in STYLES:
        raise usage(f"{style!r} is not one of {', '.join(STYLES)}", "--style")
    if kind is not None and kind not in KINDS:
        raise usage(f"{kind!r} is not one of {', '.join(KINDS)}", "--figure-format")
    return Look(style, None if width is None else read_width_mm(width), not no_title, kind or KINDS[0])


def read_width_mm(text: str) -> float:
    """Read a width with its unit, in mm.

    >>> read_width_mm("85mm"), read_width_mm("8.5 cm")
    (85.0, 85.0)
    """
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(mm|cm|in)\s*", text)
    if match is None:
        raise usage(f"{text!r} is not a width with a unit, such as 85mm, 18cm or 7in", "--width")
    width = round(float(match[1]) * MM[match[2]], 6)
    if not NARROWEST_MM <= width <= WIDEST_MM:
        raise usage(f"{text.strip()} is outside {NARROWEST_MM:g} to {WIDEST_MM:g} mm", "--width")
    return width
