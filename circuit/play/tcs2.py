"""The serial line of a QST.Lab TCS II."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import Any

TICK_S, STEP_C = 0.01, 0.1
BREAK_WRITE_S = 0.1


class Tcs2Line:
    """A port that is open; use one line for each port."""

    def __init__(self, port: Any) -> None:
        self._port = port
        self._lock, self._left, self._breaks = threading.Lock(), b"", False

    def open(self) -> None:
        """Nothing to do: the port is open."""

    def send(self, row: str) -> None:
        """Send a command."""
        with self._lock:
            self._left = row.encode("ascii")
            while self._left and not self._breaks:
                count = self._port.write(self._left)
                self._left = b"" if count is None else self._left[count:]

    def test(self, current_A: float) -> bool:
        """A thermode takes temperatures only."""
        return False

    def feed(self) -> None:
        """Nothing to do: a profile ends by itself."""

    def status(self) -> Mapping[str, object]:
        """The form of its answers is not known."""
        return {}

    def off(self) -> None:
        """Abort the stimulation; a command that is half out is ended first, else `A` counts as one of its digits."""
        self._breaks = True
        is_free = self._lock.acquire(timeout=BREAK_WRITE_S)
        if not is_free:
            self._port.cancel_write()  # the write then returns how many bytes are out
            is_free = self._lock.acquire(timeout=BREAK_WRITE_S)
        try:
            self._port.write(self._left + b"A")
            self._left = b""
        finally:
            self._breaks = False
            if is_free:
                self._lock.release()


def course_of(commands: Sequence[str]) -> list[tuple[float, float]]:
    """Times in s and °C of the corners of a profile; ValueError where the commands hold none."""
    neutral, profile = (next((one for one in commands if one.startswith(name)), "") for name in ("N", "Uw"))
    count, body = int(profile[7:10] or 0), profile[10:]
    if not neutral or not count or len(body) != 6 * count or commands[-1] != "L":
        raise ValueError("these are not the commands of a profile, which are N, Uw with its segments, and L at the end")
    corners = [(0.0, STEP_C * int(neutral[1:]))]
    for k in range(0, len(body), 6):
        corners.append((corners[-1][0] + TICK_S * int(body[k : k + 3]), STEP_C * int(body[k + 3 : k + 6])))
    return corners
