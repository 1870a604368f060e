"""Several elements on one clock, each on a bench that keeps its rules."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

from tests.circuit.play.bench import Bench, Clock
from tests.circuit.play.guarded import PLAIN
from thermicon.circuit.play.element_lines import ElementLines
from thermicon.circuit.play.elements_guard import ElementsGuard
from thermicon.circuit.play.function import FunctionLine
from thermicon.circuit.play.guard import Guard

NAMES = "abcd"
HIGHEST_C = {"a": 37.0, "b": 35.0, "c": 40.0, "d": 34.0}
BEGINS_S = 103.0


def course(place: int) -> list[tuple[float, float]]:
    """A track of its own for each element: to 34, 29, 36 and 27 °C."""
    level_C = 32.0 + (2.0, -3.0, 4.0, -5.0)[place]
    return [(0.0, 32.0), (1.0, 32.0), (1.0 + abs(level_C - 32.0) / 4.0, level_C), (5.0, level_C)]


def at(points: list[tuple[float, float]], time_s: float) -> float:
    (from_s, from_C), (to_s, to_C) = next(pair for pair in pairwise(points) if time_s <= pair[1][0])
    return from_C + (to_C - from_C) * (time_s - from_s) / (to_s - from_s)


class Elements:
    """Elements by name, each a display that holds its last set-point; one alone has guard and line of one."""

    def __init__(self, names: str, **numbers: Any) -> None:
        self.clock = Clock()
        self.benches = {name: Bench(self.clock) for name in names}
        self.courses = {name: course(NAMES.index(name)) for name in names}
        self.numbers = {name: PLAIN._replace(high_C=HIGHEST_C[name], **numbers) for name in names}
        shared = PLAIN._replace(high_C=min(own.high_C for own in self.numbers.values()), **numbers)
        for bench in self.benches.values():
            bench.display = lambda now_s, bench=bench: next(
                (level for _, what, level in reversed(bench.out) if what == "send"), 32.0
            )
        lines = {each: FunctionLine(on.send, on.off, on.test, on.feed) for each, on in self.benches.items()}
        self.lines = lines
        times, clock = [0.1 * k for k in range(51)], self.clock
        levels = [{name: at(points, min(time_s, 5.0)) for name, points in self.courses.items()} for time_s in times]
        self.rows: list[tuple[float, Any]] = list(zip(times, levels, strict=True))
        self.rest: Any = levels[0]
        self.guard: Any = ElementsGuard(lambda: shared, lambda: self.numbers, clock.monotonic, clock.sleep)
        self.line: Any = ElementLines(lines, clock.monotonic)
        self.expected: Any = self.courses
        self.alone = names if len(names) == 1 else ""
        if self.alone:
            self.guard = Guard(lambda: self.numbers[names], clock.monotonic, clock.sleep)
            self.line, self.expected, self.rest = lines[names], self.courses[names], 32.0
            self.rows = [(time_s, row[names]) for time_s, row in self.rows]

    def play(self, second: bool = False) -> None:
        first: Any = {name: bench.measured_C for name, bench in self.benches.items()}
        seconds: Any = {name: bench.second_C for name, bench in self.benches.items()} if second else None
        if self.alone:
            first, seconds = first[self.alone], seconds and seconds[self.alone]
        self.guard.play(self.line, self.rows, self.rest, self.expected, (first, seconds))

    def stopped(self, second: bool = False) -> tuple[float, str]:
        """When and why all were off; (inf, "") where a whole play went through."""
        try:
            self.play(second)
        except Exception as problem:
            on = [name for name, bench in self.benches.items() if not bench.is_off]
            assert not on, f"{on} stayed on: {problem}"
            return max(bench.out[-1][0] for bench in self.benches.values()), str(problem)
        assert not any(bench.broken for bench in self.benches.values())
        return math.inf, ""
