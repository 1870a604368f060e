"""The bar above the tabs: actions on the document."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import ipywidgets as widgets

from thermicon.base.files.atomic import OutputError
from thermicon.circuit import Rig
from thermicon.circuit.rig.rig import rig_names
from thermicon.icons import Icon, IconSet, load_library, read_cue
from thermicon.icons.files.shipped import library_names, names_on_one_element

from ..files.document import Document
from ..files.recovery import UnsavedText
from ..report.blocks import fragment
from ..timeline.frames import WORDS
from .live_view import button, safely

if TYPE_CHECKING:
    from .design_view import DesignView

MOST_FILES, MOST_RIGS = 200, 50
FIRST = "six-icons"
LONGEST_NAME = 24
NEW = """cue 1

set untitled {{
  site {site}
  control display
  baseline 32 °C
}}

icon first {{
  cool by 3 °C at 1.5 °C/s
  hold for 1 s
  return at 1.5 °C/s
}}
"""
SHIPPED = "shipped: "
"""What stands before the name of a shipped set in the list of what can be opened."""


class DocumentBar:
    """Actions on the document of a design view; ``box`` is the bar with the panel that its buttons open."""

    def __init__(self, view: DesignView) -> None:
        self.view, self.design = view, view.design
        self._taken = self.design.nominal.name  # what is selected of the list of rigs
        self._rigs: dict[str, Rig] = {}
        self._names = {self.design.nominal: self._taken}  # of rigs that were taken, as the list has them
        self.title, self.said = widgets.HTML(), widgets.HTML().add_class("thermicon-said")
        self.buttons = {
            name: self._button(name, hint, act)
            for name, hint, act in (
                ("New", "begin a set with one icon", self._new),
                ("Open", "a cue file or a shipped set", lambda: self._toggle("open")),
                ("Save", "to the file it came from (Ctrl+S)", self.save),
                ("Save as", "under another name", lambda: self._toggle("save")),
                ("Sliders", "contact, area, rest temperature and current limit of the rig", self.view.fold),
                ("Undo", "Ctrl+Z in text or time line", lambda: self._step("undo")),
                ("Redo", "Ctrl+Shift+Z in text or time line", lambda: self._step("redo")),
                ("?", "what can be dragged, clicked and pressed", lambda: self._toggle("help")),
            )
        }
        self.rig = widgets.Dropdown(description="rig", layout={"width": "170px"})
        self.rig.style.description_width = "auto"
        self._offer_rigs()
        self.rig.observe(lambda change: self._safely(lambda: self._take_rig(change["new"])), "value")
        self.files = widgets.Select(options=[], rows=9, description="open", layout={"width": "330px"})
        self.path = widgets.Text(placeholder="or its path", description="file", layout={"width": "250px"})
        for control in (self.files, self.path):
            control.style.description_width = "36px"
        self.files.observe(lambda _: setattr(self.path, "value", ""), "value")  # what was chosen last is opened
        go = self._button("Open it", "open what is selected or typed", self._open_selected)
        self._panels = {"open": widgets.VBox([self.files, widgets.Box([self.path, go])])}
        self.name = widgets.Text(placeholder="alerts.cue", description="file", layout={"width": "320px"})
        self.overwrite = widgets.Checkbox(value=False, description="overwrite", indent=False, layout={"width": "110px"})
        go = self._button("Save it", "write the file", self._save_as)
        self._panels["save"] = widgets.Box([self.name, self.overwrite, go]).add_class("thermicon-row")
        self._panels["help"] = widgets.VBox([widgets.HTML(fragment("points", WORDS["sheet"]))])
        self.panel = widgets.VBox([]).add_class("thermicon-panel")
        self.shown: str | None = None
        self.offered_text: UnsavedText | None = None
        self.offered = widgets.HTML()
        yes = self._button("Restore it", "as a step that can be undone", self._restore)
        no = self._button("Discard", "drop what was not saved", self.discard)
        self.offer = widgets.Box([self.offered, yes, no]).add_class("thermicon-offer")
        buttons = list(self.buttons.values())
        self.bar = widgets.Box([self.title, *buttons[:4], self.rig, *buttons[4:]]).add_class("thermicon-bar")
        self.box = widgets.VBox([self.offer, self.said, self.bar, self.panel]).add_class("thermicon-project")
        self.design.on_change(self.renew)
        self.renew()
        self.beside(design=True)
        self._show_offer()

    @property
    def document(self) -> Document:
        """The text in the editor."""
        return self.design.document

    def renew(self) -> None:
        """Say anew what the document is, and what may cost somebody their text."""
        document, history = self.document, self.document.history
        kind = "th-caution" if document.dirty else ""
        name, said = document.name, document.title.removeprefix(document.name)
        short = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME // 2]}…{name[-LONGEST_NAME // 2 :]}"
        self.title.value = fragment("marked", short + said, f"thermicon-file {kind}".strip())
        self.title.tooltip = document.title
        self.buttons["Undo"].disabled, self.buttons["Redo"].disabled = not history.past, not history.future
        self.buttons["Save"].disabled = not document.dirty and document.path is not None
        count = len(self.design.values)
        self.buttons["Sliders"].description = f"Sliders ({count} set)" if count else "Sliders"
        if (name := self._names.get(self.design.nominal, self._taken)) != self._taken:
            self._taken = name  # a version on another rig took the place of this one
            self._offer_rigs()
        self.say(document.warning(), "th-caution")

    def say(self, text: str, kind: str = "th-good") -> None:
        """Show a sentence below the bar; none hides the line."""
        self.said.value = fragment("block", text, f"th-note {kind}") if text else ""
        self.said.layout.display = "" if text else "none"

    def save(self) -> None:
        """Save to the file, or ask for a name where there is none."""
        if self.document.path is None:
            self._open("save")
            return
        self._after(f"saved {self.document.save().name}")

    def beside(self, design: bool) -> None:
        """Show undo and redo here where the design view, which has its own, is not shown, and sliders where it is."""
        for name in ("Undo", "Redo", "Sliders"):
            self.buttons[name].layout.display = "none" if design == (name != "Sliders") else ""

    def saved_by_key(self, message: Mapping[str, Any]) -> None:
        """Ctrl+S in text or time line: where there is no file, the notebook's own saving is enough."""
        if self.document.path is not None:
            self._safely(self.save)

    def take_left(self, message: Mapping[str, Any]) -> None:
        """Offer what the page kept of a kernel that is gone."""
        self.document.left(str(message["text"]))
        self._show_offer()

    def discard(self) -> None:
        """Drop the text that is offered; others are offered at the next start."""
        if self.offered_text is not None:
            self.document.recovery.drop(self.offered_text)
        self.offered_text = None
        self.offer.layout.display = "none"

    def _take_rig(self, name: str) -> None:
        """Show the icons on a rig that was shown before, or load it by name or path."""
        if name == self._taken:
            return
        try:
            path = str(self.document.folder / name) if name.endswith(".toml") else name
            self.view.take_rig(self._rigs.get(name) or Rig.load(path))
        except Exception:
            self._offer_rigs()  # the list goes back to the rig that is still used
            raise
        self._taken = name
        self._names[self.design.nominal] = name
        self.say("")

    def _offer_rigs(self) -> None:
        nominal = self.design.nominal
        if nominal.name not in rig_names():
            self._rigs[nominal.name] = nominal  # it may lie in another folder, so it is not loaded by its name
        files = self._files("*.toml")[:MOST_RIGS]
        self.rig.options = list(dict.fromkeys([self._taken, *self._rigs, *rig_names(), *files]))
        self.rig.value = self._taken

    def _show_offer(self) -> None:
        self.offered_text = found = self.document.offer
        self.offer.layout.display = "none" if found is None else ""
        if found is not None:
            words = f"Unsaved text of {self.document.name} was typed {found.age}:"
            self.offered.value = fragment("marked", words, "")
        self._safely(self._write_versions)

    def _write_versions(self) -> None:
        """Hand over the versions that an earlier release kept by hand."""
        if (folder := self.document.recovery.write_versions()) is not None:
            self.say(f"versions of {self.document.name} that were kept by hand are cue files now, in {folder}")

    def _restore(self) -> None:
        if (found := self.offered_text) is not None:
            self.design.show_text(found.text, found.icon)
            self.discard()
            self._after("the unsaved text is in the editor; Undo takes it back out")

    def _open_selected(self) -> None:
        source = self.path.value.strip() or self.files.value
        if not source:
            raise OutputError("select what is to be opened, or type its path")
        if source.startswith(SHIPPED):
            self._show(lambda: document_of(source.removeprefix(SHIPPED), self.document.keeps))
        else:
            self._show(lambda: Document.open(self.document.place(source), self.document.keeps))

    def _new(self) -> None:
        site = self.design.nominal.site
        self._show(lambda: Document(NEW.format(site=site), "untitled", self.document.keeps))

    def _show(self, document: Callable[[], Document]) -> None:
        """Take another document, once what is unsaved of this one is kept."""
        name, dirty = self.document.name, self.document.dirty
        left = f"unsaved text of {name} is kept: open it again to restore it" if dirty else ""
        self.document.leave()
        self.design.open(document())
        self.path.value = self.name.value = ""
        self._offer_rigs()
        self._after(left)
        self._show_offer()

    def _save_as(self) -> None:
        if not (wanted := self.name.value.strip()):
            raise OutputError("give the name of a file, such as alerts.cue")
        place = self.document.place(wanted if Path(wanted).suffix else f"{wanted}.cue")
        path = self.document.save_as(place, self.overwrite.value)
        self.overwrite.value = False
        self._after(f"saved {path}")

    def _step(self, kind: str) -> None:
        self.view.send(self.design.receive({"type": kind}))
        self.renew()

    def _after(self, said: str) -> None:
        """Close the panel, send the text to the page, and say what was done."""
        self._open(None)
        self.view.send(self.design.frame())
        self.renew()
        if said and not self.document.warning():
            self.say(said)

    def _toggle(self, name: str) -> None:
        self._open(None if self.shown == name else name)

    def _open(self, name: str | None) -> None:
        self.shown = name
        if name == "open":
            shipped = (f"{SHIPPED}{name}" for name in names_on_one_element())
            self.files.options = [*self._files("*.cue")[:MOST_FILES], *shipped]
        elif name == "save" and not self.name.value:
            self.name.value = f"{self.document.name.removesuffix('.cue')}.cue"
        self.panel.children = () if name is None else (self._panels[name],)

    def _files(self, pattern: str) -> list[str]:
        """Names of files of the folder, without hidden ones; none of a folder that cannot be read."""
        try:
            return sorted(path.name for path in self.document.folder.glob(pattern) if not path.name.startswith("."))
        except OSError:
            return []

    def _button(self, name: str, hint: str, act: Callable[[], None]) -> widgets.Button:
        return button(name, hint, lambda: self._safely(act))

    def _safely(self, act: Callable[[], None]) -> None:
        safely(act, lambda wrong: self.say(wrong, "th-bad"))


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
        place = files("thermicon.icons") / "library" / f"{name}.cue"
        text = place.read_text(encoding="utf-8") if place.is_file() else str(load_library(name))
        return Document(text, name, keeps)
    return Document(str(read_cue(source)), keeps=keeps)  # or the reason why there is no such file
