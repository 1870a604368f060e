"""The fewest straight lines, joined end to end, that pass through a row of gates, one at each time of a recording."""

from collections.abc import Sequence

Line = tuple[float, float, float]
"""A straight line: a time, its value there, its slope."""


def fewest_links(
    time: Sequence[float], low: Sequence[float], high: Sequence[float], most: int
) -> tuple[list[float], list[float]] | None:
    """Return times and values of the corners of a polyline within ``low`` to ``high`` at each of the rising ``time``.

    No polyline has fewer corners (Suri's windows, for gates). None when it takes more than ``most`` straight pieces.

    >>> fewest_links([0, 1, 2, 3, 4], [0, 0, 0, 1, 2], [0, 0, 0, 1, 2], 9)
    ([0, 2.0, 4], [0.0, 0.0, 2.0])
    """
    lines: list[Line] = []
    windows: list[tuple[float, float]] = []
    stretch, first, side = 0, 0, 0
    while first < len(time):
        if len(lines) >= most:
            return None
        # Every path that comes further must cross the extreme line of this link between its last touch and the gate
        # it misses: there the next link begins, bounded until the gate on one side only.
        line, touch, stop, side = _farthest(time, low, high, stretch, first, side)
        lines.append(line)
        windows.append((time[touch], time[min(stop, len(time) - 1)]))
        stretch, first = touch, stop
    times = [time[0]]
    for (start, end), one, other in zip(windows, lines, lines[1:], strict=False):
        times.append(min(max(_crossing(one, other), start), end))
    values = [_at(line, at) for line, at in zip(lines, times, strict=True)]
    return [*times, time[-1]], [*values, _at(lines[-1], time[-1])]


def _farthest(
    time: Sequence[float], low: Sequence[float], high: Sequence[float], stretch: int, first: int, side: int
) -> tuple[Line, int, int, int]:
    """Return the line that comes nearest to the first gate which no line reaches, its last touch, that gate, its side.

    Lines pass the gates from ``first``; from ``stretch`` to there they stay below ``high`` (side 1) or above ``low``
    (side -1). Amortised constant time a gate: hulls of the bounds lose points as lines turn (O'Rourke 1981).
    """
    roof, floor = _Hull(1), _Hull(-1)
    for k in range(stretch, first):
        if side > 0:
            roof.add(time[k], high[k])
        else:
            floor.add(time[k], low[k])
    # The line that falls most and the one that rises most; each rests on one hull and touches the last gate it met.
    fall: Line | None = None
    rise: Line | None = None
    touch_fall = touch_rise = first
    for k in range(first, len(time)):
        t, bottom, top = time[k], low[k], high[k]
        if rise is not None and bottom > _at(rise, t):
            return rise, touch_rise, k, 1
        if fall is not None and top < _at(fall, t):
            return fall, touch_fall, k, -1
        if roof.points and (fall is None or bottom > _at(fall, t)):
            fall, touch_fall = (t, bottom, roof.tangent(t, bottom)), k
        if floor.points and (rise is None or top < _at(rise, t)):
            rise, touch_rise = (t, top, floor.tangent(t, top)), k
        roof.add(t, top)
        floor.add(t, bottom)
    end = time[-1]
    if fall is None or rise is None:
        line = fall or rise or (end, (low[-1] + high[-1]) / 2, 0.0)
    else:
        line = (end, (_at(fall, end) + _at(rise, end)) / 2, (fall[2] + rise[2]) / 2)
    return line, len(time) - 1, len(time), 0


class _Hull:
    """The convex hull, from below (sign 1) or above (-1), of bounds in the order of time; points used up drop out."""

    __slots__ = ("points", "sign", "start")

    def __init__(self, sign: int) -> None:
        self.points: list[tuple[float, float]] = []
        self.sign, self.start = sign, 0

    def add(self, t: float, y: float) -> None:
        points, sign = self.points, self.sign
        while len(points) - self.start > 1:
            (t0, y0), (t1, y1) = points[-2], points[-1]
            if sign * ((y1 - y0) * (t - t1) - (y - y1) * (t1 - t0)) < 0:
                break
            points.pop()
        points.append((t, y))

    def tangent(self, t: float, y: float) -> float:
        """Slope of the line through a point to the right that rests on the hull; lines to come rest further right."""
        points, sign, at = self.points, self.sign, self.start
        slope = (y - points[at][1]) / (t - points[at][0])
        while at + 1 < len(points):
            further = (y - points[at + 1][1]) / (t - points[at + 1][0])
            if sign * further < sign * slope:
                break
            at, slope = at + 1, further
        self.start = at
        return slope


def _at(line: Line, t: float) -> float:
    return line[1] + line[2] * (t - line[0])


def _crossing(one: Line, other: Line) -> float:
    turn = other[2] - one[2]
    return (one[1] - other[1] + other[2] * other[0] - one[2] * one[0]) / turn if turn else one[0]
