"""The lines of several display elements as one line."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any

from .line import Line
from .watch import Stopped

APART_AT_MOST_S = 0.1  # assumed: two hands so far apart are under d' 1 in thermicon's own model; nobody has measured it
OFF_S = 0.02  # for one line to switch off, before the next one is: one that hangs must not keep others on
HANGS_S = 0.5  # after which one that has not is said to hang


class ElementLines:
    """Sends a row, a mapping from element to what its line takes, to all lines; what stops one switches off all.

    `apart_s` is the longest time in s from the first to the last line of a row; `tested` the element that `test` is of.
    """

    def __init__(
        self, lines: Mapping[str, Line], clock: Callable[[], float], apart_at_most_s: float = APART_AT_MOST_S
    ) -> None:
        self._lines, self._clock, self._apart_at_most_s = dict(lines), clock, apart_at_most_s
        self._offs = 0
        self.apart_s, self.tested = 0.0, next(iter(self._lines))

    def open(self) -> None:
        """Make all ready."""
        for line in self._lines.values():
            line.open()

    def send(self, row: Mapping[str, Any]) -> Callable[[], bool] | None:
        """Put out what each element plays; Stopped where they begin too far apart; off() meanwhile ends it."""
        offs, began_s = self._offs, self._clock()
        playing = []
        for name, line in self._lines.items():
            playing.append(line.send(row[name]))
            if self._offs != offs:  # the guard says why
                return None
            apart_s = self._clock() - began_s
            self.apart_s = max(self.apart_s, apart_s)
            if apart_s > self._apart_at_most_s:
                raise Stopped(
                    f"{name}: it had a row {apart_s:.2f} s after the row was begun, and elements may be "
                    f"{self._apart_at_most_s:g} s apart"
                )
        clocked = [still for still in playing if still is not None]
        return (lambda: any(still() for still in clocked)) if clocked else None

    def test(self, current_A: float) -> bool:
        """Put out a current by the line of the element `tested`."""
        return self._lines[self.tested].test(current_A)

    def feed(self) -> None:
        """Tell every device that this computer is alive."""
        for line in self._lines.values():
            line.feed()

    def status(self) -> Mapping[str, object]:
        """Return what each device holds, by element."""
        return {name: line.status() for name, line in self._lines.items()}

    def off(self) -> None:
        """Switch off one after the other; Stopped with the elements that did not, which keep no other one on."""
        self._offs += 1
        failed = dict.fromkeys(self._lines, "it hangs")
        threads, interrupt = [], None
        for name in self._lines:
            thread = threading.Thread(target=self._put_off, args=(name, failed), daemon=True)
            try:
                thread.start()
                threads.append(thread)
                thread.join(OFF_S)
            except RuntimeError:  # an interpreter that ends starts no thread
                self._put_off(name, failed)
            except BaseException as problem:
                interrupt = problem
        for thread in threads:
            thread.join(HANGS_S)
        if interrupt is not None:
            raise interrupt
        if failed:
            why = "; ".join(f"{name} did not switch off ({how})" for name, how in tuple(failed.items()))
            raise Stopped(f"{why}: cut the power; every other element is off")

    def _put_off(self, name: str, failed: dict[str, str]) -> None:
        try:
            self._lines[name].off()
            del failed[name]
        except BaseException as problem:
            failed[name] = str(problem) or type(problem).__name__
