"""What a workbench can be made of: cue text, a cue file, a shipped set by name, an icon or a set."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from thermicon.icons import Icon, IconSet, load_library, read_cue
from thermicon.icons.files.shipped import library_names

from ..files.document import Document

FIRST = "six-icons"


def document_of(source: str | Path | Icon | IconSet | None, keeps: bool = False) -> Document:
    """Return the document of a source, None for six-icons; raises CueErrors for a file or name that does not exist,
    OutputError for a file that cannot be edited.

    >>> document_of("cue 1; icon dip { hold for 1 s }").text
    'cue 1; icon dip { hold for 1 s }'
    >>> document_of("wave-shapes").title, document_of("wave-shapes").text.splitlines()[0]
    ('wave-shapes', 'cue 1')
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
