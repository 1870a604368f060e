"""The canvas of the workbench: one anywidget that draws frames in the browser.

The module in ``canvas_parts/`` is plain JavaScript without a build step: its parts are joined here in order, so they
import nothing; CodeMirror, bundled in ``codemirror/``, is carried in packed form. A frame goes out as one message with
float32 buffers, never as a trait, so a saved notebook holds the module and no data.
"""

from __future__ import annotations

import gzip
import json
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from typing import Any
from uuid import uuid4

import anywidget
import numpy
import traitlets

from thermicon.icons.model.units import UNITS
from thermicon.icons.model.words import CLAUSES, CONTROLS, EXAMPLES, STARTS, VOCABULARY

from ..timeline.frames import WORDS

Message = dict[str, Any]

PARTS = (
    "base",
    "theme",
    "flow",
    "frame",
    "scale",
    "curve",
    "panel",
    "handles",
    "timeline",
    "play",
    "reel",
    "player",
    "sides",
    "codemirror",
    "highlight",
    "complete",
    "troubles",
    "editor",
    "palette",
    "unsaved",
    "strip",
    "design",
    "heat",
    "main",
)
STYLES = ("theme", "layout", "editor", "timeline", "play", "heat")


def module_text() -> str:
    """Return the ES module: the words of the cue language, then all parts."""
    folder = files("thermicon.notebooks") / "canvas_parts"
    scripts = ((folder / f"{part}.js").read_text(encoding="utf-8") for part in PARTS)
    # A notebook that stores its widgets stores the module: comments and indentation go, and CodeMirror is a third.
    lines = (line.strip() for script in scripts for line in script.splitlines())
    parts = (line for line in lines if line and not line.startswith(("//", "/** ", "* ", "*/")))
    packed = b64encode(gzip.compress(codemirror_text().encode(), mtime=0)).decode()
    constants = {"CUE_WORDS": cue_words(), "PACKED_CODEMIRROR": packed}
    first = (f"const {name} = {json.dumps(value, ensure_ascii=False)};" for name, value in constants.items())
    return "\n".join((*first, *parts))


def codemirror_text() -> str:
    """Return the ES module that ``notebooks/codemirror/build.sh`` bundles CodeMirror into."""
    return (files("thermicon.notebooks") / "codemirror" / "codemirror.js").read_text(encoding="utf-8")


def style_text() -> str:
    """Return the style sheet."""
    folder = files("thermicon.notebooks") / "canvas_parts"
    return "\n".join((folder / f"{style}.css").read_text(encoding="utf-8") for style in STYLES)


def cue_words() -> dict[str, Any]:
    """Words to colour and to offer, so that the page never knows another language than the parser."""
    units = {unit for kind in UNITS.values() for unit in kind if unit}
    return {
        "keywords": sorted({*CLAUSES, *CONTROLS, *STARTS.values()}.union(*VOCABULARY.values())),
        "units": sorted(units, key=lambda unit: (-len(unit), unit)),
        "shapes": WORDS["shapes"],
        "examples": {word: text.split('"')[1] for word, text in EXAMPLES.items() if '"' in text},
    }


class Canvas(anywidget.AnyWidget):
    """Draws frames of one view: ``design`` (text and time line), ``traces`` (time line) or ``heat`` (two matrices).

    What a frame consists of is said in ``frames``. Nothing is drawn before the first one.
    """

    _esm = module_text()
    _css = style_text()
    view = traitlets.Enum(("design", "traces", "heat"), default_value="design").tag(sync=True)
    key = traitlets.Unicode(help="tells the views of this widget from those of another").tag(sync=True)

    def __init__(self, view: str = "design") -> None:
        super().__init__(view=view, key=uuid4().hex)
        self._newest: tuple[Message, list[bytes]] | None = None
        self._handlers: list[Callable[[Message], None]] = []
        self.on_msg(self._receive)

    def frame(self, meta: Mapping[str, Any], arrays: Sequence[Any] = ()) -> None:
        """Show a frame: its description, and numbers as sequences that become float32 buffers, in order.

        The newest is kept for pages that are opened or reloaded later.
        """
        whole = {"type": "frame", "view": self.view, **meta}
        buffers = [numpy.ascontiguousarray(array, dtype="<f4").tobytes() for array in arrays]
        self._newest = (whole, buffers)
        self.send(whole, buffers=buffers)

    def on_message(self, handler: Callable[[Message], None]) -> None:
        """Call `handler` with each message from the page.

        The newest frame answers a greeting too, except to a design view, whose text may be newer.
        """
        self._handlers.append(handler)

    def _receive(self, widget: Canvas, content: Message, buffers: Sequence[Any]) -> None:
        if content.get("type") == "hello" and (self._newest is None or self.view != "design"):
            # A page that waits for the first frame hears at least that the kernel is there.
            meta, arrays = self._newest or ({"type": "alive"}, None)
            self.send(meta, buffers=arrays)
            return
        for handler in tuple(self._handlers):
            handler(content)
