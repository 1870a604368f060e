"""The motion of the level under each statement."""

import math
from collections.abc import Iterator
from fractions import Fraction
from functools import lru_cache
from itertools import accumulate, pairwise

from .statements import Current, Leaf, Pulse, Ramp, Return, Shape, Step, Total, Wave
from .units import exact

TOLERANCE = 1e-3
"""How far (K, or A under control current) a straight piece may lie from a sine, unless the caller says otherwise."""

Point = tuple[Fraction, Fraction]
# Phases and values of a sine are fractions of this; a whole number of periods is one to this precision.
_FINE = 10**9
# A quarter of a sine has no more corners than this, however small the tolerance.
_MOST_CORNERS = 20_000
# Phases behind which a wave that starts upwards has been at its crest and in its trough.
_CREST: dict[Shape, Fraction] = {
    **dict.fromkeys(("sine", "triangle"), Fraction(1, 4)),
    **{"sawtooth": Fraction(1, 2), "square": Fraction(0)},
}
_TROUGH: dict[Shape, Fraction] = {
    **dict.fromkeys(("sine", "triangle"), Fraction(3, 4)),
    **dict.fromkeys(("sawtooth", "square"), Fraction(1, 2)),
}


def advance(leaf: Leaf, level: Fraction, rest: Fraction) -> tuple[Fraction, Fraction]:
    """Return the level (°C or A) behind a statement and the time (s) it takes, both exact."""
    rate: Fraction | None = None
    match leaf:
        case Ramp():
            target = _target(leaf, level)
            rate = None if leaf.rate_K_per_s is None else exact(leaf.rate_K_per_s, "rate")
        case Current():
            target = exact(leaf.to_A, "current")
            rate = None if leaf.rate_A_per_s is None else exact(leaf.rate_A_per_s, "current_rate")
        case Return():
            target = rest
            rate = None if leaf.rate_per_s is None else exact(leaf.rate_per_s, "rate")
        case Step():
            return _target(leaf, level), Fraction(0)
        case Wave():
            end = level + amplitude(leaf) * leaf.sign * _cut_value(leaf) if leaf.cut else level
            return end, exact(leaf.duration_s, "time")
        case Total():
            return level, Fraction(0)
        case _:
            target = level
    if rate is not None:
        return target, abs(target - level) / rate
    assert leaf.duration_s is not None
    return target, exact(leaf.duration_s, "time")


def pieces(leaf: Leaf, level: Fraction, rest: Fraction, tolerance: float = TOLERANCE) -> Iterator[Point]:
    """Yield level and duration of straight pieces, a sine within ``tolerance`` (K or A); a duration of 0 is a step."""
    if isinstance(leaf, Pulse):
        target = _target(leaf, level)
        yield target, Fraction(0)
        yield target, exact(leaf.duration_s, "time")
        yield level, Fraction(0)
    elif isinstance(leaf, Wave):
        size, period = amplitude(leaf) * leaf.sign, exact(leaf.duration_s, "time") / periods_of(leaf)
        for before, point in pairwise(_wave_points(leaf, tolerance)):
            yield level + size * point[1], (point[0] - before[0]) * period
    elif not isinstance(leaf, Total):
        yield advance(leaf, level, rest)


def reach(leaf: Leaf, level: Fraction, rest: Fraction) -> tuple[Fraction, Fraction]:
    """Return the lowest and highest level (°C or A) that a statement comes to, its first level included."""
    if isinstance(leaf, Wave):
        least, most, size = Fraction(-1), Fraction(1), amplitude(leaf) * leaf.sign
        if leaf.cut:
            periods, value = periods_of(leaf), _cut_value(leaf)
            least = least if periods > _TROUGH[leaf.shape] else min(Fraction(0), value)
            most = most if periods > _CREST[leaf.shape] else max(Fraction(0), value)
        ends = level + size * least, level + size * most
        return min(ends), max(ends)
    levels = [level, *(to for to, _ in pieces(leaf, level, rest))]
    return min(levels), max(levels)


def piece_count(leaf: Leaf) -> int:
    """Return how many straight pieces and steps a statement has at most, a sine within `TOLERANCE`."""
    if isinstance(leaf, Wave):
        # Of a sine they grow with the root of the amplitude over the tolerance: in theory 4 · 1.2 / √(12 · ratio) =
        # 1.4 / √ratio a period; counts that grow by eighths make it 1.65 / √ratio and a few.
        sine = math.ceil(2.1 / math.sqrt(_ratio(leaf, TOLERANCE))) + 8
        return math.ceil(periods_of(leaf)) * (sine if leaf.shape == "sine" else len(one_period(leaf.shape, 0.0)))
    return 3 if isinstance(leaf, Pulse) else 1


def amplitude(wave: Wave) -> Fraction:
    """Return the amplitude of a wave, in K or A, exact."""
    return exact(wave.by_K, "difference") if wave.by_K is not None else exact(wave.by_A or 0.0, "current")


def periods_of(wave: Wave) -> Fraction:
    """Return how many periods a wave has; a whole number unless it is cut."""
    periods = exact(wave.duration_s, "time") / exact(wave.period_s, "time")
    return periods if wave.cut else Fraction(max(1, round(periods)))


