"""The guard of a player: it plays rows after rest and pause but switches off where something is wrong."""

from __future__ import annotations

import csv
import math
import threading
import warnings
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

if TYPE_CHECKING:
    from .line import Line

SENSOR_LOWEST_C, SENSOR_HIGHEST_C = -20.0, 120.0  # a thermistor that is open or shorted reads far outside these
CLOCK_STANDS_S = 0.1  # even a coarse clock of a computer ticks every 0.016 s
FROZEN_STEPS = 3.0
NOTHING_S = 1e-9


class Refused(RuntimeError):
    """A play that may not begin."""


class Stopped(RuntimeError):
    """A play that was stopped; the output is off."""


class Numbers(NamedTuple):
    """Limits of a guard in °C, s and K; the command that tests the polarity is in the unit of the line."""

    low_C: float
    high_C: float
    look_every_s: float
    late_s: float
    rest_s: float
    pause_s: float
    frozen_s: float = 1.0
    sensor_step_K: float = 0.1
    second_sensor: bool = False
    test_polarity: bool = False
    test_command: float = 0.0
    test_s: float = 1.0
    test_fall_K: float = 0.1


class Guard:
    """Plays on a line by a clock in s, and looks at the display meanwhile.

    `numbers` is asked at each use, so that they may be changed. What stopped refuses everything until `reset`. Each
    play may have a second sensor, a function that returns °C: the cut-off then acts on both.
    """

    def __init__(
        self, numbers: Callable[[], Numbers], clock: Callable[[], float], sleep: Callable[[float], None]
    ) -> None:
        self._numbers, self._clock, self._sleep = numbers, clock, sleep
        self._aborted = threading.Event()
        self._unwatched: Line | None = None
        self._forget()

    def _forget(self) -> None:
        self.rested, self.ended_s = False, -math.inf
        self._held_s: float | None = None
        self._now_s, self._looked_s, self._stood_s = -math.inf, -math.inf, 0.0
        self._expect()

    def _expect(self, points: Sequence[tuple[float, float]] = (), begin_s: float = 0.0) -> None:
        """Begin a stretch in which the display is to have these °C by time; what was read before is forgotten."""
        self._expected, self._begin_s = points, begin_s
        self._readings: dict[str, tuple[float, float, float]] = {}

    def abort(self) -> None:
        """Stop what plays, from any thread."""
        self._aborted.set()
        if self._unwatched is not None:
            self._unwatched.off()

    def reset(self) -> None:
        """Allow playing again after a stop; everything is then as before a first play."""
        self._forget()
        self._aborted.clear()

    def hold(self) -> None:
        """Count the rest from now on, since the display is held at what a drive begins with."""
        if not self.rested:
            self._held_s = self.now()

    def rest(self, line: Line, row: Any, second_C: Callable[[], float] | None = None) -> None:
        """Test the polarity and hold a row (None: it is held already) for as long as before a first play."""
        with self._on(line, second_C):
            self._rest(row)

    def play(
        self,
        line: Line,
        rows: Sequence[tuple[float, Any]],
        rest_row: Any,
        expected: Sequence[tuple[float, float]] = (),
        second_C: Callable[[], float] | None = None,
        watch: bool = True,
    ) -> None:
        """Send rows at their times in s, each held until the next; the last one marks the end, None sends nothing.

        `expected` are times and the °C that the display then has. Without `watch` it returns after the first row.
        """
        with self._on(line, second_C):
            if not self.rested:
                self._rest(rest_row)
            begin_s, playing = self.now(), None
            if not watch:
                self._unwatched, self.ended_s = line, begin_s + rows[-1][0]
                line.send(rows[0][1])
                return
            self._expect(expected, begin_s)
            for at_s, row in rows:
                self._wait(begin_s + at_s)
                if row is not None:
                    if (late_s := self.now() - begin_s - at_s) > self._numbers().late_s:
                        self._stop(f"this computer was late by {late_s:.2f} s")
                    playing = line.send(row)
            self._expect()
            latest_s = self.now() + 5.0
            while playing is not None and playing():
                self._wait(self.now() + self._numbers().look_every_s)
                if self.now() > latest_s:
                    self._stop("the device did not end in time")
            self.ended_s = self.now()

    def now(self) -> float:
        """Return the time in s; a clock that goes back, or is not a number, would switch off every guard and stops."""
        now_s, before_s = float(self._clock()), self._now_s
        if not before_s <= now_s < math.inf:
            self._stop(f"the clock of this computer is wrong: it reads {now_s} s after {before_s} s")
        self._now_s = now_s
        return now_s

    @contextmanager
    def _on(self, line: Line, second_C: Callable[[], float] | None) -> Iterator[None]:
        """Use a line where a play may begin; it is switched off by whatever ends this early."""
        self._line, self._second_C = line, second_C
        line.open()
        try:
            if self._aborted.is_set():
                raise Refused("stopped before: find out why, then call reset()")
            pause_s = self._numbers().pause_s
            if (left_s := self.ended_s + pause_s - self.now()) > 0:
                raise Refused(f"the pause of {pause_s:g} s between plays is not over: wait {left_s:.1f} s more")
            self._unwatched = None
            yield
        except Refused:
            raise
        except BaseException:
            self._aborted.set()
            line.off()
            raise

    def _rest(self, row: Any) -> None:
        """Hold the rest, and a pause at least: nobody knows what played before this program began or was reset."""
        numbers, self.rested = self._numbers(), False
        if numbers.second_sensor and self._second_C is None:
            warnings.warn("a controller's cut-off needs a second sensor: give its function as second_C", stacklevel=4)
        self._expect()
        if numbers.test_polarity:
            self._test_polarity(numbers)
        if row is not None:
            self._line.send(row)
        if row is not None or self._held_s is None:
            self._held_s = self.now()
        self._wait(self._held_s + max(numbers.rest_s, numbers.pause_s))
        self.rested = True

    def _test_polarity(self, numbers: Numbers) -> None:
        """Put out a command that must cool, and stop where the display does not fall."""
        before_C = self._look()
        if before_C is None:
            return
        self._line.send(numbers.test_command)
        self._wait(self.now() + numbers.test_s)
        after_C = self._look()
        fell_K = before_C - (math.nan if after_C is None else after_C)
        if not fell_K >= numbers.test_fall_K:
            self._stop(
                f"the display fell by {fell_K:.2f} K, not by {numbers.test_fall_K:g} K, under "
                f"{numbers.test_command:g} V that must cool: swapped wires, or no current"
            )

    def _wait(self, until_s: float) -> None:
        """Look regularly until a time in s; a clock that stands still meanwhile stops."""
        every_s = self._numbers().look_every_s
        while True:
            now_s = self.now()
            if now_s >= self._looked_s + every_s - NOTHING_S:
                self._look()
            left_s = min(until_s, self._looked_s + every_s) - now_s
            if until_s - now_s <= NOTHING_S:
                return
            self._sleep(left_s)
            self._stood_s = self._stood_s + left_s if self.now() == now_s else 0.0
            if self._stood_s > CLOCK_STANDS_S:
                self._stop(f"the clock of this computer stands still at {now_s} s")

    def _look(self) -> float | None:
        """Look once at both sensors, and return what the first reads; stop where it must not go on."""
        if self._aborted.is_set():
            self._stop("abort() was called")
        self._looked_s = self.now()
        reading_C = self._read("sensor", self._line.read)
        if self._second_C is not None:
            self._read("second sensor", self._second_C)
        return reading_C

    def _read(self, name: str, read: Callable[[], float | None]) -> float | None:
        numbers, now_s = self._numbers(), self._looked_s
        try:
            answer = read()
            if answer is None and name == "sensor":
                return None
            now_C = float(answer)  # type: ignore[arg-type]
        except Exception as problem:
            self._stop(f"the {name} is lost ({problem})")
        if not SENSOR_LOWEST_C < now_C < SENSOR_HIGHEST_C:  # not a number fails too
            self._stop(f"the {name} is lost: it reads {now_C} degrees C")
        if not numbers.low_C <= now_C <= numbers.high_C:
            self._stop(f"the display is at {now_C:.2f} degrees C, outside {numbers.low_C:g} to {numbers.high_C:g}")
        due_C = _at(self._expected, now_s - self._begin_s)
        last_C, since_s, from_C = self._readings.get(name, (math.nan, now_s, due_C))
        moved_K = abs(due_C - from_C)
        if now_C != last_C:
            self._readings[name] = now_C, now_s, due_C
        elif now_s - since_s > numbers.frozen_s and moved_K > FROZEN_STEPS * numbers.sensor_step_K:
            self._stop(f"the {name} is frozen: it has read {now_C:.3f} degrees C while {moved_K:.2f} K were predicted")
        return now_C

    def _stop(self, why: str) -> NoReturn:
        self._aborted.set()
        raise Stopped(why)


