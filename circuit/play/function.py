"""Functions of the user as a line to a temperature controller, which is sent set-points one by one."""

from __future__ import annotations

from collections.abc import Callable


class FunctionLine:
    """`send` takes a set-point in °C, `off` switches the controller's output off, `measured_C` returns °C."""

    def __init__(
        self, send: Callable[[float], object], off: Callable[[], object], measured_C: Callable[[], float] | None = None
    ) -> None:
        self._send, self._off, self._measured_C = send, off, measured_C

    def open(self) -> None:
        """Nothing to do: the user's functions are ready."""

    def send(self, row: float) -> None:
        """Send a set-point in °C."""
        self._send(row)

    def read(self) -> float | None:
        """Ask the function of the user."""
        return None if self._measured_C is None else float(self._measured_C())

    def off(self) -> None:
        """Switch the output off."""
        self._off()
