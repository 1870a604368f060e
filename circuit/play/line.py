"""A line to a display: the four verbs by which a guard plays on it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol


class Line(Protocol):
    """The hardware as a guard needs it; a row is what the line takes: V, °C, a command, or a block with its rate."""

    def open(self) -> None:
        """Make ready; nothing is put out."""

    def send(self, row: Any) -> Callable[[], bool] | None:
        """Put out a row, which is held until the next; where the device clocks it, return whether it still plays."""

    def read(self) -> float | None:
        """Return the measured temperature of the display in °C; None where there is no sensor."""

    def off(self) -> None:
        """Leave the display without power."""
