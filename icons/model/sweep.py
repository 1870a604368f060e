"""Check all members of a family side by side: arrays instead of icons, and the exact check for those that stand out."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .check import MOST_CORNERS, Problem, absolute, corner_count, fits, problems
from .family import Family, Summary
from .icon import rest_level
from .motion import TOLERANCE, one_period
from .shapes import Pulse, Shape, Step, Wave
from .slots import Path
from .statements import Current, Hold, Play, Repeat, Rest, Return, Statement, Total
from .value_limits import HIGHEST_A, HIGHEST_C, LONGEST_S, LOWEST_C, SHORTEST_S

Array = NDArray[np.float64]
CHUNK = 65_536
# Levels are sums of few decimals: closer than this they are the same, and times are held to a microsecond.
_SAME = 1e-9
# What floats leave of a quotient that is whole, or of quarters, in exact numbers.
_ROUNDING = 1e-12
_MOST_TRIED = 50
# In terms of one statement of one member: a statement of any number of them, a wave, a corner of a played icon.
_PASS, _WAVE, _CORNER = 2_000, 8, 1_000
# Phases at which a wave that starts upwards has been at its crest and in its trough.
_CREST: dict[Shape, float] = {"sine": 0.25, "triangle": 0.25, "sawtooth": 0.5, "square": 0.0}
_TROUGH: dict[Shape, float] = {"sine": 0.75, "triangle": 0.75, "sawtooth": 0.5, "square": 0.5}


@dataclass(frozen=True, slots=True)
class Sweep:
    """What a sweep found: the summary, how many members fail, and what is wrong with the first that does."""

    summary: Summary
    failing: int
    member: str | None
    statements: tuple[Statement, ...]
    problem: Problem | None


def sweep(family: Family, start: float | None = None) -> Sweep:
    """Check every member of a family; a failing one is confirmed by the exact check that icons go through.

    ``start`` (°C, or A under control current) is the baseline when the context gives none.
    """
    rest = rest_level(family.context, start)
    found: list[int] = []
    failing = 0
    summaries = []
    for first in range(0, len(family), CHUNK):
        indices = np.arange(first, min(first + CHUNK, len(family)))
        run = _Run(family, indices, float(rest))
        bad = np.flatnonzero(run.go())
        failing += len(bad)
        found += [int(first + place) for place in bad[: _MOST_TRIED - len(found)]]
        summaries.append(run.summary())
    summary = Summary(
        min(part.shortest_s for part in summaries),
        max(part.longest_s for part in summaries),
        min(part.lowest for part in summaries),
        max(part.highest for part in summaries),
        max(part.steepest_per_s for part in summaries),
    )
    for index in found:
        icon = family[index]
        wrong = problems(icon.statements, family.context.control, rest)
        if wrong:
            return Sweep(summary, failing, icon.name, icon.statements, wrong[0])
    return Sweep(summary, 0, None, (), None)


def effort(family: Family) -> int:
    """Return how much there is to check in a family: members times statements, and what each pass costs beside."""
    chunks = -(-len(family) // CHUNK)
    known: dict[int, int] = {}
    varied = {slot.path for slot in family.slots if slot.field == "count"}

    def cost(part: Any, path: Path) -> int:
        if isinstance(part, Repeat):
            inside = sum(cost(own, (*path, place)) for place, own in enumerate(part.body))
            return inside if part.count == 1 and path not in varied else inside * (2 if absolute(part.body) else 3)
        if isinstance(part, Play):
            if id(part.icon) not in known:
                known[id(part.icon)] = _CORNER * corner_count(part.icon.statements)
            return len(family) + chunks * (_PASS + known[id(part.icon)])
        return len(family) * (_WAVE if isinstance(part, Wave) else 1) + chunks * _PASS

    return sum(cost(part, (place,)) for place, part in enumerate(family.template))


class _Run:
    """One chunk of members, walked through statement by statement."""

    def __init__(self, family: Family, indices: NDArray[np.int64], rest: float) -> None:
        self.family = family
        self.size = len(indices)
        self.current = family.context.control == "current"
        self.rest = rest
        self.bad = np.zeros(self.size, dtype=bool)
        self.low = np.full(self.size, self.rest)
        self.high = np.full(self.size, self.rest)
        self.steepest = np.zeros(self.size)
        self.corners = np.zeros(self.size)
        self.fields: dict[tuple[Path, str], Array] = {}
        values: dict[str, NDArray[np.int64]] = {}
        for parameter in reversed(family.parameters):
            indices, values[parameter.name] = np.divmod(indices, len(parameter))
        tables = {parameter.name: parameter for parameter in family.parameters}
        for slot in family.slots:
            own = tables[slot.parameter]
            self.fields[slot.path, slot.field] = own.si_array(values[slot.parameter], slot.kind)

    def go(self) -> NDArray[np.bool_]:
        everywhere = np.ones(self.size, dtype=bool)
        _, self.total = self.body(self.family.template, (), np.full(self.size, self.rest), everywhere)
        self.flag(self.total > LONGEST_S, everywhere)
        self.flag(self.total <= 0, everywhere)
        self.flag(self.corners > MOST_CORNERS, everywhere)
        for place, part in enumerate(self.family.template):
            if isinstance(part, Total):
                off = self.total - self.value(part, (place,), "duration_s")
                over = off > SHORTEST_S if part.bound != "at least" else np.zeros(self.size, dtype=bool)
                under = off < -SHORTEST_S if part.bound != "at most" else np.zeros(self.size, dtype=bool)
                self.flag(over | under, everywhere)
        lowest, highest = (-HIGHEST_A, HIGHEST_A) if self.current else (LOWEST_C, HIGHEST_C)
        self.flag((self.low < lowest - _SAME) | (self.high > highest + _SAME), everywhere)
        return self.bad

    def summary(self) -> Summary:
        times = self.total
        lowest, highest = float(self.low.min()), float(self.high.max())
        return Summary(float(times.min()), float(times.max()), lowest, highest, float(self.steepest.max()))

    def value(self, part: Any, path: Path, name: str) -> Array:
        found = self.fields.get((path, name))
        return np.full(self.size, float(getattr(part, name))) if found is None else found

    def flag(self, wrong: Any, where: NDArray[np.bool_]) -> None:
        self.bad |= wrong & where

    def see(self, level: Array, where: NDArray[np.bool_]) -> None:
        self.low = np.where(where, np.minimum(self.low, level), self.low)
        self.high = np.where(where, np.maximum(self.high, level), self.high)

    def body(self, parts: Sequence[Any], path: Path, level: Array, where: NDArray[np.bool_]) -> tuple[Array, Array]:
        total = np.zeros(self.size)
        for place, part in enumerate(parts):
            here = (*path, place)
            if isinstance(part, Repeat):
                level, time = self.repeat(part, here, level, where)
            else:
                level, time = self.leaf(part, here, level, where)
            total = total + time
        return level, total

    def repeat(self, part: Repeat, path: Path, level: Array, where: NDArray[np.bool_]) -> tuple[Array, Array]:
        count = self.value(part, path, "count")
        before = self.corners.copy()
        after, time = self.body(part.body, path, level, where)
        self.corners = before + (self.corners - before) * count
        if not (count > 1).any():
            return after, time
        kept = self.corners
        step = after - level
        if absolute(part.body):
            later, again = self.body(part.body, path, after, where & (count > 1))
            self.corners = kept
            return np.where(count > 1, later, after), time + again * (count - 1)
        self.body(part.body, path, after, where & (count > 1))
        self.body(part.body, path, level + step * (count - 1), where & (count > 2))
        self.corners = kept
        return level + step * count, time * count

    def leaf(self, part: Any, path: Path, level: Array, where: NDArray[np.bool_]) -> tuple[Array, Array]:
        still = np.zeros(self.size)
        self.corners = self.corners + 1
        if not isinstance(part, Play) and not fits(part, self.family.context.control):
            self.flag(True, where)
        match part:
            case Hold() | Rest():
                if isinstance(part, Rest):
                    self.flag(np.abs(level - self.rest) > _SAME, where)
                return level, self.value(part, path, "duration_s")
            case Total():
                return level, still
            case Play():
                self.flag(np.abs(level - self.rest) > _SAME, where)
                played = part.icon.corners(self.rest)
                self.corners = self.corners + corner_count(part.icon.statements)
                self.see(np.full(self.size, played.lowest), where)
                self.see(np.full(self.size, played.highest), where)
                self.steepest = np.maximum(self.steepest, played.steepest_per_s)
                return np.full(self.size, played.value[-1]), np.full(self.size, played.duration_s)
            case Wave():
                return self.wave(part, path, level, where)
        target = self.target(part, path, level, where)
        self.see(target, where)
        if isinstance(part, Pulse):
            self.corners = self.corners + 2
            return level, self.value(part, path, "duration_s")
        if isinstance(part, Step):
            return target, still
        rate = next((name for name in _RATES if getattr(part, name, None) is not None), None)
        if rate is None:
            time = self.value(part, path, "duration_s")
        else:
            time = np.abs(target - level) / self.value(part, path, rate)
            self.flag((time < SHORTEST_S) & (time > 0), where)
        with np.errstate(divide="ignore", invalid="ignore"):
            self.steepest = np.fmax(self.steepest, np.where(where, np.abs(target - level) / time, 0.0))
        return target, time

    def target(self, part: Any, path: Path, level: Array, where: NDArray[np.bool_]) -> Array:
        if isinstance(part, Return):
            self.flag(np.abs(level - self.rest) <= _SAME, where)
            return np.full(self.size, self.rest)
        for name in ("by_K", "by_A"):
            if getattr(part, name, None) is not None:
                sign = -1.0 if part.direction == "cool" else 1.0
                return np.asarray(level + sign * self.value(part, path, name))
        target = self.value(part, path, "to_C" if getattr(part, "to_C", None) is not None else "to_A")
        self.flag(np.abs(target - level) <= _SAME, where)
        if not isinstance(part, Current) and part.direction != "change":
            self.flag((target > level) != (part.direction == "warm"), where)
        return target

    def wave(self, part: Wave, path: Path, level: Array, where: NDArray[np.bool_]) -> tuple[Array, Array]:
        size = self.value(part, path, "by_K" if part.by_K is not None else "by_A")
        period, time = self.value(part, path, "period_s"), self.value(part, path, "duration_s")
        periods = time / period
        quarters = np.round(periods * 4) / 4
        periods = np.where(np.abs(periods - quarters) <= _ROUNDING * periods, quarters, periods)
        if not part.cut:
            self.flag(periods != np.round(periods), where)
        self.corners = self.corners + np.ceil(periods) * _points(part.shape, size)
        phase = periods - np.ceil(periods) + 1
        value = np.where(phase == 1, 0.0, _value(part.shape, phase))
        if part.cut:
            crest = np.where(periods > _CREST[part.shape], 1.0, np.maximum(value, 0.0))
            trough = np.where(periods > _TROUGH[part.shape], -1.0, np.minimum(value, 0.0))
        else:
            crest, trough = np.ones(self.size), -np.ones(self.size)
        self.see(level + part.sign * size * crest, where)
        self.see(level + part.sign * size * trough, where)
        slope = {"sine": 2 * np.pi, "triangle": 4.0, "sawtooth": 2.0, "square": 0.0}[part.shape]
        self.steepest = np.maximum(self.steepest, np.where(where, slope * size / period, 0.0))
        return (np.asarray(level + part.sign * size * value) if part.cut else level), time


_RATES = ("rate_K_per_s", "rate_A_per_s", "rate_per_s")


def _points(shape: Shape, size: Array) -> Array:
    """How many corners one period has at each amplitude; few of them need counting, as the number only rises."""
    sizes, which = np.unique(size, return_inverse=True)
    counts = np.zeros(len(sizes))
    todo = [(0, len(sizes) - 1)]
    for end in todo[0]:
        counts[end] = len(one_period(shape, TOLERANCE / float(sizes[end])))
    while todo:
        first, last = todo.pop()
        if counts[first] == counts[last]:
            counts[first : last + 1] = counts[first]
        elif last > first + 1:
            middle = (first + last) // 2
            counts[middle] = len(one_period(shape, TOLERANCE / float(sizes[middle])))
            todo += [(first, middle), (middle, last)]
    return np.asarray(counts[which])


def _value(shape: Shape, phase: Array) -> Array:
    """Value (±1) at phases above 0 and up to 1 of a wave that starts upwards; at a step, the value before it."""
    if shape == "sine":
        return np.asarray(np.sin(2 * np.pi * phase))
    if shape == "square":
        return np.where(phase <= 0.5, 1.0, -1.0)
    if shape == "sawtooth":
        return np.where(phase <= 0.5, 2 * phase, 2 * phase - 2)
    return np.asarray(1 - np.abs(((4 * phase + 1) % 4) - 2))
