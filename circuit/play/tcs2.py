"""The serial line of a QST.Lab TCS II, which clocks a profile itself once it was sent."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

TICK_S, STEP_C = 0.01, 0.1


class Tcs2Line:
    """A port that is open; `measured_C` returns the temperature of the display in °C."""

    def __init__(self, port: Any, measured_C: Callable[[], float] | None = None) -> None:
        self._port, self._measured_C = port, measured_C

    def open(self) -> None:
        """Nothing to do: the port is open."""

    def send(self, row: str) -> None:
        """Send a command."""
        self._port.write(row.encode("ascii"))

    def read(self) -> float | None:
        """Ask the function of the user."""
        return None if self._measured_C is None else float(self._measured_C())

    def off(self) -> None:
        """Abort the stimulation."""
        self._port.write(b"A")


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
