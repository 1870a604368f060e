"""The versions view: kept texts with their differences from the editor's."""

from __future__ import annotations

import difflib
import time
from collections.abc import Callable

import ipywidgets as widgets

from ..files.versions import Version
from ..report.blocks import fragment
from .design_model import DesignModel
from .live_view import button

NOTHING = "Keep the set as it is now as a version, and go on editing: here it can be compared with, and brought back."
ABOUT = "− only in the version, + only in the editor"
MOST_LINES = 200


class VersionsView:
    """Versions of the document of one ``DesignModel``, read while the tab is ``shown``; ``box`` holds the widgets.

    ``show_text`` puts a text into the editor, as a step that can be undone, and shows an icon.
    """

    def __init__(self, design: DesignModel, show_text: Callable[[str, str | None], None]) -> None:
        self.design, self._show_text = design, show_text
        self.shown = False
        self.said = {name: widgets.HTML() for name in ("status", "about", "changes")}
        self.keep = button("Keep this version", "what is in the editor", self.keep_now)
        self.back = button("Restore", "into the editor, as a step that can be undone", self.restore)
        self.discard = button("Discard", "drop the version that is selected", self.drop)
        self.list = widgets.Select(options=[], rows=12, description="kept", layout={"width": "330px"})
        self.list.style.description_width = "36px"
        self.list.observe(lambda _: self._show(), "value")
        said = self.said
        top = widgets.Box([self.keep, self.back, self.discard, said["status"]])
        right = widgets.VBox([said["about"], said["changes"]], layout={"flex": "1 1 430px", "min_width": "0"})
        body = widgets.Box([self.list, right]).add_class("thermicon-row")
        self.box = widgets.VBox([top.add_class("thermicon-row"), body]).add_class("thermicon-versions")
        self._show()

    @property
    def picked(self) -> Version | None:
        """The version that is selected; None where there is none."""
        picked: Version | None = self.list.value
        return picked

    def renew(self, after_s: float | None = None) -> None:
        """Show the versions as they are, if the tab is shown; ``after_s`` is that of other views."""
        if not self.shown:
            return
        held, picked = self.design.document.versions.others[::-1], self.picked
        self.list.options = [(_title(each), each) for each in held]
        self.list.value = picked if picked in held else next(iter(held), None)
        self._show()

    def keep_now(self) -> None:
        """Keep what is in the editor."""
        made = self.design.document.keep()
        self.renew()
        self.list.value = made
        self._say(self.design.document.warning() or "kept")

    def restore(self) -> None:
        """Put the version that is selected into the editor, as a step that can be undone."""
        if (picked := self.picked) is not None:
            self._show_text(picked.text, picked.icon)
            self._say("the version is in the editor; Undo takes it back out")

    def drop(self) -> None:
        """Drop the version that is selected."""
        if (picked := self.picked) is not None:
            self.design.document.versions.drop(picked)
            self.renew()
            self._say("dropped")

    def _show(self) -> None:
        """How the version that is selected differs from what is in the editor."""
        picked = self.picked
        self.back.disabled = self.discard.disabled = picked is None
        self._say("")
        if picked is None:
            self.said["about"].value = fragment("block", NOTHING, "th-soft")
            self.said["changes"].value = ""
            return
        rows = changed_lines(picked.text, self.design.text)
        self.said["about"].value = fragment("block", ABOUT if rows else "as in the editor", "th-soft")
        self.said["changes"].value = fragment("changes", rows) if rows else ""

    def _say(self, text: str) -> None:
        self.said["status"].value = fragment("marked", text, "th-status")


def changed_lines(before: str, now: str) -> list[tuple[str, str]]:
    """Lines that only one of two texts has, each with ``−`` or ``+``, and the lines around them, with a blank."""
    found = list(difflib.unified_diff(before.splitlines(), now.splitlines(), lineterm="", n=1))[2:]
    signs = {"-": "−", "+": "+"}
    rows = [("…", "") if line.startswith("@@") else (signs.get(line[0], ""), line[1:]) for line in found][1:]
    more = len(rows) - MOST_LINES
    return rows if more <= 1 else [*rows[:MOST_LINES], ("…", f"and {more} more lines")]


def _title(version: Version) -> str:
    """When a version was written, and whether by hand."""
    when = time.strftime("%d %b %H:%M:%S", time.localtime(version.at_s))
    return f"{when}{', unsaved text' if version.editor else ''}{f', {version.icon}' if version.icon else ''}"
