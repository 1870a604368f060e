"""``thermicon check``: all that is wrong with some cue files, or one line a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from thermicon.notebooks.cues import warn_of_site
from thermicon.notebooks.door import fail
from thermicon.notebooks.wording import number, span

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet

START_C = 32.0
"""Where an icon starts when neither its file nor a rig says: the rest of the default rig."""


def check(files: Sequence[str], rig: Rig | None = None) -> None:
    """Print one line a file, or every error of every file and exit with 1; with a rig, its static limits count too."""
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
    """What the rig cannot do of this set, a message each; another site is only a warning, told on stderr."""
    from thermicon.circuit import check_static

    warn_of_site(file, icons, rig)
    return [f"{file}: {message}" for icon in icons for message in check_static(icon, rig)]


def summary(icons: IconSet, start_C: float) -> str:
    """Say how many icons there are, how long, from what to what and how steep, for example ``2 icons, 8–10 s, …``."""
    count = f"{len(icons)} icon{'' if len(icons) == 1 else 's'}"
    parts = [count]
    by_current = [icon for icon in icons if icon.frame.control == "current"]
    by_temperature = [icon for icon in icons if icon.frame.control != "current"]
    for group, unit, digits in ((by_temperature, "°C", 1), (by_current, "A", 2)):
        if group:
            parts += _levels(group, unit, digits, start_C)
    return ", ".join(parts)


def _levels(icons: Sequence[Icon], unit: str, digits: int, start_C: float) -> list[str]:
    corners = [icon.lower(_start(icon, start_C)) for icon in icons]
    durations = [corner.duration_s for corner in corners]
    steepest = max(corner.steepest_per_s for corner in corners)
    return [
        span(min(durations), max(durations), "s"),
        span(min(corner.lowest for corner in corners), max(corner.highest for corner in corners), unit, digits),
        f"steepest {number(steepest, 2)} {unit}/s",
    ]


def _start(icon: Icon, start_C: float) -> float:
    if icon.frame.control == "current":
        return 0.0
    return start_C if icon.frame.baseline_C is None else icon.frame.baseline_C
