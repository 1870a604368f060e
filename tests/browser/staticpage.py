"""The canvas module in a static page without Jupyter."""

import base64
from typing import Any

import numpy

from thermicon.notebooks.workbench.canvas import module_text, style_text

URL = "http://thermicon.test/"
PAGE = """<!doctype html><html><head><meta charset="utf-8"><style>%s</style></head><body><div id="app"></div>
<script type="module">
import widget from "./module.mjs";
function unpacked(buffer) { // at an odd place, as buffers come out of a message
  const text = atob(buffer), bytes = new Uint8Array(text.length + 3);
  for (let k = 0; k < text.length; k += 1) bytes[k + 3] = text.charCodeAt(k);
  return new DataView(bytes.buffer, 3, text.length);
}
window.listeners = new Set();
window.sent = [];
window.deliver = (meta, buffers) => [...listeners].forEach((tell) => tell(meta, buffers.map(unpacked)));
window.show = async (view, key) => {
  const el = document.body.appendChild(document.createElement("div"));
  const model = {
    get: (name) => ({ view, key })[name], send: (message) => window.sent.push(message),
    on: (_, tell) => listeners.add(tell), off: (_, tell) => listeners.delete(tell),
  };
  window.leave = await widget.render({ model, el });
};
window.ready = true;
</script></body></html>"""
TEXT = "cue 1\n\nicon dip {\n  cool by 6 °C at 3 °C/s\n  hold for 4\n  return at 3 °C/s\n}\n"
TROUBLE = {
    **{"line": 5, "column": 12, "end_column": 13, "code": "E102"},
    **{"headline": "missing unit: this number has no unit", "hint": 'a time is written as "4 s"'},
    "suggestion": "  hold for 4 s",
}
ROWS = 600
# How much of a canvas is drawn on; how many pixels are light, and how many dark.
PIXELS = "c.getContext('2d').getImageData(0, 0, c.width, c.height).data"
INKED = f"c => new Uint32Array({PIXELS}.buffer).filter((pixel) => pixel).length"
SHADES = f"""() => {{
  const c = document.querySelector(".tm-base"), data = {PIXELS};
  let light = 0, dark = 0;
  for (let k = 0; k < data.length; k += 4) {{
    const sum = data[k] + data[k + 1] + data[k + 2];
    if (data[k + 3] > 200) sum > 600 ? light += 1 : sum < 120 ? dark += 1 : 0;
  }}
  return [light, dark];
}}"""


def packed(values: Any) -> str:
    return base64.b64encode(numpy.asarray(values, dtype="<f4").tobytes()).decode()


def design(**changes: Any) -> dict[str, Any]:
    """A frame of one panel with a straight fall from 32 to 26 °C in 6 s, and three corners."""
    skin = {"key": "skin", "label": "skin", "buffer": 0, "role": "ink"}
    handle = {"panel": "temperature", "moves_time": True, "moves_level": True, "why": None, "line": 4}
    fixed = {"moves_time": False, "moves_level": False, "why": "rest is at baseline", "t": 6.0, "y": 26.0}
    panel = {"key": "temperature", "label": "temperature (°C)", "series": [skin]}
    return {
        **{"type": "frame", "view": "design", "seq": 0, "text": TEXT, "ms": 2.0},
        **{"icons": ["dip", "rise"], "icon": "dip", "can_undo": True},
        "of": changes.get("text") or TEXT,
        "badge": {"colour": "green", "text": "no limit is passed", "more": ["28 °C at 2 s"]},
        "time": {"t0": 0.0, "dt": 0.01, "n": ROWS + 1},
        "panels": [panel],
        "handles": [{**handle, "t": 2.0, "y": 30.0}, {**handle, "t": 4.0, "y": 28.0}, {**handle, **fixed}],
    } | changes


TEXT_NOW = "k => document.querySelectorAll('.tm-editor')[k].editor.text"


class Bench:
    """The page as a person and a kernel use it."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.wrong: list[str] = []

    def show(self, view: str = "design", key: str = "one") -> None:
        self.page.evaluate("([view, key]) => show(view, key)", [view, key])

    def draw(self, **changes: Any) -> None:
        """Show the design view with a frame."""
        self.show()
        self.frame(design(**changes))

    def append(self, text: str) -> None:
        """Type at the end of the text."""
        self.page.locator(".cm-content").first.press("Control+End")
        self.page.keyboard.type(text)

    def frame(self, meta: dict[str, Any], *arrays: Any) -> None:
        given = arrays or (numpy.linspace(32.0, 26.0, ROWS + 1),)
        self.page.evaluate("([meta, buffers]) => deliver(meta, buffers)", [meta, [packed(each) for each in given]])
        self.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def sent(self, *kinds: str) -> list[dict[str, Any]]:
        messages = self.page.evaluate("sent")
        return [message for message in messages if not kinds or message["type"] in kinds]

    def answer(self, **changes: Any) -> None:
        """A frame that answers the newest message, and is of the newest text that was sent."""
        of = changes.get("text") or [TEXT, *(message["text"] for message in self.sent("text"))][-1]
        self.frame(design(**{"text": None, "of": of, "seq": self.sent()[-1]["seq"]} | changes))

    def said(self, text: str) -> None:
        """Wait until screen readers are told so."""
        self.page.wait_for_function("text => document.querySelector('.tm-live-region').textContent === text", arg=text)

    def again(self, key: str, **changes: Any) -> None:
        """The page loaded again, with a bench of this model and its first frame."""
        self.page.reload()
        self.page.wait_for_function("window.ready === true")
        self.show(key=key)
        self.frame(design(**changes))

    @property
    def text(self) -> str:
        """The cue text in the first editor."""
        return self.text_in(0)

    def text_in(self, place: int) -> str:
        """The cue text in one of several editors."""
        return str(self.page.evaluate(TEXT_NOW, place))

    @property
    def caret(self) -> int:
        """Where the caret is in the text."""
        where = "document.querySelector('.tm-editor').editor.view.state.selection.main.head"
        return int(self.page.evaluate(where))

    def set_caret(self, place: int) -> None:
        """Focus the text and put the caret there."""
        self.page.evaluate(
            "anchor => { const { view } = document.querySelector('.tm-editor').editor;"
            " view.focus(); view.dispatch({ selection: { anchor } }); }",
            place,
        )

    def corner(self, t: float, y: float) -> tuple[float, float]:
        """Where a point of the temperature panel is in the window."""
        box = self.page.locator(".tm-over").bounding_box()
        low, high = 29.0 - 3.0 * 1.12, 29.0 + 3.0 * 1.12
        across = 46 + (box["width"] - 56) * t / 6.0
        down = (box["height"] - 6) - (box["height"] - 11) * (y - low) / (high - low)
        return box["x"] + across, box["y"] + down


def open_bench(page: Any) -> Bench:
    """A page with the module, which shows nothing yet."""
    bench = Bench(page)
    page.on("pageerror", lambda problem: bench.wrong.append(str(problem)))
    parts = {"": (PAGE % style_text(), "text/html"), "module.mjs": (module_text(), "text/javascript")}

    def serve(route: Any) -> None:
        body, kind = parts.get(route.request.url.removeprefix(URL), ("", "text/plain"))
        route.fulfill(body=body, content_type=f"{kind}; charset=utf-8")

    page.route("**/*", serve)
    page.goto(URL)
    page.wait_for_function("window.ready === true")
    return bench
