"""``thermicon check``: every error in some cue files, or one line per file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from thermicon.icons.number_text import number, span

from ..messages import fail, note
from .cues import MOST_ICONS, warn_of_site

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet

START_C = 32.0
"""Initial temperature without a baseline or a rig: the resting temperature of the default rig."""


def check(files: Sequence[str], rig: Rig | None = None) -> None:
    """Print one line per file, or every error of every file and exit with 1; with a rig, check its limits too."""
    from thermicon.icons import CueErrors, read_cue

    problems: list[str] = []
    lines: list[str] = []
    for file in files:
        try:
            icons = read_cue(file)
            # Families expand lazily, so an icon's own errors may show only here.
            lines.append(f"{Path(file).name}: {summary(icons, START_C if rig is None else rig.skin.rest_C)}")
        except CueErrors as errors:
            problems.append(str(errors))
            continue
        except ValueError as error:  # a rest that the language has no levels for
            problems.append(f"{file}: {error}")
            continue
        if rig is not None:
            problems += against_rig(icons, rig, file)
    if problems:
        fail("\n\n".join(problems))
    for line in lines:
        typer.echo(line)


def against_rig(icons: IconSet, rig: Rig, file: str) -> list[str]:
    """One message for everything in this set that the rig cannot do; another site is only a warning on stderr."""
    from thermicon.circuit.solver.static import check_static

    warn_of_site(file, icons, rig)
    count = len(icons)
    chosen: Sequence[Icon] = icons.icons
    if count > MOST_ICONS:
        chosen = [chosen[place * count // MOST_ICONS] for place in range(MOST_ICONS)]
        note(f"{file}: {MOST_ICONS:,} of its {count:,} icons, evenly spaced, were checked against the rig")
    return [f"{file}: {message}" for icon in chosen for message in check_static(icon, rig)]


def summary(icons: IconSet, start_C: float) -> str:
    """Summarise number, durations, levels and steepest slope of the icons, as in ``2 icons, 8–10 s, …``."""
    current = icons.context.control == "current"
    unit, digits = ("A", 2) if current else ("°C", 1)
    found = icons.summary(0.0 if current else start_C)
    parts = [
        f"{len(icons):,} icon{'' if len(icons) == 1 else 's'}",
        span(found.shortest_s, found.longest_s, "s"),
        span(found.lowest, found.highest, unit, digits),
    ]
    return ", ".join([*parts, f"steepest {number(found.steepest_per_s, 2)} {unit}/s"])
