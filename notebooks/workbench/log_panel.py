"""The panel behind the button *Log*: a measured log to lay over the curves, its shift, and its removal."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import ipywidgets as widgets

from ..report.blocks import fragment
from ..timeline.measured import read_measured, read_uploaded

if TYPE_CHECKING:
    from thermicon.circuit.fitting.log import Log

    from .design_view import DesignView

FORMATS = ".csv,.tsv,.tdms,.json"
ABOUT = (
    "A log with time_s and display_C, skin_C, voltage_V or current_A, as thermicon fit reads it: CSV, the TSV of a "
    "session (with its .json), or TDMS. It is aligned with the icon that is shown."
)


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
        self.load = self._button("Show it", "lay the log over the curves", self._load)
        self.shift = widgets.FloatText(description="shift (s)", step=0.05, layout={"width": "150px"})
        self.shift.style.description_width = "auto"
        self.shift.observe(lambda change: self._shifted(change["new"]), "value")
        self.align = self._button("Align", "find the shift by correlation", lambda: self._shift(None))
        self.remove = self._button("Remove", "take the log away", lambda: self._take(None))
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
        self.view.take_log(log)
        self.renew()
        self._done("" if log is None else " · ".join(log.notes))

    def _shifted(self, shift_s: float) -> None:
        if not self._quiet:
            self._safely(lambda: self._shift(shift_s))

    def _shift(self, shift_s: float | None) -> None:
        self.view.shift_log(shift_s)
        self.renew()

    def _button(self, name: str, hint: str, act: Callable[[], None]) -> widgets.Button:
        made = widgets.Button(description=name, tooltip=hint, layout={"width": "auto"})
        made.on_click(lambda _: self._safely(act))
        return made
