"""What the bar opens: the documents there are to open, and the sheet behind "?"."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from thermicon.icons import Icon, IconSet, load_library, read_cue
from thermicon.icons.files.shipped import library_names

from ..files.document import Document
from ..report.blocks import fragment
from ..timeline.frames import WORDS, terms_of

FIRST = "six-icons"


def document_of(source: str | Path | Icon | IconSet | None, keeps: bool = False) -> Document:
    """Return the document of a source, None for six-icons; raises CueErrors for a file or name that does not exist,
    OutputError for a file that cannot be edited.
    """
    if isinstance(source, Icon | IconSet):
        return Document(str(source), source.name or "icons", keeps)
    if isinstance(source, str) and ("{" in source or "\n" in source or not source.strip()):
        return Document(source, keeps=keeps)
    if source is not None and Path(source).is_file():
        return Document.open(Path(source), keeps)
    if source is None or source in library_names():
        name = str(source or FIRST)
        return Document(_shipped(name), name, keeps)
    return Document(str(read_cue(source)), keeps=keeps)  # or the reason why there is no such file


def _shipped(name: str) -> str:
    """A shipped set as it is written, with its comments."""
    place = files("thermicon.icons") / "library" / f"{name}.cue"
    return place.read_text(encoding="utf-8") if place.is_file() else str(load_library(name))


def help_html() -> str:
    """Return the sheet as HTML."""
    meanings = terms_of(*WORDS["terms"], *WORDS["simulated"])
    sheet = {**WORDS["sheet"], "Words": [f"{name}: {meaning}" for name, meaning in meanings]}
    return "".join(f"{fragment('block', head, 'th-head')}{fragment('points', lines)}" for head, lines in sheet.items())
