"""The direct line between a page and the kernel of this machine: who gets in, what is answered, what ends it."""

import asyncio
import json
import logging
import struct
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

import numpy
import pytest
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

from thermicon.circuit import Rig
from thermicon.notebooks.workbench.canvas import Canvas
from thermicon.notebooks.workbench.design_model import DesignModel
from thermicon.notebooks.workbench.direct_line import HERE, MOST_BYTES, DirectLine, packed
from thermicon.notebooks.workbench.knobs import knobs_of

DIP = "cue 1; icon dip { cool by 3 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }"
KNOB = next(knob for knob in knobs_of(Rig.load("thenar")) if not knob.options)
Result = TypeVar("Result")
Line = tuple[Canvas, DesignModel, list[dict[str, Any]]]


async def page_on(port: int, path: str, **headers: str) -> WebSocketClientConnection:
    """A connection as a page of Jupyter's server on this machine asks for it, but for some headers."""
    asked = HTTPRequest(f"ws://{HERE}:{port}/{path}", headers={"Origin": "http://localhost:8888", **headers})
    return await websocket_connect(asked)


def on_line(line: DirectLine, talk: Callable[[int, str], Awaitable[Result]]) -> Result:
    """Open a line, talk to its port with its token, close it."""

    async def go() -> Result:
        port, token = line.open()
        try:
            return await asyncio.wait_for(talk(port, token), 20)
        finally:
            line.close()

    return asyncio.run(go())


def answered(line: DirectLine, message: str | bytes, **headers: str) -> Any:
    """The answer to a message of a page; None where the line is ended instead."""

    async def talk(port: int, token: str) -> Any:
        socket = await page_on(port, token, **headers)
        await socket.write_message(message, binary=isinstance(message, bytes))
        return await socket.read_message()

    return on_line(line, talk)


def unpacked(data: bytes) -> tuple[dict[str, Any], list[bytes]]:
    (size,) = struct.unpack("<I", data[:4])
    meta, at = json.loads(data[4 : 4 + size]), 4 + size
    buffers = []
    for length in meta["lengths"]:
        buffers.append(data[at : at + length])
        at += length
    assert at == len(data)
    return meta, buffers


@pytest.fixture
def line() -> Line:
    """A canvas with a model behind it, and the messages that it sends by Jupyter."""
    canvas, model, sent = Canvas(), DesignModel(DIP, Rig.load("thenar")), list[dict[str, Any]]()
    canvas.send = lambda content, buffers=None: sent.append(content)

    def receive(message: Any) -> None:
        frame = model.receive(message)
        canvas.frame(frame.meta, frame.buffers)

    canvas.on_message(receive)
    receive({"type": "hello", "seq": 1})
    return canvas, model, sent


def test_a_frame_survives_its_packing_and_its_buffers_are_aligned():
    values = numpy.arange(5, dtype="<f4")
    meta, buffers = unpacked(packed({"seq": 7, "label": "Δ °C"}, [values.tobytes(), b""]))
    assert (meta["seq"], meta["label"]) == (7, "Δ °C")
    assert numpy.frombuffer(buffers[0], "<f4").tolist() == values.tolist()
    (size,) = struct.unpack("<I", packed({"seq": 7}, [])[:4])
    assert size % 4 == 0


def test_a_step_of_a_drag_is_answered_on_the_line_alone(line: Line):
    canvas, _, sent = line
    before = len(sent)
    step = {"type": "drag", "handle": 0, "t": 2.0, "y": 28.0, "end": False, "seq": 9}
    meta, buffers = unpacked(answered(canvas._line, json.dumps(step)))
    assert (meta["type"], meta["seq"], meta["lengths"]) == ("frame", 9, [len(each) for each in buffers])
    assert meta["text"] == DIP.replace("3 °C", "4 °C")
    assert meta["panels"][0]["key"] == "temperature"
    assert len(sent) == before


def test_a_step_of_a_slider_is_drawn_and_the_slider_itself_draws_nothing_anew(line: Line):
    canvas, model, _ = line
    step = {"type": "turn", "key": KNOB.key, "value": KNOB.low, "seq": 4}
    meta, _ = unpacked(answered(canvas._line, json.dumps(step)))
    drawn = model.scene
    assert (meta["seq"], model.values) == (4, {KNOB.key: KNOB.low})
    whole = model.turn({KNOB.key: KNOB.low})
    assert model.scene is drawn
    assert whole.meta["time"]["n"] >= meta["time"]["n"]


