"""A line to a display: the few verbs by which a guard plays on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol


class Line(Protocol):
    """The hardware as a guard needs it; a row is what the line takes: V, °C, a command, or a block with its rate.

    A guard never calls two of these at once, but `off`: that comes from any thread, also while another call hangs.
    """

    def open(self) -> None:
        """Make ready; nothing is put out."""

    def send(self, row: Any) -> Callable[[], bool] | None:
        """Put out a row, which is held until the next; where the device clocks it, return whether it still plays."""

    def test(self, current_A: float) -> bool:
        """Put out a current, above 0 to cool; return False where this line cannot."""

    def feed(self) -> None:
        """Tell the device that this computer is alive."""

    def status(self) -> Mapping[str, object]:
        """Return what the device holds, by name; nothing where it does not say."""

    def off(self) -> None:
        """Leave the display without power; may be called at any time, and twice."""