def _at(points: Sequence[tuple[float, float]], time_s: float) -> float:
    """The °C at a time, linear between points and held outside them; 0 without points."""
    if not points:
        return 0.0
    after = min(max(1, bisect_right(points, (time_s, math.inf))), len(points) - 1)
    (from_s, from_C), (to_s, to_C) = points[after - 1], points[after]
    return from_C + (to_C - from_C) * min(max((time_s - from_s) / (to_s - from_s), 0.0), 1.0)


def columns_of(drive_file: str, *names: str) -> list[list[float]]:
    """Times in s and other columns of a drive file; Refused where its rows do not come at one rate from 0 s on."""
    with Path(drive_file).open(newline="") as file:
        rows = list(csv.DictReader(file))
    try:
        columns = [[float(row[name]) for row in rows] for name in ("time_s", *names)]
    except (KeyError, TypeError, ValueError) as problem:
        raise Refused(f"{drive_file}: not a drive, a cell cannot be read ({problem})") from None
    times = columns[0]
    step_s = times[-1] / (len(times) - 1) if len(times) > 1 else math.nan
    if not all(math.isfinite(value) for column in columns for value in column) or not step_s > 0:
        raise Refused(f"{drive_file}: a drive has two rows or more, with times and commands that are numbers")
    for place, time_s in enumerate(times):
        if abs(time_s - place * step_s) > 1e-3 * step_s:
            raise Refused(
                f"{drive_file}, row {place + 1}: at {time_s:g} s, where rows at one rate from 0 s on have "
                f"{place * step_s:g} s: give a drive with a row for each update, as the format psychopy writes it"
            )
    return columns
