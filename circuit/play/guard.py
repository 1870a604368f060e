"""The guard of a player: rests and plays as plans of steps."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from .steps import NOTHING_S, SECOND, Sensors, Steps
from .watch import SLOWEST_PART, Numbers, Refused, Stopped

if TYPE_CHECKING:
    from .line import Line

TIMED_LOOKS = 3  # before a rest, to know how quick the sensors are


class Guard(Steps):
    """Plays on a line by a clock in s, and looks at the display meanwhile.

    `begin_rest` and `begin_play` say what is to happen in the steps that follow; `rest` and `play` are loops of steps.
    `numbers` is asked at each use, so that they may be changed. What stopped refuses everything until `reset`. Sensors
    are functions that return the °C of the display; cut-offs act on both. One that was given is read until `reset`.
    `began_s` and `ended_s` are of the last play, `fell_K` has the fall of each sensor in the polarity test.
    """

    def reset(self) -> None:
        """Allow playing again after a stop; everything is then as before a first play."""
        if self.busy:
            raise Refused("busy: what was stopped has not ended yet; call reset() after it")
        self._forget()
        self._aborted.clear()

    def prepare(self, line: Line, rows: Sequence[Any]) -> None:
        """Send rows that begin nothing; the rest counts from their end, since the device holds its baseline then."""
        self._begin(line, (None, None), self._preparing(rows), pause_s=0.0)
        self._run()

    def rest(self, line: Line, row: Any, sensors: Sensors = (None, None)) -> None:
        """Test the polarity and hold a row (None: it is held already) for as long as before a first play."""
        self.begin_rest(line, row, sensors)
        self._run()

    def play(
        self,
        line: Line,
        rows: Sequence[tuple[float, Any]],
        rest_row: Any,
        expected: Sequence[tuple[float, float]] = (),
        sensors: Sensors = (None, None),
        watch: bool = True,
    ) -> None:
        """Send rows at their times in s, each held until the next; the last one marks the end, None sends nothing.

        `expected` are times and the °C that the display then has. Without `watch` it returns after the first row.
        """
        self.begin_play(line, rows, rest_row, expected, sensors, watch)
        self._run()

    def begin_rest(self, line: Line, row: Any, sensors: Sensors = (None, None)) -> None:
        """Have the steps that follow do what `rest` does."""
        self._begin(line, sensors, self._resting(row), self._numbers().pause_s)

    def begin_play(
        self,
        line: Line,
        rows: Sequence[tuple[float, Any]],
        rest_row: Any,
        expected: Sequence[tuple[float, float]] = (),
        sensors: Sensors = (None, None),
        watch: bool = True,
    ) -> None:
        """Have the steps that follow do what `play` does."""
        self._begin(line, sensors, self._playing(rows, rest_row, expected, watch), self._numbers().pause_s)

    def _preparing(self, rows: Sequence[Any]) -> Iterator[float]:
        for row in rows:
            self._send(row)
        yield self._now_s
        if not self.rested:
            self._held_s = self._now_s

    def _resting(self, row: Any) -> Iterator[float]:
        """Hold the rest, and a pause at least: nobody knows what played before this program began or was reset."""
        numbers, self.rested = self._numbers(), False
        if numbers.second_sensor and SECOND not in self._sensors:
            warnings.warn("a controller's cut-off needs a second sensor: give its function as second_C", stacklevel=2)
        self._watch.expect()
        yield from self._timing_sensors(numbers)
        if numbers.test_polarity:
            yield from self._testing(numbers)
        if row is not None:
            self._send(row)
        if row is not None or self._held_s is None:
            self._held_s = self._now_s
        yield self._held_s + max(numbers.rest_s, numbers.pause_s)
        self.rested = True

    def _timing_sensors(self, numbers: Numbers) -> Iterator[float]:
        """Refuse sensors that always take too long for the cut-off; meanwhile nothing is put out."""
        looks_s = []
        self._is_timing = True
        for _ in range(TIMED_LOOKS):
            yield from self._seen()
            looks_s.append(self._look_s)
        self._is_timing = False
        act_s = min(numbers.apart_at_most_s, numbers.late_s)  # what is due waits while a sensor is read
        most_s = SLOWEST_PART * act_s
        if min(looks_s) > most_s:
            raise Refused(
                f"the sensors take {min(looks_s):.2f} s for a reading, and the guard must act within {act_s:g} s: read "
                f"them in {most_s:.3g} s, {1.0 / most_s:.3g} times a second"
            )

    def _testing(self, numbers: Numbers) -> Iterator[float]:
        """Put out a current that must cool, and stop where the display does not fall, by both sensors."""
        assert self._line is not None
        if not self._levels_C or not self._test(0.0):
            if not numbers.polarity_seen.strip():
                raise Refused(
                    "the polarity must be tested before a first play, which needs a sensor of the display and a line "
                    "that puts out a current: give measured_C, and test for a controller; or write into POLARITY_SEEN "
                    "who saw the display cool under a current that must cool it, and when"
                )
            return
        self._put_off()
        yield self._now_s + numbers.off_before_test_s
        before_C = yield from self._seen()
        self._test(numbers.test_current_A)
        yield self._now_s + numbers.test_s
        after_C = yield from self._seen()
        for name, level_C in before_C.items():
            fell_K = level_C - after_C.get(name, math.nan)
            self.fell_K[name] = fell_K
            if not fell_K >= numbers.test_fall_K:
                raise Stopped(
                    f"the display fell by {fell_K:.2f} K at the {name}, not by {numbers.test_fall_K:g} K, under "
                    f"{numbers.test_current_A:g} A that must cool: swapped wires, or no current"
                )

    def _playing(
        self, rows: Sequence[tuple[float, Any]], rest_row: Any, expected: Sequence[tuple[float, float]], watch: bool
    ) -> Iterator[float]:
        if not self.rested:
            yield from self._resting(rest_row)
        yield from self._seen()
        self.began_s = begin_s = self._now_s
        playing = None
        if not watch:
            self._send(rows[0][1])
            self.ended_s = begin_s + rows[-1][0]
            return
        self._watch.expect(expected, begin_s)
        for at_s, row in rows:
            if begin_s + at_s > self._now_s + NOTHING_S:
                yield begin_s + at_s
            if row is not None:
                late_s = self._now_s - begin_s - at_s
                if late_s > self._numbers().late_s:
                    raise Stopped(self._late(late_s))
                playing = self._send(row)
        self._watch.expect()
        latest_s = self._now_s + 5.0
        while playing is not None and self._still(playing):
            if self._now_s > latest_s:
                raise Stopped("the device did not end in time")
            yield self._now_s + self._numbers().look_every_s
        self.ended_s = self._now_s
