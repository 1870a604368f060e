"""A line to a device that also reports what it reads and puts out."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ..play.line import Line


class LineRow(NamedTuple):
    """One turn of a device's loop: what it read at its start and puts out from then on; None where it does not say."""

    time_s: float
    set_point_C: float | None
    loop_C: float
    second_C: float
    current_A: float | None
    voltage_V: float | None


class LoggedLine(Line, Protocol):
    """A line whose device measures the display and reports each turn; `status` also has `identity` and `stopped`."""

    def read(self) -> float:
        """Return the °C of the loop's sensor; raises where the device has switched off by itself."""

    def read_second(self) -> float:
        """Return the °C of the sensor that the cut-off acts on; raises as `read` does."""

    def rows(self) -> list[LineRow]:
        """Return the turns since the last call."""
