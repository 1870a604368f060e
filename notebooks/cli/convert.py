"""``thermicon convert``: icons in another form of file."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from thermicon.base.files.atomic import OutputError
from thermicon.base.files.table_text import TABLES
from thermicon.base.words.number_text import number

from ..files.outputs import STDOUT, check_output
from ..messages import fail, note, noted, usage
from .options import opt, out, read_set, theirs_of, write_text

if TYPE_CHECKING:
    from thermicon.icons import IconSet

SUFFIXES = (".cue", ".json")


def convert_command(
    file: Annotated[str, typer.Argument(metavar="FILE", help="A cue file, a table or a shipped set.")],
    output: Annotated[Path, out("OUT", "The file to write: .cue or .json.", "-o", "--output")],
    tolerance: Annotated[
        float | None,
        opt("K", "For a table: largest deviation of the icon from the recording, in K.", name="--tolerance"),
    ] = None,
    name: Annotated[str | None, opt("NAME", "For a table: the name of the icon.", name="--name")] = None,
    column: Annotated[
        list[str] | None,
        opt("COLUMN", "For a table: the column of temperatures, or NAME=THEIRS for any column.", name="--column"),
    ] = None,
    control: Annotated[
        Literal["skin", "display"] | None,
        typer.Option(help="For a table: whether skin or display temperatures were recorded."),
    ] = None,
) -> None:
    """Convert icons to a cue file or to JSON; the file ending decides.

    JSON keeps everything except comments. A recording (a table) becomes an icon of a few straight pieces.
    """
    chosen = [None, *(each for each in column or [] if "=" not in each)][-1]
    theirs = theirs_of([each for each in column or [] if "=" in each]) or None
    recording = {"tolerance_K": tolerance, "name": name, "column": chosen, "columns": theirs, "control": control}
    given = {key: value for key, value in recording.items() if value is not None}
    if given and not is_table(file):
        option = next(iter(given)).removesuffix("_K").replace("columns", "column")
        raise usage("applies only to a recording, a .csv file or another table", f"--{option}")
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


def is_table(file: str) -> bool:
    """Whether a file is a recording, by its ending, and is not cue text."""
    path = Path(file)
    if path.suffix.lower() not in TABLES or not path.is_file():
        return path.suffix.lower() in TABLES
    with path.open("rb") as opened:
        return not re.search(rb"(?m)^\s*cue\s+\d", opened.read(4000))


def read(file: str, given: dict[str, Any]) -> IconSet:
    """Return the icons of a file, or of a recording in a table."""
    if not is_table(file):
        return read_set([file])
    from thermicon.icons import IconSet
    from thermicon.icons.recordings.recorded import from_csv

    try:
        with noted():
            icon = from_csv(file, **given)
    except ValueError as problem:
        fail(problem)
    corners = icon.corners()
    note(f"{icon.name}: {len(corners)} corners, {number(corners.duration_s, 2)} s")
    return IconSet.of(icon)
