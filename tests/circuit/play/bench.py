"""A computer's clock and a user's bench, which keep the rules of the real ones."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Clock:
    """A clock that passes only in sleep() and where something takes time.

    Rules, by the documentation of Python's `time`: monotonic() never goes back and may be coarse (`tick_s` 0.0156 on
    Windows before Python 3.13), and sleep() lasts at least as long as it is asked to, there to the next tick.
    """

    def __init__(self, start_s: float = 100.0, tick_s: float = 0.0) -> None:
        self.true_s, self.tick_s = start_s, tick_s
        self.events: list[Callable[[], None]] = []

    def monotonic(self) -> float:
        return math.floor(self.true_s / self.tick_s) * self.tick_s if self.tick_s else self.true_s

    def passes(self, seconds: float) -> None:
        self.true_s += seconds

    def sleep(self, seconds: float) -> None:
        assert seconds > 0
        self.true_s += seconds
        if self.tick_s:
            self.true_s = math.ceil(self.true_s / self.tick_s) * self.tick_s
        for event in tuple(self.events):
            event()

    def at(self, time_s: float, strikes: Callable[[], None]) -> None:
        """What happens once, later."""

        def event() -> None:
            if self.true_s > time_s - 1e-9:
                self.events.remove(event)
                strikes()

        self.events.append(event)


class Bench:
    """A temperature controller on one bus: the functions of a user, and the display that they reach.

    Rules: a bus carries one call at a time, so send, test, feed and both sensors never overlap, only `off` comes at any
    time; a thermometer on USB takes up to 0.1 s (`reads_s`) and may never answer (`hangs`); off is off until the next
    send or test; what a sensor shows is the display with its offset, lag and step. `broken` holds rules not kept.
    """

    def __init__(self, clock: Clock) -> None:
        self.clock = clock
        self.out: list[tuple[float, str, float]] = []
        self.broken: list[str] = []
        self.display: Callable[[float], float] = lambda now_s: 32.0
        self.first: Callable[[float], float] = lambda now_s: self.display(now_s) + 1e-4 * math.sin(1e3 * now_s)
        self.second: Callable[[float], float] = lambda now_s: self.display(now_s) + 1e-4 * math.cos(1e3 * now_s)
        self.reads_s: Callable[[], float] = lambda: 0.0
        self.hangs, self.goes_on = False, threading.Event()
        self.looks = self.feeds = 0
        self._bus = threading.Lock()

    @contextmanager
    def _call(self, name: str) -> Iterator[None]:
        if not self._bus.acquire(blocking=False):
            self.broken.append(f"{name} while the bus was busy")
            yield
            return
        try:
            yield
        finally:
            self._bus.release()

    def send(self, level_C: float) -> None:
        with self._call("send"):
            self.out.append((self.clock.true_s, "send", level_C))

    def test(self, current_A: float) -> None:
        with self._call("test"):
            self.out.append((self.clock.true_s, "test", current_A))

    def feed(self) -> None:
        with self._call("feed"):
            self.feeds += 1

    def off(self) -> None:
        self.out.append((self.clock.true_s, "off", 0.0))

    def measured_C(self) -> float:
        return self._reading("measured_C", self.first)

    def second_C(self) -> float:
        return self._reading("second_C", self.second)

    def _reading(self, name: str, sensor: Callable[[float], float]) -> float:
        with self._call(name):
            self.looks += 1
            if self.hangs:
                assert self.goes_on.wait(30.0)
            level_C = sensor(self.clock.true_s)
            self.clock.passes(self.reads_s())
            return level_C

    @property
    def is_off(self) -> bool:
        """Whether the output is without power."""
        return not self.out or self.out[-1][1] == "off"