def whole_periods(wave: Wave) -> bool:
    """Tell whether the duration of a wave holds whole periods, to one part in 10^9."""
    periods = exact(wave.duration_s, "time") / exact(wave.period_s, "time")
    return round(periods) > 0 and abs(periods - round(periods)) <= periods / _FINE


@lru_cache(maxsize=256)
def one_period(shape: Shape, ratio: float) -> tuple[Point, ...]:
    """Phase (0–1) and value (±1) of the corners of a rising period; ``ratio`` is a sine's tolerance over amplitude."""
    half, quarter, one, zero = Fraction(1, 2), Fraction(1, 4), Fraction(1), Fraction(0)
    if shape == "triangle":
        return (zero, zero), (quarter, one), (3 * quarter, -one), (one, zero)
    if shape == "sawtooth":
        return (zero, zero), (half, one), (half, -one), (one, zero)
    if shape == "square":
        return (zero, zero), (zero, one), (half, one), (half, -one), (one, -one), (one, zero)
    rising = _quarter_sine(ratio)
    up = [*rising, *((half - phase, value) for phase, value in rising[-2::-1])]
    return (*up, *((phase + half, -value) for phase, value in up[1:]))


def _quarter_sine(ratio: float) -> list[Point]:
    """Corners from 0 to the peak, closer where the curve bends more; those between lie half a tolerance outside."""
    count = 1
    while True:
        phases = _bends(count)
        values = [math.sin(phase) + (ratio / 2 if 0 < n < count else 0.0) for n, phase in enumerate(phases)]
        values = [min(value, 1.0) for value in values]
        if _worst(phases, values) <= ratio or count >= _MOST_CORNERS:
            break
        count += max(1, count // 8)
    return [
        (Fraction(round(phase / (2 * math.pi) * _FINE), _FINE), Fraction(round(value * _FINE), _FINE))
        for phase, value in zip(phases, values, strict=True)
    ]


def _bends(count: int) -> list[float]:
    """Phases from 0 to π/2 that cut the integral of √sin, and with it the error of chords, into equal parts."""
    sums = _root_sums()
    grid, total = len(sums) - 1, sums[-1]
    found, place = [], 0
    for n in range(count + 1):
        wanted = total * n / count
        while place < grid - 1 and sums[place + 1] < wanted:
            place += 1
        found.append((place + (wanted - sums[place]) / (sums[place + 1] - sums[place])) / grid * math.pi / 2)
    return [0.0, *found[1:-1], math.pi / 2]


def _root_sums() -> list[float]:
    """The integral of √sin from 0 to π/2, summed up on a grid."""
    grid = 512
    return [0.0, *accumulate(math.sqrt(math.sin((n + 0.5) / grid * math.pi / 2)) for n in range(grid))]


def _worst(phases: list[float], values: list[float]) -> float:
    """Largest distance between chords and sine: at a chord's ends, or where the sine runs parallel to it."""
    worst = 0.0
    for (a, low), (b, high) in pairwise(zip(phases, values, strict=True)):
        slope = (high - low) / (b - a)
        touch = min(max(math.acos(min(max(slope, -1.0), 1.0)), a), b)
        worst = max(worst, *(abs(low + slope * (x - a) - math.sin(x)) for x in (a, touch, b)))
    return worst


def _wave_points(wave: Wave, tolerance: float) -> Iterator[Point]:
    """Yield periods passed and value (±1) of the corners of a wave that starts upwards."""
    unit, periods = one_period(wave.shape, _ratio(wave, tolerance)), periods_of(wave)
    cut = wave.cut and periods.denominator > 1
    yield unit[0]
    for n in range(math.ceil(periods)):
        for phase, value in unit[1:]:
            if n + phase >= periods and cut:
                yield periods, _cut_value(wave)
                return
            yield n + phase, value


def _cut_value(wave: Wave) -> Fraction:
    """Value (±1) at which a wave that starts upwards is cut: 0 behind whole periods, of which nothing is cut."""
    periods = periods_of(wave)
    if periods.denominator == 1:
        return Fraction(0)
    phase = periods - math.ceil(periods) + 1
    if wave.shape == "sine":
        return Fraction(round(math.sin(2 * math.pi * float(phase)) * _FINE), _FINE)
    for (a, low), (b, high) in pairwise(one_period(wave.shape, 0.0)):
        if a < phase <= b:
            return low + (high - low) * (phase - a) / (b - a)
    return Fraction(0)


def _ratio(wave: Wave, tolerance: float) -> float:
    return tolerance / float(amplitude(wave))


def _target(leaf: Ramp | Step | Pulse, level: Fraction) -> Fraction:
    sign = -1 if leaf.direction == "cool" else 1
    if leaf.by_K is not None:
        return level + sign * exact(leaf.by_K, "change")
    if not isinstance(leaf, Ramp) and leaf.by_A is not None:
        return level + exact(leaf.by_A, "current")
    if not isinstance(leaf, Pulse) and leaf.to_C is not None:
        return exact(leaf.to_C, "absolute")
    assert isinstance(leaf, Step)
    assert leaf.to_A is not None
    return exact(leaf.to_A, "current")
