"""A user's functions as a line to a temperature controller."""

from __future__ import annotations

from collections.abc import Callable, Mapping


class FunctionLine:
    """`send` takes a set-point in °C, `off` switches the controller's output off.

    `test` puts out a current in A, above 0 to cool; `feed` tells the controller that this computer is alive.
    """

    def __init__(
        self,
        send: Callable[[float], object],
        off: Callable[[], object],
        test: Callable[[float], object] | None = None,
        feed: Callable[[], object] | None = None,
    ) -> None:
        self._send, self._off, self._test, self._feed = send, off, test, feed

    def open(self) -> None:
        """Nothing to do: the user's functions are ready."""

    def send(self, row: float) -> None:
        """Send a set-point in °C."""
        self._send(row)

    def test(self, current_A: float) -> bool:
        """Put out a current, where the user has a function for that."""
        if self._test is not None:
            self._test(current_A)
        return self._test is not None

    def feed(self) -> None:
        """Call the function of the user, where there is one."""
        if self._feed is not None:
            self._feed()

    def status(self) -> Mapping[str, object]:
        """Functions of the user say nothing."""
        return {}

    def off(self) -> None:
        """Switch the output off."""
        self._off()
