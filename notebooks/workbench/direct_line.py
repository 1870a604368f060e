"""A line from page to kernel past Jupyter's server, for steps of a drag or slider on this machine: an own WebSocket.

A message of a widget passes through the server, and JupyterLab lays out its toolbars twice for each since the kernel is
busy and idle again; that takes longer than simulating. Only pages of this machine ask for the line, it opens when one
does, and whatever else is said goes the ordinary way, so that without it nothing is lost but speed.
"""

from __future__ import annotations

import hmac
import json
import re
import secrets
import struct
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, HTTPError
from tornado.websocket import WebSocketHandler

HERE = "127.0.0.1"
PAGES = re.compile(r"https?://(localhost|127\.0\.0\.1|\[::1\])(:\d{1,5})?")
"""Origins of pages that a server of this machine gave out, Jupyter's or Voila's, on whatever port."""

MOST_BYTES = 100_000
"""Bytes of a message: a step of a drag has some hundred."""

Frame = tuple[Mapping[str, Any], Sequence[bytes]]


class DirectLine:
    """One port of this machine, open to its pages that know the token; each message is answered by a frame.

    ``answer`` takes the message and returns the frame; it is called in the kernel's own thread.
    """

    def __init__(self, answer: Callable[[dict[str, Any]], Frame]) -> None:
        self.answer = answer
        self.token = secrets.token_urlsafe(24)
        self.sockets: set[WebSocketHandler] = set()
        self._server: HTTPServer | None = None
        self.port = 0

    def open(self) -> tuple[int, str]:
        """Return port and token; the first call opens the port. Call it where an event loop runs. Raises OSError."""
        if self._server is None:
            sockets = bind_sockets(0, HERE)
            self.port = sockets[0].getsockname()[1]
            # Without a log, since the address that it would hold is the token.
            application = Application([(r"/(.*)", _Socket, {"line": self})], log_function=lambda _: None)
            self._server = HTTPServer(application)
            self._server.add_sockets(sockets)
        return self.port, self.token

    def close(self) -> None:
        """Close the port, and the pages' connections to it."""
        if self._server is not None:
            self._server.stop()
            self._server, self.port = None, 0
        for socket in tuple(self.sockets):
            socket.close()
        self.sockets.clear()


class _Socket(WebSocketHandler):
    """A page on the line."""

    line: DirectLine

    def initialize(self, line: DirectLine) -> None:
        self.line = line

    def prepare(self) -> None:
        """Refuse whoever does not know the token, or asks for another machine."""
        is_known = hmac.compare_digest(self.path_args[0].encode(), self.line.token.encode())
        if not is_known or self.request.host != f"{HERE}:{self.line.port}":
            raise HTTPError(403)

    def check_origin(self, origin: str) -> bool:
        """Whether a page, which a browser names here, is one of this machine; Jupyter's server has another port."""
        return PAGES.fullmatch(origin) is not None

    def open(self, *_: str) -> None:
        self.set_nodelay(True)
        self.line.sockets.add(self)

    def on_close(self) -> None:
        self.line.sockets.discard(self)

    def on_message(self, message: str | bytes) -> None:
        """Answer a message with a frame; what is none ends the line, and the page goes on the ordinary way."""
        try:
            if len(message) > MOST_BYTES:
                raise ValueError("too long")
            said = json.loads(message)
            frame = self.line.answer(said) if isinstance(said, dict) else None
        except (ValueError, RecursionError):
            frame = None
        if frame is None:
            self.close()
        else:
            self.write_message(packed(*frame), binary=True)


def packed(meta: Mapping[str, Any], buffers: Sequence[bytes]) -> bytes:
    """Return a frame as bytes: length of the JSON (uint32, little endian), JSON padded to 4 bytes, then the buffers.

    The JSON holds the lengths of the buffers (bytes) under ``lengths``.

    >>> packed({"seq": 1}, [b"abcd"])
    b'\\x1c\\x00\\x00\\x00{"seq": 1, "lengths": [4]}  abcd'
    """
    text = json.dumps({**meta, "lengths": [len(each) for each in buffers]}).encode()
    text += b" " * (-len(text) % 4)
    return b"".join((struct.pack("<I", len(text)), text, *buffers))
