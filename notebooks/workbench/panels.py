"""What the bar opens: the documents there are to open, and the sheet behind "?"."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from thermicon.icons import Icon, IconSet, load_library, read_cue
from thermicon.icons.files.shipped import library_names

from ..files.document import Document
from ..report.blocks import fragment
from ..timeline.frames import SIMULATED, TERMS, terms_of

FIRST = "six-icons"
SHEET: tuple[tuple[str, tuple[str, ...]], ...] = (
    (
        "Time line",
        (
            "drag a filled dot: the corner moves, and the number in the text with it",
            "move the pointer: the cursor reads all curves, and stays where the pointer leaves the curves",
            "[ and ] choose a corner, arrows move it, with Shift ten times as far, Escape goes back to the cursor",
            "Left, Right, Home, End move the cursor; Ctrl+Z, Ctrl+Shift+Z and Ctrl+S as in the text",
        ),
    ),
    (
        "Text",
        (
            "Ctrl+Space offers what may follow; Enter or Tab takes it",
            "F8 goes to the next error, Ctrl+. takes its correction",
            "Ctrl+F searches, Ctrl+/ makes a line a comment, Ctrl+D selects the next occurrence",
            "Ctrl+Z and Ctrl+Shift+Z undo and redo text, drags and applied edits; Ctrl+S saves the file",
            "Tab, with no offer open, leaves the text",
        ),
    ),
    (
        "Set",
        ("click a cell, or choose it with arrows and Enter: both icons, why they are confused, the cheapest edit",),
    ),
    (
        "Versions",
        (
            "Keep this version, go on editing: the list shows each version with the lines that were changed since",
            "Restore brings a version back into the text; Undo takes it out again",
        ),
    ),
    ("Safety", ("click the badge: every limit that was judged on this run; export judges worst cases",)),
    ("Words", tuple(f"{name}: {meaning}" for name, meaning in terms_of(*TERMS, SIMULATED))),
)


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
    return "".join(f"{fragment('block', head, 'th-head')}{fragment('points', lines)}" for head, lines in SHEET)
