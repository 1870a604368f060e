"""``thermicon convert``: icons as cue text or JSON, and recordings as icons."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.number_text import number

from ..files.outputs import STDOUT, OutputError, check_output, complete_or_absent
from ..messages import fail, note
from .cues import pick, read_set

if TYPE_CHECKING:
    from thermicon.icons import IconSet

SUFFIXES = (".cue", ".json")
_GIVEN = ("tolerance_K", "name", "column", "control")
_TEXT_OR_COMMENT = re.compile(r'"(?:[^"\\\n]|\\.)*"|#')


@dataclass(frozen=True, slots=True)
class Recording:
    """How a recording becomes an icon: tolerance in K, name, column and control; None means the default."""

    tolerance_K: float | None = None
    name: str | None = None
    column: str | None = None
    control: str | None = None


def convert_file(file: str, output: Path, icon: str | None, recording: Recording) -> None:
    """Read icons from a file of one kind and write them, complete or not at all, as the kind that the ending names."""
    if output == STDOUT:
        raise OutputError("the output format follows from the file ending: give a name such as icons.json")
    check_output(output, SUFFIXES, "a set of icons")
    if output.exists() and Path(file).exists() and output.samefile(file):
        raise OutputError(f"cannot write {output}: it is the input file; give another name")
    from thermicon.icons import to_json

    icons = read(file, recording)
    if icon is not None:
        icons = only_icon(icons, icon)
    text = to_json(icons) if output.suffix.lower() == ".json" else str(icons)
    with complete_or_absent(output) as draft:
        draft.write_text(text, encoding="utf-8", newline="\n")
    note(f"wrote {output}: {len(icons):,} icon{'' if len(icons) == 1 else 's'}")
    if has_comments(file):
        note(f"comments in {Path(file).name} were dropped")


def read(file: str, recording: Recording) -> IconSet:
    """Return the icons of a file, or of a recording in CSV."""
    if not file.lower().endswith(".csv"):
        return read_set([file])
    from thermicon.icons import IconSet
    from thermicon.icons.model.context import Metadata
    from thermicon.icons.recordings.recorded import from_csv

    given = {name: value for name in _GIVEN if (value := getattr(recording, name)) is not None}
    try:
        icon = from_csv(file, **given)
    except ValueError as problem:
        fail(str(problem))
    corners = icon.corners()
    note(f"{icon.name}: {len(corners)} corners, {number(corners.duration_s, 2)} s")
    return IconSet("", "", icon.context, Metadata(), (icon,))


def only_icon(icons: IconSet, name: str) -> IconSet:
    """Return the set with one of its icons, or of the members of its families, and with what this one plays."""
    from thermicon.icons import parse

    (found,) = pick(icons, name)
    return replace(icons, entries=parse(str(found)).entries)


def has_comments(file: str) -> bool:
    """Whether a cue file has comments, which no set keeps."""
    from thermicon.icons.files.shipped import file_bytes

    if file.lower().endswith(".csv") or (data := file_bytes(file)) is None:
        return False
    text = data.decode("utf-8", errors="replace")
    return any(match.group() == "#" for match in _TEXT_OR_COMMENT.finditer(text))
