"""The guard of several display elements on one clock: what stops one element stops all."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from .guard import Guard
from .steps import FIRST, SECOND
from .watch import Numbers, Refused, Stopped, Watch

if TYPE_CHECKING:
    from .line import Line


class ElementsWatch(Watch):
    """A watch for each element, with its numbers and its expected course; its sensors are called *sensor of NAME*."""

    def __init__(self, elements: Callable[[], Mapping[str, Numbers]]) -> None:
        self._watches = {name: Watch(lambda name=name: elements()[name]) for name in elements()}  # type: ignore[misc]

    def forget(self) -> None:
        """Begin as before a first play."""
        for watch in self._watches.values():
            watch.forget()

    def expect(self, points: Any = (), begin_s: float = 0.0) -> None:
        """Begin a stretch with a course for each element, by name; none: anything."""
        courses = dict(points)
        for name, watch in self._watches.items():
            watch.expect(courses.get(name, ()), begin_s)

    def see(self, levels_C: Mapping[str, float], asked_s: float, now_s: float, on: bool) -> None:
        """Judge the readings of each element by its own watch."""
        for name, watch in self._watches.items():
            own = {kind: levels_C[f"{kind} of {name}"] for kind in (FIRST, SECOND) if f"{kind} of {name}" in levels_C}
            try:
                watch.see(own, asked_s, now_s, on)
            except Stopped as problem:
                raise Stopped(f"{name}: {problem}") from None


class ElementsGuard(Guard):
    """Plays on a line of several elements; rows, expected courses and sensors are mappings by element.

    `numbers` are the strictest of all, by which it acts in time; `elements` has those of each, by which it is watched.
    """

    def __init__(
        self,
        numbers: Callable[[], Numbers],
        elements: Callable[[], Mapping[str, Numbers]],
        clock: Callable[[], float],
        sleep: Callable[[float], None],
    ) -> None:
        super().__init__(lambda: numbers()._replace(second_sensor=False), clock, sleep)
        self._elements, self._watch = elements, ElementsWatch(elements)

    @property
    def apart_s(self) -> float:
        """The longest time in s between the first and the last element of a row, on the line that played last."""
        return float(getattr(self._line, "apart_s", 0.0))

    def _begin(self, line: Line, sensors: Any, plan: Iterator[float], pause_s: float) -> None:
        given: dict[str, Callable[[], float]] = {}
        for kind, readings in zip((FIRST, SECOND), sensors, strict=True):
            names = set(readings) if isinstance(readings, Mapping) else None
            if readings is not None and names != set(self._elements()):
                raise Refused(f"give a dict with a {kind} for each of {', '.join(self._elements())}, and no other one")
            given |= {f"{kind} of {name}": read for name, read in (readings or {}).items()}
        super()._begin(line, (None, None), plan, pause_s)
        self._sensors |= given

    def _resting(self, row: Any) -> Iterator[float]:
        own = self._elements()
        if lacking := [name for name in own if own[name].second_sensor and f"{SECOND} of {name}" not in self._sensors]:
            told = f"a controller's cut-off needs a second sensor: give functions for {', '.join(lacking)} as second_C"
            warnings.warn(told, stacklevel=2)
        yield from super()._resting(row)

    def _testing(self, numbers: Numbers) -> Iterator[float]:
        """Put out a current by one element after the other: its own display must fall, and no other one."""
        line: Any = self._line
        tested = []
        for name, own in self._elements().items():
            line.tested = name
            if own.test_polarity and self._levels_C and self._test(0.0):
                tested.append(name)
            elif own.test_polarity and not own.polarity_seen.strip():
                self._put_off()
                raise Refused(
                    f"{name}: the polarity must be tested before a first play, which needs a sensor of each display "
                    "and a line that puts out a current: give measured_C, and test for a controller; or write into "
                    "POLARITY_SEEN who saw the displays cool under a current that must cool them, and when"
                )
        if tested:
            self._put_off()
            yield self._now_s + numbers.off_before_test_s
        for name in tested:
            own, line.tested = self._elements()[name], name
            before_C = yield from self._seen()
            self._test(own.test_current_A)
            yield self._now_s + own.test_s
            after_C = yield from self._seen()
            self._put_off()
            for sensor, level_C in before_C.items():
                fell_K = level_C - after_C.get(sensor, math.nan)
                is_own = sensor in (f"{FIRST} of {name}", f"{SECOND} of {name}")
                if is_own:
                    self.fell_K[sensor] = fell_K
                if is_own is not (fell_K >= own.test_fall_K):
                    raise Stopped(
                        f"{name}: under its {own.test_current_A:g} A that must cool, by {own.test_fall_K:g} K and no "
                        f"other element, the {sensor} fell by {fell_K:.2f} K: swapped wires, exchanged elements, or no "
                        "current"
                    )

    def _fail(self, problem: BaseException) -> None:
        try:
            super()._fail(problem)
        except Stopped as still_on:
            raise Stopped(f"{self._why}; {still_on}") from None
