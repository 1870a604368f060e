"""The design view without its widgets: one frame in answer to every message of the page."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from threading import RLock
from typing import Any

from thermicon.circuit import Rig
from thermicon.perception import Observer
from thermicon.perception.observer.observer_model import ObserverModel

from ..editing.cue_check import mended
from ..files.document import Document
from ..timeline.dragging import drag
from ..timeline.frames import DRAGGED_POINTS, MOST_POINTS, CanvasFrame, frame_of
from ..timeline.scene import Scene, scene, with_notes
from .knobs import knobs_of, turned
from .versions import Version

Message = Mapping[str, Any]
MOST_LETTERS = 1_000_000
ONE_AT_A_TIME = RLock()
"""Held by each action of a page: Jupyter calls handlers in two threads, that of the cells and one of the widgets."""


class DesignModel:
    """The document, icon and knobs of one workbench, and the scene that they make.

    ``receive`` takes a message of the page and ``turn`` a knob; both return the frame to draw and raise nothing.
    ``rig`` is that with the knobs set; ``model`` is the observer that predicts; None: the shipped one.
    """

    def __init__(
        self, text: str | Document, rig: Rig, icon: str | None = None, model: ObserverModel | None = None
    ) -> None:
        self.document = text if isinstance(text, Document) else Document(text)
        self.nominal = rig
        self.model = model
        self.rig, self._told = rig, tuple[str, ...]()
        self.values: dict[str, float] = {}
        self._drag: tuple[int, str] | None = None  # the corner, and the text before, from which every step starts
        self._moving = False
        self.scene: Scene = scene(self.text, rig, icon, self.observer)
        self.pinned: Version | None = None
        self._swapped: object = None
        self.document.history = self.document.history.chosen(self.scene.icon)
        self._tell: list[Callable[[], None]] = []

    @property
    def text(self) -> str:
        """The text as it stands in the editor."""
        return self.document.text

    @property
    def dragging(self) -> bool:
        """Whether a corner is being dragged."""
        return self._drag is not None

    @property
    def version(self) -> Version:
        """What is designed now, as it could be pinned."""
        return Version(self.scene, self.nominal, self.values, self.document)

    @property
    def observer(self) -> Observer:
        """The nominal person."""
        return Observer.load() if self.model is None else self.model.nominal

    def on_change(self, tell: Callable[[], None]) -> None:
        """Call a function after each message that changed the text, the rig, the icon shown or what is pinned."""
        self._tell.append(tell)

    def receive(self, message: Message) -> CanvasFrame:
        """Answer a message of the page with the newest frame."""
        seq = message.get("seq", 0)
        return self._answer(lambda: self._act(message), seq if isinstance(seq, int) else 0)

    def turn(self, values: Mapping[str, float]) -> CanvasFrame:
        """Set knobs, by key; the others stay where they are."""
        return self._answer(lambda: self._set({**self.values, **values}))

    def reset(self) -> CanvasFrame:
        """Bring all knobs back to the rig's own values."""
        return self._answer(lambda: self._set({}))

    def show_text(self, text: str, icon: str | None = None) -> CanvasFrame:
        """Put another text in the editor, as one step that can be undone, and show an icon of it."""

        def act() -> str:
            self._drag = None
            self.document.history = self.document.history.changed(text)
            self._draw(icon)
            return text

        return self._answer(act)

    def open(self, document: Document) -> CanvasFrame:
        """Put another document in the editor, with a history of its own."""

        def act() -> str:
            self._drag, self.document = None, document
            self.scene = scene(self.text, self.rig, None, self.observer, notes=self._told)
            self.document.history = self.document.history.chosen(self.scene.icon)
            return self.text

        return self._answer(act)

    def take_rig(self, rig: Rig) -> CanvasFrame:
        """Show the icons on another rig, with its own values."""
        self.nominal = rig
        return self.reset()

    def frame(self) -> CanvasFrame:
        """The frame as it is now, with the text."""
        return self._answer(lambda: self.text)

    def _answer(self, act: Callable[[], str | None], seq: int = 0) -> CanvasFrame:
        began, before = time.perf_counter(), (self.text, self.rig, self.scene.icon, self.pinned)
        self._moving = False
        shown: str | None = None
        try:
            shown = act()
        except Exception as wrong:  # a page that goes silent is worse than any sentence
            told = with_notes(self.scene, f"the action failed: {wrong or type(wrong).__name__}")
            left = (told.text, told.rig) != (self.text, self.rig)  # as they are now, nothing was drawn or judged
            self.scene = replace(told, stale=told.stale or left)
            shown = self.text
        try:
            made = frame_of(self.scene, DRAGGED_POINTS if self._moving else MOST_POINTS)
            if self.pinned is not None:
                made = self.pinned.behind(made)
        except Exception as wrong:
            self.scene = replace(with_notes(self.scene, f"drawing failed: {wrong}"), drawing=None, stale=True)
            made = frame_of(self.scene)
        if (self.text, self.rig, self.scene.icon, self.pinned) != before:
            self.document.changed()
            for tell in self._tell:
                tell()
        took_ms = 1e3 * (time.perf_counter() - began)
        return made.numbered(seq, took_ms, shown, bool(self.document.history.past), bool(self.document.history.future))

    def _act(self, message: Message) -> str | None:
        """Do what a message asks; returns the text where the editor is to take it."""
        kind = message.get("type")
        if kind != "drag":
            self._drag = None
        match kind:
            case "hello":
                return self.text
            case "text":
                self._typed(message.get("text"))
                return None
            case "icon":
                name = str(message.get("name"))
                self.document.history = self.document.history.chosen(name)
                self._draw(name)
                return None
            case "drag":
                return self._dragged(message)
            case "undo" | "redo":
                return self._step(kind)
            case "goal":
                self.document.aim(str(message.get("text")))
                self._draw()
                return self.text
            case "pin":
                if self.scene.stale:
                    raise ValueError("a text with errors has no curves to pin")
                self.pinned = self.version
                return None
            case "unpin":
                self.pinned = None
                return None
            case "swap":
                return self._swap(message.get("once"))
            case "apply":
                return self._mend(message.get("line"))
        raise ValueError(f"the page sent an unknown message: {kind}")

    def _typed(self, text: object) -> None:
        if not isinstance(text, str) or len(text) > MOST_LETTERS:
            raise ValueError(f"the text is longer than {MOST_LETTERS:,} letters, so it was not changed")
        self.document.history = self.document.history.typed(text, time.monotonic())
        self._draw()

    def _dragged(self, message: Message) -> str:
        handle, end = int(message["handle"]), bool(message.get("end"))
        if self._drag is None or self._drag[0] != handle:
            self._drag = handle, self.text
        # Every step starts from the text before the drag, so that rounding does not add up on the way.
        drawing, base = self.scene.drawing, self._drag[1]
        start = None if drawing is None else drawing.start
        time_s, level = _float(message.get("t")), _float(message.get("y"))
        self._moving = not end
        moved = drag(base, self.scene.icon or "", handle, time_s, level, start)
        if moved.refused is None:
            self.document.history = self.document.history.dragged(moved.text, end)
        elif end:
            self.document.history = self.document.history.dragged(self.text, True)
        if end:
            self._drag = None
        self._draw(notes=() if moved.refused is None else (f"not moved: {moved.refused}",))
        return self.text

    def _step(self, kind: str) -> str:
        before = self.document.history
        history = before.undo() if kind == "undo" else before.redo()
        if history is before:
            self.scene = with_notes(self.scene, f"there is nothing to {kind}")
            return self.text
        self.document.history = history
        self._draw(history.now.icon)
        return self.text

    def _swap(self, once: object) -> str:
        """Change sides: what is pinned becomes the design, in its own document, and the design what is pinned.

        A page that got no answer asks again with the number ``once`` that it gave before.
        """
        if once is not None and once == self._swapped:
            return self.text
        if (other := self.pinned) is None or self.scene.stale:
            raise ValueError("nothing is pinned" if other is None else "a text with errors cannot be pinned")
        self.pinned, self.document = self.version, other.document
        self.nominal, self.values = other.nominal, dict(other.values)
        self.rig, self._told = turned(self.nominal, self.values)
        self.document.history = self.document.history.changed(other.scene.text)
        self._draw(other.scene.icon)
        self._swapped = once
        return self.text

    def _mend(self, line: object) -> str:
        new = mended(self.text, line) if isinstance(line, int) else None
        if new is None:
            self.scene = with_notes(self.scene, f"line {line} has no suggestion to apply")
            return self.text
        self.document.history = self.document.history.changed(new)
        self._draw()
        return new

    def _set(self, values: Mapping[str, float]) -> None:
        own = {knob.key: knob.value for knob in knobs_of(self.nominal)}
        self.values = {key: value for key, value in values.items() if own.get(key) != value}
        self.rig, self._told = turned(self.nominal, self.values)
        self._draw()

    def _draw(self, icon: str | None = None, notes: tuple[str, ...] = ()) -> None:
        self.scene = scene(self.text, self.rig, icon, self.observer, self.scene, (*notes, *self._told))
        if self.scene.icon != (history := self.document.history).now.icon:
            # The icon that is shown is not a step of its own; typing over its name goes on as one step.
            self.document.history = replace(history, now=replace(history.now, icon=self.scene.icon))


def _float(value: object) -> float:
    return float(value) if isinstance(value, int | float) else math.nan
