"""``thermicon convert``: icons as cue text or JSON, and recordings as icons."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from thermicon.icons.atomic import OutputError
from thermicon.icons.number_text import number

from ..files.outputs import STDOUT, check_output
from ..messages import fail, note, usage
from .options import opt, out, read_set, write_text

if TYPE_CHECKING:
    from thermicon.icons import IconSet

SUFFIXES = (".cue", ".json")


def convert_command(
    file: Annotated[str, typer.Argument(metavar="FILE", help="A .cue or .csv file, or a shipped set.")],
    output: Annotated[
        Path,
        out("OUT", "The file to write: .cue or .json.", "-o", "--output"),
    ],
    tolerance: Annotated[
        float | None,
        opt("K", "For .csv: largest deviation of the icon from the recording, in K.", name="--tolerance"),
    ] = None,
    name: Annotated[str | None, opt("NAME", "For .csv: the name of the icon.", name="--name")] = None,
    column: Annotated[str | None, opt("COLUMN", "For .csv: the column of temperatures.", name="--column")] = None,
    control: Annotated[
        Literal["skin", "display"] | None,
        typer.Option(help="For .csv: whether skin or display temperatures were recorded."),
    ] = None,
) -> None:
    """Write icons as a cue file or, for other programs, as JSON, as the ending says.

    JSON keeps everything except comments. A recording (.csv) becomes an icon of a few straight pieces.
    """
    recording = {"tolerance_K": tolerance, "name": name, "column": column, "control": control}
    given = {key: value for key, value in recording.items() if value is not None}
    if given and not file.lower().endswith(".csv"):
        raise usage("applies only to a recording, a .csv file", f"--{next(iter(given)).removesuffix('_K')}")
    if tolerance is not None and not (math.isfinite(tolerance) and tolerance > 0):
        raise usage(f"{tolerance:g} is not a difference in K above 0", "--tolerance")
    if output == STDOUT:
        raise OutputError("the output format follows from the file ending: give a name such as icons.json")
    check_output(output, SUFFIXES, "a set of icons")
    if output.exists() and Path(file).exists() and output.samefile(file):
        raise OutputError(f"cannot write {output}: it is the input file; give another name")
    from thermicon.icons import to_json

    icons = read(file, given)
    text = to_json(icons) if output.suffix.lower() == ".json" else str(icons)
    write_text(text, output, f": {len(icons):,} icon{'' if len(icons) == 1 else 's'}")


def read(file: str, given: dict[str, Any]) -> IconSet:
    """Return the icons of a file, or of a recording in CSV."""
    if not file.lower().endswith(".csv"):
        return read_set([file])
    from thermicon.icons import IconSet
    from thermicon.icons.model.context import Metadata
    from thermicon.icons.recordings.recorded import from_csv

    try:
        icon = from_csv(file, **given)
    except ValueError as problem:
        fail(str(problem))
    corners = icon.corners()
    note(f"{icon.name}: {len(corners)} corners, {number(corners.duration_s, 2)} s")
    return IconSet("", "", icon.context, Metadata(), (icon,))
