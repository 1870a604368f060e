"""A guard on a bench that keeps its rules in simulated time."""

from typing import Any

import pytest

from tests.circuit.play.bench import Bench, Clock
from thermicon.circuit.play.function import FunctionLine
from thermicon.circuit.play.guard import Guard
from thermicon.circuit.play.watch import Numbers, Stopped

PLAIN = Numbers(20.0, 40.0, react_s=0.1, look_every_s=0.05, late_s=0.1, rest_s=3.0, pause_s=2.0, closed_loop=True)
ROWS = [(0.1 * k, 32.0 + 0.01 * k) for k in range(50)] + [(5.0, 32.0)]
TEST = {"test_polarity": True, "test_current_A": 0.3, "test_s": 2.0, "test_fall_K": 1.0}
BLOCK = [(0.0, "block"), (5.0, None)]


class BlockLine(FunctionLine):
    """A device that clocks a block of 5 s itself."""

    def __init__(self, bench: Bench) -> None:
        super().__init__(lambda row: bench.send(0.0), bench.off)
        self.bench, self.ends_s = bench, 0.0

    def send(self, row: Any) -> Any:
        super().send(row)
        self.ends_s = self.bench.clock.true_s + 5.0
        return lambda: self.bench.clock.true_s < self.ends_s


class World:
    """A guard on a bench, in simulated time."""

    def __init__(self, **numbers: Any) -> None:
        self.clock = Clock()
        self.bench = Bench(self.clock)
        self.numbers = PLAIN._replace(**numbers)
        self.guard = Guard(lambda: self.numbers, self.clock.monotonic, self.clock.sleep)
        bench = self.bench
        self.line = FunctionLine(bench.send, bench.off, bench.test, bench.feed)

    def play(
        self, line: FunctionLine | None = None, rows: Any = ROWS, second: bool = False, first: bool = True
    ) -> None:
        sensors = self.bench.measured_C if first else None, self.bench.second_C if second else None
        self.guard.play(line or self.line, rows, 32.0, (), sensors)

    def stops(self, words: str, line: FunctionLine | None = None, rows: Any = ROWS) -> str:
        with pytest.raises(Stopped, match=words) as ended:
            self.play(line, rows)
        assert self.bench.is_off
        return str(ended.value)
