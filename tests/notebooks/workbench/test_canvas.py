"""The canvas widget without a browser."""

import base64
import gzip
import json
import re
from pathlib import Path
from typing import Any

import numpy
import pytest

from thermicon.notebooks.workbench.canvas import (
    PARTS,
    STYLES,
    Canvas,
    codemirror_text,
    module_text,
    style_text,
)

FOLDER = Path(__file__).parents[3] / "notebooks" / "canvas_parts"


@pytest.fixture
def sent(monkeypatch: pytest.MonkeyPatch) -> list[tuple[dict[str, Any], list[bytes]]]:
    """What a canvas sends to the page."""
    found: list[tuple[dict[str, Any], list[bytes]]] = []
    monkeypatch.setattr(Canvas, "send", lambda self, content, buffers=None: found.append((content, buffers or [])))
    return found


def test_a_frame_goes_out_with_its_view_and_float32_buffers(sent):
    canvas = Canvas(view="heat")
    canvas.frame({"seq": 3, "labels": ["a"]}, [numpy.array([[1.5, numpy.nan]])])
    meta, buffers = sent[-1]
    assert meta == {"type": "frame", "view": "heat", "seq": 3, "labels": ["a"]}
    values = numpy.frombuffer(buffers[0], dtype="<f4")
    assert values[0] == 1.5
    assert numpy.isnan(values[1])


def test_a_page_that_greets_gets_the_newest_frame_or_hears_that_the_kernel_is_there(sent):
    canvas = Canvas("traces")
    handed: list[dict[str, Any]] = []
    canvas.on_message(handed.append)
    canvas._receive(canvas, {"type": "hello"}, [])
    assert (handed, sent) == ([], [({"type": "alive"}, [])])
    canvas.frame({"seq": 1})
    canvas.frame({"seq": 2}, [numpy.arange(3.0)])
    sent.clear()
    canvas._receive(canvas, {"type": "hello"}, [])
    ((meta, buffers),) = sent
    assert (meta["seq"], len(buffers[0])) == (2, 12)


def test_no_data_is_kept_in_traits_and_the_module_is_small():
    canvas = Canvas()
    canvas.frame({"seq": 0, "text": "x" * 10_000}, [numpy.zeros(100_000)])
    state = canvas.get_state()
    assert len(str({name: value for name, value in state.items() if name not in ("_esm", "_css")})) < 1_500
    assert len(state["_esm"].encode()) + len(state["_css"].encode()) < 300_000


def test_every_part_is_joined_and_short_and_imports_nothing():
    assert {path.stem for path in FOLDER.glob("*.js")} == set(PARTS)
    assert {path.stem for path in FOLDER.glob("*.css")} == set(STYLES)
    text = module_text()
    assert "\nimport " not in text
    assert text.count("export default") == 1
    assert '"hold"' in text.partition("\n")[0]
    assert "°C/s" in text.partition("\n")[0]
    assert all(len(path.read_text(encoding="utf-8").splitlines()) < 400 for path in FOLDER.iterdir())
    assert "--tm-paper" in style_text()


def test_codemirror_is_packed_whole_with_its_licences():
    packed = re.search(r'const PACKED_CODEMIRROR = "([^"]+)"', module_text())
    script = gzip.decompress(base64.b64decode(packed[1])).decode()
    assert script == codemirror_text()
    assert script.rstrip().endswith("};")
    assert "EditorView" in script
    folder = FOLDER.parent / "codemirror"
    versions = json.loads((folder / "package.json").read_text(encoding="utf-8"))["dependencies"]
    licences = (folder / "LICENSES.txt").read_text(encoding="utf-8")
    for name, version in versions.items():
        assert re.fullmatch(r"\d+\.\d+\.\d+", version), f"{name} is not pinned"
        assert f"{name} {version}\n\n" in licences
    assert {path.name for path in folder.iterdir()} == {
        "LICENSES.txt", "build.sh", "codemirror.js", "entry.js", "package.json"
    }  # fmt: skip
