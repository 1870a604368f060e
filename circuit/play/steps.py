"""The steps of a guard on a line."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Generator, Iterator
from typing import TYPE_CHECKING, Any

from .look import SensorLook
from .watch import Numbers, Refused, Stopped, Watch

if TYPE_CHECKING:
    from .line import Line

CLOCK_STANDS_S = 0.1  # even a coarse clock of a computer ticks every 0.016 s
NOTHING_S = 1e-9
FEED_EVERY_S = 0.2
BREAK_SEND_S = 0.2  # what waits so long for a send to end goes on without it
ANSWER_S = 5.0  # of a look that only times the sensors

FIRST, SECOND = "sensor", "second sensor"
Sensor = Callable[[], float] | None
Sensors = tuple[Sensor, Sensor]  # the first and the second one of a display; None: there is none


class Steps:
    """Does what a plan yields times for, on a line by a clock in s; one plan at a time.

    Each `step` does what is due and returns when the next one is. A look is due all the while; what a plan does waits
    while the sensors are read, since they may share a bus with the line.
    """

    def __init__(
        self, numbers: Callable[[], Numbers], clock: Callable[[], float], sleep: Callable[[float], None]
    ) -> None:
        self._numbers, self._clock, self._sleep = numbers, clock, sleep
        self._aborted = threading.Event()
        self._turn, self._sending = threading.Lock(), threading.RLock()
        self._watch = Watch(numbers)
        self._line: Line | None = None
        self._plan: Iterator[float] | None = None
        self._look: SensorLook | None = None
        self._asked_s = -math.inf
        self._forget()

    def _forget(self) -> None:
        self.rested, self.ended_s = False, -math.inf
        self.began_s = math.inf
        self.fell_K: dict[str, float] = {}
        self._held_s: float | None = None
        self._now_s, self._stood_s, self._due_s = -math.inf, 0.0, -math.inf
        self._fed_s = -math.inf
        self._sensors: dict[str, Callable[[], float]] = {}
        self._levels_C: dict[str, float] = {}
        self._look_s, self._slowest = 0.0, ("", 0.0)
        self._is_timing = self._on = False
        self._why = ""
        self._watch.forget()

    @property
    def busy(self) -> bool:
        """Whether a rest or a play goes on."""
        return self._plan is not None

    def abort(self) -> None:
        """Switch off at once and stop what plays, from any thread."""
        self._why = self._why or "abort() was called"
        self._aborted.set()
        self._put_off()

    def keep(self) -> None:
        """Look and feed between plays, where that is due; never waits. Raises Stopped where the output went off."""
        if self.busy or self._line is None or not self._turn.acquire(blocking=False):
            return  # what plays looks by itself
        try:
            if not self.busy:
                self._take_step(float(self._clock()))
        finally:
            self._turn.release()

    def step(self, now_s: float) -> float:
        """Do what is due at a time in s, and return when the next step is due; Stopped where the output went off."""
        with self._turn:
            return self._take_step(now_s)

    def is_answered(self, within_s: float) -> bool:
        """Whether a look that goes on has its answers, or gets them within so many s of a clock on the wall."""
        return self._look is not None and self._look.done.wait(within_s)

    def _begin(self, line: Line, sensors: Sensors, plan: Iterator[float], pause_s: float) -> None:
        """Take a plan on, or refuse it; only one that is taken on changes the line and the sensors."""
        with self._turn:
            if self.busy:
                raise Refused("busy: a rest or a play has not ended; one display plays one drive at a time")
            if self._aborted.is_set():
                raise Refused("stopped before: find out why, then call reset()")
            if line is not self._line or not self.rested:  # else it would forget that it switched off by itself
                line.open()
            try:
                self._check_clock(float(self._clock()))
            except Stopped as problem:
                self._line = self._line or line
                self._fail(problem)
                raise
            left_s = self.ended_s + pause_s - self._now_s
            if left_s > 0 and pause_s > 0:
                raise Refused(f"the pause of {pause_s:g} s between plays is not over: wait {left_s:.1f} s more")
            given = {name: read for name, read in zip((FIRST, SECOND), sensors, strict=True) if read}
            self._line, self._sensors = line, self._sensors | given
            if self._look is None or self._look.done.is_set():  # one that hangs still counts
                self._look, self._asked_s = None, -math.inf
            self._due_s, self._plan, self._levels_C = self._now_s, plan, {}

    def _run(self) -> None:
        """Take steps until the plan has ended."""
        try:
            next_s = self.step(float(self._clock()))
            while self.busy:
                self._wait(next_s)
                next_s = self.step(float(self._clock()))
        except BaseException as problem:
            if self.busy:  # an interrupt while it waited
                self._fail(problem)
            raise
        if self._aborted.is_set():
            stopped = Stopped(self._why)
            self._fail(stopped)
            raise stopped

    def _wait(self, until_s: float) -> None:
        """Wait until a time in s, or until the sensors have answered; a clock that stands still meanwhile stops."""
        look, now_s = self._look, float(self._clock())
        if look is not None and until_s > now_s and look.done.wait(until_s - now_s):
            return
        now_s = float(self._clock())
        left_s = min(until_s - now_s, CLOCK_STANDS_S)
        if not left_s > NOTHING_S:
            return
        self._sleep(left_s)
        self._stood_s = self._stood_s + left_s if self._clock() == now_s else 0.0
        if self._stood_s > CLOCK_STANDS_S:
            raise Stopped(f"the clock of this computer stands still at {now_s} s")

    def _take_step(self, now_s: float) -> float:
        try:
            if self._aborted.is_set():
                raise Stopped(self._why)
            self._check_clock(now_s)
            self._check_looks()
            if self._look is None:
                was_busy = self.busy
                self._go_on()
                self._feed()
                if self.busy or not was_busy:  # nobody waits for a look that begins as a play ends
                    self._ask()
        except Refused:
            self._plan = None
            raise
        except BaseException as problem:
            self._fail(problem)
            raise
        if self._look is not None:
            return self._asked_s + self._answer_s + 2.0 * NOTHING_S
        look_s = self._asked_s + self._numbers().look_every_s if self._sensors else math.inf
        return min(self._due_s if self.busy else math.inf, look_s, self._fed_s + FEED_EVERY_S)

    def _check_clock(self, now_s: float) -> None:
        """A clock that goes back, or is not a number, would switch off every guard and stops."""
        before_s = self._now_s
        if not before_s <= now_s < math.inf:
            raise Stopped(f"the clock of this computer is wrong: it reads {now_s} s after {before_s} s")
        self._now_s = now_s

    @property
    def _answer_s(self) -> float:
        """How long a look may take."""
        return ANSWER_S if self._is_timing else self._numbers().apart_at_most_s

    def _check_looks(self) -> None:
        """Judge a look that has come back; two looks too far apart stop, whether sensor or computer took so long."""
        look, gap_s = self._look, self._now_s - self._asked_s
        is_back = look is not None and look.done.is_set()
        if look is not None and is_back:
            self._look, self._look_s, self._slowest = None, look.took_s, look.slowest(gap_s)
            self._levels_C = look.levels_C()
            if not self.busy:  # between plays nobody promises to call keep() in time
                gap_s = look.took_s
        is_watched = look is not None or (self._levels_C and self.busy)
        if is_watched and self._answer_s + NOTHING_S < gap_s < math.inf:
            raise Stopped(self._late(gap_s))
        if is_back:
            self._watch.see(self._levels_C, self._asked_s, self._now_s, self._on)

    def _late(self, gap_s: float) -> str:
        """Who took a time in s: the sensor that is asked or was asked last, or else this computer."""
        name, took_s = self._slowest if self._look is None else self._look.slowest(gap_s)
        if took_s < 0.5 * gap_s:
            return f"this computer was late by {gap_s:.2f} s"
        return f"the {name} took {took_s:.2f} s for a reading, and a look may take {self._answer_s:g} s"

    def _go_on(self) -> None:
        """Do what is due of the plan; None of it is while a sensor is read."""
        while self._plan is not None and self._due_s <= self._now_s + NOTHING_S and self._look is None:
            due_s = next(self._plan, None)
            if due_s is None:
                self._plan = None
            else:
                self._due_s = due_s
                if due_s <= self._now_s:  # it waits for a look
                    return

    def _feed(self) -> None:
        if self._line is not None and self._now_s >= self._fed_s + FEED_EVERY_S - NOTHING_S:
            self._fed_s = self._now_s
            with self._sending:
                self._line.feed()

    def _ask(self) -> None:
        """Begin a look where one is due."""
        if not self._sensors or self._now_s < self._asked_s + self._numbers().look_every_s - NOTHING_S:
            return
        self._asked_s, self._look = self._now_s, SensorLook(self._sensors, self._clock)

    def _seen(self) -> Generator[float, None, dict[str, float]]:
        """A look that begins now: °C by sensor."""
        self._asked_s = -math.inf
        yield self._now_s
        return self._levels_C

    def _still(self, playing: Callable[[], bool]) -> bool:
        """Whether the device still plays; what it then closes is closed before off() comes from another thread."""
        with self._sending:
            return playing()

    def _send(self, row: Any) -> Callable[[], bool] | None:
        """Put out a row; where abort() came meanwhile, the output goes off again."""
        assert self._line is not None
        with self._sending:
            self._on = True
            playing = self._line.send(row)
        if self._aborted.is_set():
            raise Stopped(self._why)
        self._check_clock(float(self._clock()))  # a slow line took a while
        return playing

    def _test(self, current_A: float) -> bool:
        assert self._line is not None
        with self._sending:
            self._on = True
            can_test = self._line.test(current_A)
        if self._aborted.is_set():
            raise Stopped(self._why)
        return can_test

    def _put_off(self) -> None:
        """Switch off; what is sent just now ends first, unless it hangs."""
        if self._line is None:
            return
        is_free = self._sending.acquire(timeout=BREAK_SEND_S)
        try:
            self._line.off()
            self._on = False
        finally:
            if is_free:
                self._sending.release()

    def _fail(self, problem: BaseException) -> None:
        self._why = self._why or str(problem) or type(problem).__name__
        self._aborted.set()
        self._plan = None  # a look goes on: two readings of one sensor must not run at once
        self._put_off()
