"""The watch of a guard: whether readings of the display's sensors allow a play to go on."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

SENSOR_LOWEST_C, SENSOR_HIGHEST_C = -20.0, 120.0  # a thermistor that is open or shorted reads far outside these
FROZEN_STEPS = 3.0
LATER_S = 0.5  # a sensor that is late by 0.3 s still moves so long after the other one has come to stay
APART_K, APART_S, LAG_S = 1.0, 0.3, 0.3  # two sensors of one display, of which the second may be late
BESIDE_K, BESIDE_S = 1.5, 1.0  # a loop's own sensor and its prediction; the weakest healthy corner comes to 1.35 K
UNSUPERVISED_S = 1.0  # between two looks where no cut-off is quick enough
COARSE_S = 0.016  # a tick of a coarse clock, by two of which no time is known better
SLOWEST_PART = 0.8  # of the time to react, for a reading


class Refused(RuntimeError):
    """A play that may not begin."""


class Stopped(RuntimeError):
    """A play that was stopped; the output is off."""


class Numbers(NamedTuple):
    """Limits of a guard in °C, s, K and A.

    `react_s`: how quickly the cut-off must act, 0 where no time is quick enough. `held_s`: how long the display may be
    outside `held_low_C` … `held_high_C` with power, None where that is not demanded. `polarity_seen`: who saw the
    display cool, where the line cannot test it.
    """

    low_C: float
    high_C: float
    react_s: float
    look_every_s: float
    late_s: float
    rest_s: float
    pause_s: float
    frozen_s: float = 1.0
    sensor_step_K: float = 0.1
    second_sensor: bool = False
    closed_loop: bool = False
    held_low_C: float = -math.inf
    held_high_C: float = math.inf
    held_s: float | None = None
    test_polarity: bool = False
    test_current_A: float = 0.0
    test_s: float = 1.0
    test_fall_K: float = 0.1
    off_before_test_s: float = 10.0
    polarity_seen: str = ""

    @property
    def apart_at_most_s(self) -> float:
        """How far two looks may be apart."""
        return max(self.react_s or UNSUPERVISED_S, 2.0 * COARSE_S)


class Watch:
    """What the sensors read so far, as a function of the times that are passed in; raises Stopped."""

    def __init__(self, numbers: Callable[[], Numbers]) -> None:
        self._numbers = numbers
        self.forget()

    def forget(self) -> None:
        """Begin as before a first play."""
        self._since: dict[str, float] = {}
        self._late = (math.nan, math.nan)
        self.expect()

    def expect(self, points: Sequence[tuple[float, float]] = (), begin_s: float = 0.0) -> None:
        """Begin a stretch in which the display is predicted to have these °C by time; none: anything."""
        self._points, self._begin_s = points, begin_s
        self._stays: dict[str, tuple[float, float, float, float]] = {}
        # A display that stays where it must not be does so across stretches, and in pauses without a look.
        self._since = {name: since_s for name, since_s in self._since.items() if name.endswith("held")}

    def see(self, levels_C: Mapping[str, float], asked_s: float, now_s: float, on: bool) -> None:
        """Judge readings by name of the sensor, made between two times; `on`: the output may have power."""
        for name, now_C in levels_C.items():
            self._check_range(name, now_C)
            self._check_held(name, now_C, now_s, on)
        self._check_apart(levels_C, now_s)
        self._check_beside(levels_C, asked_s, now_s)
        self._check_frozen(levels_C, now_s)

    def _lasts(self, what: str, is_so: bool, now_s: float) -> float:
        """For how long something was so at every look, in s; -1 where it is not."""
        if not is_so:
            self._since.pop(what, None)
            return -1.0
        return now_s - self._since.setdefault(what, now_s)

    def _check_range(self, name: str, now_C: float) -> None:
        """A thermistor reads what a thermistor can; the cut-off acts on both."""
        low_C, high_C = self._numbers().low_C, self._numbers().high_C
        if not SENSOR_LOWEST_C < now_C < SENSOR_HIGHEST_C:  # not a number fails too
            raise Stopped(f"the {name} is lost: it reads {now_C} degrees C")
        if not low_C <= now_C <= high_C:
            raise Stopped(f"the display is at {now_C:.2f} degrees C, outside {low_C:g} to {high_C:g}")

    def _check_held(self, name: str, now_C: float, now_s: float, on: bool) -> None:
        """The second cut-off: a display that stays beyond a temperature with power."""
        numbers = self._numbers()
        low_C, high_C, most_s = numbers.held_low_C, numbers.held_high_C, numbers.held_s
        lasts_s = self._lasts(f"{name} held", on and not low_C <= now_C <= high_C, now_s)
        if most_s is not None and lasts_s > most_s:
            raise Stopped(
                f"the display is outside {low_C:g} to {high_C:g} degrees C for {lasts_s:.1f} s, at {now_C:.2f}; "
                f"{most_s:g} s are allowed"
            )

    def _check_apart(self, levels_C: Mapping[str, float], now_s: float) -> None:
        """A second sensor that is late reads between the first one and a level that follows it as slowly."""
        if len(levels_C) < 2:
            return
        first_C, second_C = levels_C.values()
        late_C, seen_s = self._late
        late_C = first_C if math.isnan(late_C) else late_C
        share = (now_s - seen_s) / (LAG_S + now_s - seen_s) if now_s > seen_s else 0.0
        late_C += (first_C - late_C) * share
        self._late = late_C, now_s
        apart_K = max(min(first_C, late_C) - second_C, second_C - max(first_C, late_C))
        if self._lasts("apart", apart_K > APART_K, now_s) >= APART_S - COARSE_S:
            raise Stopped(
                f"the sensors are {apart_K:.2f} K apart for {APART_S:g} s, at {first_C:.2f} and {second_C:.2f} degrees "
                f"C, more than {APART_K:g} K: one of them is wrong or has come off"
            )

    def _check_beside(self, levels_C: Mapping[str, float], asked_s: float, now_s: float) -> None:
        """A loop holds its own sensor at the prediction, which is exact enough to judge it by."""
        if not self._points or not self._numbers().closed_loop or not levels_C:
            return
        due_C = self._due_C(asked_s, now_s)
        name, now_C = next(iter(levels_C.items()))
        beside_K = max(min(due_C) - now_C, now_C - max(due_C))
        if self._lasts("beside", beside_K > BESIDE_K, now_s) > BESIDE_S:
            raise Stopped(
                f"the display is at {now_C:.2f} degrees C by the {name}, {beside_K:.2f} K from its prediction for "
                f"{BESIDE_S:g} s, more than {BESIDE_K:g} K: a wrong sensor, swapped wires, or another loop"
            )

    def _check_frozen(self, levels_C: Mapping[str, float], now_s: float) -> None:
        """A reading that stays when the other sensor moves, or where that stays too or is not there, the prediction."""
        numbers, due_C = self._numbers(), self._due_C(now_s, now_s)[0]
        for name, now_C in levels_C.items():
            other_C = next((level_C for other, level_C in levels_C.items() if other != name), math.nan)
            last_C, since_s, other_from_C, due_from_C = self._stays.get(name, (math.nan, now_s, other_C, due_C))
            if now_C != last_C:
                since_s = now_s
            if now_s - since_s <= LATER_S:
                other_from_C, due_from_C = other_C, due_C
            self._stays[name] = now_C, since_s, other_from_C, due_from_C
            is_alone = math.isnan(other_C) or other_C == other_from_C
            moved_K = abs(due_C - due_from_C if is_alone else other_C - other_from_C)
            if self._lasts(name, moved_K > FROZEN_STEPS * numbers.sensor_step_K, now_s) > numbers.frozen_s:
                how = f"{moved_K:.2f} K were predicted" if is_alone else f"the other one moved by {moved_K:.2f} K"
                raise Stopped(f"the {name} is frozen: it has read {now_C:.3f} degrees C while {how}")

    def _due_C(self, from_s: float, to_s: float) -> list[float]:
        """The predicted °C at two times and at all points between them; 0 without a prediction."""
        points = self._points
        if not points:
            return [0.0]
        begin, end = from_s - self._begin_s, to_s - self._begin_s
        between = points[bisect_right(points, (begin, math.inf)) : bisect_right(points, (end, math.inf))]
        return [_at(points, begin), *(at_C for _, at_C in between), _at(points, end)]


def _at(points: Sequence[tuple[float, float]], time_s: float) -> float:
    """The °C at a time, linear between points and held outside them."""
    after = min(max(1, bisect_right(points, (time_s, math.inf))), len(points) - 1)
    (from_s, from_C), (to_s, to_C) = points[after - 1], points[after]
    return from_C + (to_C - from_C) * min(max((time_s - from_s) / (to_s - from_s), 0.0), 1.0)
