"""A line to a device that also reports what it reads and puts out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

from .line import Line


class LineRow(NamedTuple):
    """One turn of a device's loop: what it read at its start and puts out from then on; None where it does not say."""

    time_s: float
    set_point_C: float | None
    loop_C: float
    second_C: float
    current_A: float | None
    voltage_V: float | None


class LoggedLine(Line, Protocol):
    """A line whose device measures the display and reports each turn; `status` also has `identity` and `stopped`.

    `fell_K` has the fall of each sensor where the device tests the polarity by itself.
    """

    fell_K: dict[str, float]

    def read(self) -> float:
        """Return the °C of the loop's sensor; raises where the device has switched off by itself."""

    def read_second(self) -> float:
        """Return the °C of the sensor that the cut-off acts on; raises as `read` does."""

    def rows(self) -> list[LineRow]:
        """Return the turns since the last call."""

    def rest_row(self, name: str, level_C: float) -> Any:
        """What this line takes to hold an icon's first level in °C."""

    def play_rows(self, name: str, rows: Sequence[tuple[float, float]]) -> list[tuple[float, Any]]:
        """What this line takes to play an icon's set-points in °C, with times in s."""

    def began_s(self, host_s: float) -> float:
        """When what this computer began at a time in s began, by the clock of the rows."""