@pytest.mark.parametrize(
    "message",
    [
        json.dumps({"type": "text", "text": "cue 1", "seq": 1}),
        json.dumps({"type": "drag", "handle": 0, "t": 1.0, "y": 30.0, "end": True, "seq": 1}),
        json.dumps([1, 2]),
        "[" * 5000,
        "no JSON",
        '{"type": "drag", "why": "' + "x" * MOST_BYTES + '"}',
        b"\xff\xfe",
    ],
)
def test_anything_else_ends_the_line_and_changes_nothing(line: Line, message: str | bytes):
    canvas, model, _ = line
    assert answered(canvas._line, message) is None
    assert model.text == DIP


def test_a_knob_that_does_not_exist_or_is_out_of_range_is_said_and_stays(line: Line):
    _, model, _ = line
    for key, value in (("nothing", 1.0), (KNOB.key, 1e9), (KNOB.key, "wide")):
        frame = model.receive({"type": "turn", "key": key, "value": value, "seq": 2})
        assert f"no slider goes to {key} = {value}" in frame.meta["notes"][0]
    assert model.values == {}


STRANGERS = [
    {"Host": "attacker.example"},
    {"Host": "attacker.example:{port}"},
    {"Host": "localhost:{port}"},
    {"Host": "127.0.0.1"},
    {"Host": "127.0.0.1:{port}.attacker.example"},
    {"Origin": ""},
    {"Origin": "http://localhost:8888/"},
    {"Origin": "null"},
    {"Origin": "file://"},
    {"Origin": "https://attacker.example"},
    {"Origin": "http://localhost.attacker.example:8888"},
    {"Origin": "http://localhost:8888@attacker.example"},
    {"Origin": "http://localhost:8888, http://attacker.example"},
]


def test_only_a_page_of_this_machine_that_has_the_token_gets_in():
    line = DirectLine(lambda message: ({}, []))

    async def talk(port: int, token: str) -> None:
        tries: list[tuple[str, dict[str, str]]] = [(token, headers) for headers in STRANGERS]
        for path, headers in [*tries, *((path, {}) for path in ("", "x" * len(token), token[:-1], f"{token}/more"))]:
            try:
                await page_on(port, path, **{key: text.format(port=port) for key, text in headers.items()})
            except HTTPClientError as error:
                assert error.code == 403
            else:
                raise AssertionError(f"{path} {headers} got in")

    on_line(line, talk)
    assert len(line.token) >= 32
    assert DirectLine(line.answer).token != line.token


@pytest.mark.parametrize("origin", ["http://localhost:8866", "https://127.0.0.1", "http://[::1]:8888"])
def test_pages_of_any_server_of_this_machine_get_in_and_the_token_stands_in_no_log(
    caplog: pytest.LogCaptureFixture, origin: str
):
    line = DirectLine(lambda message: ({"seq": 1}, []))
    with caplog.at_level(logging.DEBUG):
        assert answered(line, "{}", Origin=origin) is not None
        with pytest.raises(HTTPClientError, match="403"):
            on_line(line, lambda port, token: page_on(port, f"{token}-no"))
    assert line.token not in caplog.text


def test_a_closed_canvas_answers_nobody(line: Line):
    canvas, _, _ = line
    step = json.dumps({"type": "turn", "key": "contact", "value": 2.0, "seq": 2})

    async def talk(port: int, token: str) -> object:
        socket = await page_on(port, token)
        await socket.write_message(step)
        assert await socket.read_message() is not None
        canvas.close()
        return await socket.read_message()

    assert on_line(canvas._line, talk) is None


def test_the_page_is_told_where_the_line_is_and_which_sliders_it_takes(line: Line):
    canvas, _, sent = line

    async def go() -> None:
        canvas.follow({"contact": "id-1"})
        assert [message["type"] for message in sent] == ["frame"]  # nobody asked yet
        canvas._receive(canvas, {"type": "line"}, [])
        canvas.follow({"contact": "id-2"})

    asyncio.run(go())
    canvas.close()
    lines = [message for message in sent if message["type"] == "line"]
    assert [line["sliders"] for line in lines] == [{"contact": "id-1"}, {"contact": "id-2"}]
    assert lines[0]["port"] == lines[1]["port"] > 0


def test_a_kernel_that_may_open_no_port_goes_on_without(line: Line, monkeypatch: pytest.MonkeyPatch):
    canvas, _, sent = line

    def no_port(line: DirectLine) -> tuple[int, str]:
        raise PermissionError("not allowed")

    monkeypatch.setattr(DirectLine, "open", no_port)
    canvas._receive(canvas, {"type": "line"}, [])
    assert [message["type"] for message in sent] == ["frame"]
