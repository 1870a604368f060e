"""The design view as widgets: canvas with text and time line below the knobs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from typing import Any

import ipywidgets as widgets

from thermicon.circuit import Rig

from ..timeline.frames import CanvasFrame
from .canvas import Canvas
from .design_model import ONE_AT_A_TIME, DesignModel
from .knobs import Knob, knobs_of
from .reel import reel_of, shipped_texts

SHARED = "globalThis.thermiconCanvas"


class MainCanvas(Canvas):
    """The canvas of the design view, which lends its module to the other canvases of the page."""

    _esm = f"{Canvas._esm}\n{SHARED} = {{ render }};"


class SideCanvas(Canvas):
    """A canvas that borrows the module of the page's main canvas, so that a notebook stores the module once."""

    _esm = (
        "async function render(given) {\n"
        f"while (!{SHARED}) await new Promise((go) => setTimeout(go, 30));\n"
        f"return {SHARED}.render(given);\n"
        "}\nexport default { render };"
    )
    _css = ""


class DesignView:
    """Canvas and knobs of one ``DesignModel``; ``box`` is what is shown."""

    def __init__(self, design: DesignModel) -> None:
        self.design = design
        self.canvas = MainCanvas("design")
        self.canvas.on_message(self._receive)
        self.sliders: dict[str, Any] = {}
        self._labels: dict[str, widgets.HTML] = {}
        self.on_page: dict[str, Callable[[Mapping[str, Any]], None]] = {
            "reel": lambda _: self._send_reel(),
            "palette": lambda _: self.canvas.send({"type": "palette", "sets": shipped_texts()}),
        }
        self.stop_device: Callable[[], None] = lambda: None  # waits for no other action of the page
        self.reset = widgets.Button(description="Reset", tooltip="all sliders back to the rig's values")
        self.reset.layout = widgets.Layout(width="68px", height="26px", margin="0")
        self.reset.on_click(self._reset)
        self.reset.add_class("thermicon-reset")
        self.knobs = widgets.Box([]).add_class("thermicon-knobs")
        self._make_knobs()
        self.box = widgets.VBox([self.knobs, self.canvas]).add_class("thermicon-design")
        self.folded = False
        self.fold()
        self.send(design.frame())

    def send(self, frame: CanvasFrame) -> None:
        """Show a frame that ``design`` returned."""
        self.canvas.frame(frame.meta, frame.buffers)

    def take_rig(self, rig: Rig) -> None:
        """Show the icons on another rig, with knobs of its own."""
        self.send(self.design.take_rig(rig))
        self._make_knobs()

    def fold(self) -> None:
        """Hide the knobs, or show them again."""
        self.folded = not self.folded
        (self.box.add_class if self.folded else self.box.remove_class)("thermicon-folded")

    def _make_knobs(self) -> None:
        self.sliders, self._labels = {}, {}
        self.knobs.children = (*(self._knob(knob) for knob in knobs_of(self.design.nominal)), self.reset)

    def _receive(self, message: Mapping[str, Any]) -> None:
        if message.get("type") == "stop device":
            self.stop_device()
            return
        with ONE_AT_A_TIME:
            if (act := self.on_page.get(str(message.get("type")))) is not None:
                act(message)
                message = {"type": "hello", "seq": message.get("seq", 0)}
            self.send(self.design.receive(message))
            if message.get("type") == "swap":
                self._make_knobs()

    def _send_reel(self) -> None:
        """Send the curves of all icons, which the page plays one after another."""
        frames, why = reel_of(self.design)
        buffers = [array.tobytes() for frame in frames for array in frame.buffers]
        metas = [{**frame.meta, "buffers": len(frame.buffers)} for frame in frames]
        self.canvas.send({"type": "reel", "frames": metas, "why": why}, buffers=buffers)

    def _knob(self, knob: Knob) -> widgets.VBox:
        label = widgets.HTML()
        self._labels[knob.key] = label
        digits = len(f"{knob.step:g}".partition(".")[2])
        self.sliders[knob.key] = made = widgets.FloatSlider(
            value=self.design.values.get(knob.key, knob.value),
            min=knob.low,
            max=knob.high,
            step=knob.step,
            readout_format=f".{digits}f",
            layout=widgets.Layout(width="auto"),
        )
        made.tooltip = f"{knob.what} ({knob.source})"
        made.observe(lambda change: self._turned(knob.key, change["new"]), "value")
        self._tell(knob)
        return widgets.VBox([label, made]).add_class("thermicon-knob")

    def _turned(self, key: str, value: float) -> None:
        with ONE_AT_A_TIME:
            self.send(self.design.turn({key: value}))
            self._tell(next(knob for knob in knobs_of(self.design.nominal) if knob.key == key))

    def _reset(self, _: widgets.Button) -> None:
        with ONE_AT_A_TIME:
            self.send(self.design.reset())
            self._make_knobs()

    def _tell(self, knob: Knob) -> None:
        """The knob's name, and what the rig has where that is another value."""
        changed = knob.key in self.design.values
        said = f"{knob.label} ({knob.unit})" + (f" · rig {knob.shown(knob.value)}" if changed else "")
        text = f'<span class="{"changed" if changed else ""}" title="{escape(knob.what)}">{escape(said)}</span>'
        self._labels[knob.key].value = text
