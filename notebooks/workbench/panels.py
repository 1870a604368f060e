"""What the bar opens: the documents there are to open, the measured log, and the sheet behind "?"."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import ipywidgets as widgets

from thermicon.icons import Icon, IconSet, load_library, read_cue
from thermicon.icons.files.shipped import library_names

from ..files.document import Document
from ..report.blocks import fragment
from ..timeline.frames import SIMULATED, TERMS, terms_of
from ..timeline.measured import read_measured, read_uploaded
from .live_view import button

if TYPE_CHECKING:
    from thermicon.circuit.fitting.log import Log

    from .design_view import DesignView

FIRST = "six-icons"
FORMATS = ".csv,.tsv"
ABOUT = (
    "A log with time_s and display_C, skin_C, voltage_V or current_A, as thermicon fit reads it: CSV or TSV. It is "
    "aligned with the icon that is shown."
)
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
        (
            "click a cell, or choose it with arrows and Enter: both icons, why they are confused, the cheapest edit",
            "choose: the best few icons; Keep these takes the others out of the text (Undo brings them back)",
            "goal: what is wanted of the set, in words; which parts are met, by how much, and what binds",
        ),
    ),
    (
        "Versions",
        (
            "Keep this version, go on editing: the list shows each version with the lines that were changed since",
            "Restore brings a version back into the text; Undo takes it out again",
        ),
    ),
    ("Log", ("lay a measured log over the curves; shift moves it in time, Align finds the shift",)),
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


class LogPanel:
    """Widgets of the measured log of one design view; ``box`` holds them.

    ``place`` turns what is typed into a path; ``safely`` runs a step and says what went wrong; ``done`` is called
    with a sentence after a step.
    """

    def __init__(
        self,
        view: DesignView,
        place: Callable[[str], Path],
        safely: Callable[[Callable[[], None]], None],
        done: Callable[[str], None],
    ) -> None:
        self.view, self._place, self._safely, self._done = view, place, safely, done
        self._quiet = False
        self.upload = widgets.FileUpload(accept=FORMATS, multiple=True, description="Upload", layout={"width": "auto"})
        self.upload.tooltip = "a log from your computer"
        self.upload.observe(lambda change: self._uploaded(change["new"]), "value")
        self.path = widgets.Text(placeholder="or its path", description="file", layout={"width": "230px"})
        self.path.style.description_width = "auto"
        self.load = button("Show it", "lay the log over the curves", lambda: safely(self._load))
        self.shift = widgets.FloatText(description="shift (s)", step=0.05, layout={"width": "150px"})
        self.shift.style.description_width = "auto"
        self.shift.observe(lambda change: self._shifted(change["new"]), "value")
        self.align = button("Align", "find the shift by correlation", lambda: safely(lambda: self._shift(None)))
        self.remove = button("Remove", "take the log away", lambda: safely(lambda: self._take(None)))
        about = widgets.HTML(fragment("block", ABOUT, "th-soft"))
        row = widgets.Box([self.upload, self.path, self.load, self.shift, self.align, self.remove])
        self.box = widgets.VBox([row.add_class("thermicon-row"), about])
        self.renew()

    def renew(self) -> None:
        """Show the shift as it is, and only what can be done."""
        measured = self.view.design.measured
        for control in (self.shift, self.align, self.remove):
            control.disabled = measured is None
        self._quiet = True
        try:
            self.shift.value = 0.0 if measured is None else round(measured.shift_s, 2)
        finally:
            self._quiet = False

    def _uploaded(self, files: tuple[dict[str, object], ...]) -> None:
        if not files:
            return
        named = {str(each["name"]): bytes(each["content"]) for each in files}  # type: ignore[call-overload]
        self.upload.value = ()
        self._safely(lambda: self._take(read_uploaded(named)))

    def _load(self) -> None:
        if not self.path.value.strip():
            raise ValueError("give the path of a log, or upload one")
        self._take(read_measured(self._place(self.path.value.strip())))

    def _take(self, log: Log | None) -> None:
        self.view.send(self.view.design.take_log(log))
        self.renew()
        self._done("" if log is None else " · ".join(log.notes))

    def _shifted(self, shift_s: float) -> None:
        if not self._quiet:
            self._safely(lambda: self._shift(shift_s))

    def _shift(self, shift_s: float | None) -> None:
        self.view.send(self.view.design.shift_log(shift_s))
        self.renew()


def help_html() -> str:
    """Return the sheet as HTML."""
    return "".join(f"{fragment('block', head, 'th-head')}{fragment('points', lines)}" for head, lines in SHEET)
