"""``thermicon check``: the errors of cue files."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.base.files.atomic import OutputError, complete_or_absent
from thermicon.base.words.number_text import number, span
from thermicon.perception.criteria import MOST_ICONS

from ..files.outputs import check_output
from ..loading import site_meant
from ..messages import MissingArgument, fail, note, usage
from .options import command_text, flag, opt

if TYPE_CHECKING:
    from thermicon.icons import IconSet

NoFiles = Annotated[list[str] | None, typer.Argument(metavar="FILE", help="Cue files, or shipped sets.")]
START_C = 32.0
"""Initial temperature without a baseline: the resting temperature of the default rig."""


def check_command(
    files: NoFiles = None,
    fix: Annotated[
        bool, flag("--fix", "Format files in canonical layout, in place; comments, numbers and units stay.")
    ] = False,
    explain: Annotated[
        str | None, opt("CODE", "Instead: explain an error by its code, such as E102, or its title.")
    ] = None,
) -> None:
    """Check cue files and report every error in them, or one line per file when there is none.

    simulate reports whether a rig reaches the target in time. With --fix, files without an error are formatted.
    """
    if explain is not None:
        if files or fix:
            raise usage("stands alone: leave out FILE and the other options", "--explain")
        from thermicon.icons.files.catalogue import explain as explained

        try:
            typer.echo(explained(explain))
        except ValueError as unknown:
            raise usage(str(unknown), "--explain") from None
        return
    if not files:
        raise MissingArgument("argument 'FILE...'")
    if fix:
        format_files(files)
    check(files)


def format_files(files: Sequence[str]) -> None:
    """Write sound files in canonical layout, each whole or not at all; what is wrong in the others, a check says."""
    from thermicon.icons import CueErrors
    from thermicon.icons.files.shipped import file_bytes, library_names

    for file in files:
        try:
            before = file_bytes(file)
            if before is None and file in library_names():
                raise OutputError(f"{file}: a shipped set cannot be changed; give the name of your own file")
            after = None if before is None else canonical(before, file)
        except CueErrors:
            continue
        if after is not None and after != before:
            check_output(Path(file), (), "a cue file")
            with complete_or_absent(Path(file)) as draft:
                draft.write_bytes(after)
                shutil.copymode(file, draft)
            note(f"{file}: formatted")


def canonical(data: bytes, file: str) -> bytes:
    """Return a cue file in canonical layout; CueErrors when it is not sound.

    Line ends are those of the first line, Windows' or not, and a byte order mark is taken away.
    """
    from thermicon.icons import format_text

    text = format_text(data, file)
    first, newline, _ = data.partition(b"\n")
    return (text.replace("\n", "\r\n") if newline and first.endswith(b"\r") else text).encode()


def check(files: Sequence[str]) -> None:
    """Print one line per file, or every error of every file and exit with 1."""
    from thermicon.icons import CueErrors, read_cue

    problems: list[str] = []
    lines: list[str] = []
    for file in files:
        try:
            icons = read_cue(file)
            # Families expand lazily, so an icon's own errors may show only here.
            lines.append(f"{Path(file).name}: {summary(icons)}")
            if icons.context.site and (meant := site_meant(icons.context.site)):
                note(f"warning: {file}: no rig and no data are for the site {icons.context.site}{meant}")
        except CueErrors as errors:
            problems.append(str(errors))
    if problems:
        fail("\n\n".join(problems))
    for line in lines:
        typer.echo(line)
    if len(files) == 1 and not icons.spatial:
        note(f"Next: {command_text(files, paths=True, command='rank' if 1 < len(icons) <= MOST_ICONS else 'simulate')}")


def summary(icons: IconSet) -> str:
    """Summarise number, durations, levels and steepest slope of the icons, as in ``2 icons, 8–10 s, …``."""
    current = icons.context.control == "current"
    unit, digits = ("A", 2) if current else ("°C", 1)
    found = icons.summary(0.0 if current else START_C)
    parts = [
        f"{len(icons):,} icon{'' if len(icons) == 1 else 's'}{_where(icons)}",
        span(found.shortest_s, found.longest_s, "s"),
        span(found.lowest, found.highest, unit, digits),
    ]
    return ", ".join([*parts, f"steepest {number(found.steepest_per_s, 2)} {unit}/s"])


def _where(icons: IconSet) -> str:
    """On which elements, and how many different tracks they play."""
    tracks = {track.statements for icon in icons.spatial for track in icon.tracks.values()}
    count = f"{len(tracks)} different track{'' if len(tracks) == 1 else 's'}"
    return f" on {', '.join(icons.context.elements)} ({count})" if icons.spatial else ""
