"""What a drawn curve is made of, in plots and in pictures: directions of its pieces, ticks, members chosen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

from ..number_text import signed

if TYPE_CHECKING:
    from ..model.corners import Corners

Direction = Literal["cool", "warm", "stay"]
Points = Sequence[tuple[float, float]]

# Dark blue and light orange stay apart in grey and for all common kinds of colour vision.
COOL, WARM, STAY = "#2166ac", "#f1a340", "#4d4d4d"
COLOURS: dict[Direction, str] = {"stay": STAY, "cool": COOL, "warm": WARM}


def directions(corners: Corners) -> list[Direction]:
    """Return, for every straight piece, whether it cools, warms or stays; under control current, more current cools.

    >>> from thermicon.icons.model.corners import Corners
    >>> directions(Corners((0.0, 2.0, 6.0), (32.0, 26.0, 26.0), "temperature_C"))
    ['cool', 'stay']
    """
    down: Direction = "cool" if corners.quantity == "temperature_C" else "warm"
    up: Direction = "warm" if down == "cool" else "cool"
    return ["stay" if b == a else down if b < a else up for a, b in pairwise(corners.value)]


def evenly(count: int, most: int) -> list[int]:
    """Return at most ``most`` places out of ``count``, evenly apart, the first and the last among them.

    >>> evenly(10, 4), evenly(3, 4)
    ([0, 3, 6, 9], [0, 1, 2])
    """
    if count <= most:
        return list(range(count))
    return sorted({round(n * (count - 1) / (most - 1)) for n in range(most)})


def envelope(corners: Corners, columns: int) -> list[tuple[float, float, float]]:
    """Return time (s), lowest and highest value in each of ``columns`` equal parts of the duration.

    It stands for a curve that has more pieces than a picture has room for.
    """
    found = []
    place = 0
    before = corners.value[0]
    for n in range(columns):
        end = corners.duration_s * (n + 1) / columns
        after = corners.at(end)
        low, high = min(before, after), max(before, after)
        while place < len(corners) and corners.time_s[place] <= end:
            low, high = min(low, corners.value[place]), max(high, corners.value[place])
            place += 1
        found.append((end - corners.duration_s / columns / 2, low, high))
        before = after
    return found


def chosen(sizes: Sequence[int], most: int) -> list[int]:
    """Return at most ``most`` places among all combinations of as many values: the corners first, then evenly apart.

    Corners, where each value is the first or the last, are what a family's extremes mostly are.

    >>> chosen((3, 3), 6), chosen((2, 2), 6)
    ([0, 2, 3, 5, 6, 8], [0, 1, 2, 3])
    """
    count = math.prod(sizes)
    corners = {0, count - 1}
    if count > most >= 2 ** len(sizes):
        corners = {0}
        for size in sizes:
            corners = {place * size + end for place in corners for end in (0, size - 1)}
    places = evenly(count, most if count <= most else max(2, most - len(corners) + 2))
    return sorted({*corners, *places}) if count > 1 else [0]


def ticks(duration_s: float, most: int) -> list[float]:
    """Return round times (s) from 0, and the duration as the last; evenly apart where that can be.

    >>> ticks(12, 5), ticks(5.5, 5)
    ([0.0, 3.0, 6.0, 9.0, 12], [0.0, 2.0, 4.0, 5.5])
    """
    rough = duration_s / most
    unit = 10.0 ** math.floor(math.log10(rough))
    sizes = [unit * size for size in (1, 2, 2.5, 3, 4, 5, 10) if unit * size >= rough * 0.999]
    even = [size for size in sizes if duration_s / size >= 2.9 and abs(duration_s / size % 1) < 1e-9]
    step = even[0] if even else next(unit * size for size in (1, 2, 5, 10) if unit * size >= rough * 0.999)
    count = math.ceil(duration_s / step - 0.25)
    return [*(float(f"{step * n:.6g}") for n in range(count)), duration_s]


def shown(value: float) -> str:
    """Return a number for people: at most four digits, a true minus sign.

    >>> shown(32.0), shown(-0.1), shown(5.123456)
    ('32', '−0.1', '5.123')
    """
    return signed(value, ".4g")


def icon_count(count: int) -> str:
    """Return a number of icons for people.

    >>> icon_count(1), icon_count(1000)
    ('1 icon', '1,000 icons')
    """
    return f"{count:,} icon{'' if count == 1 else 's'}"


def spread(low: float, high: float, unit: str) -> str:
    """Return a span of values with their unit, or the one value.

    >>> spread(8, 10, "s"), spread(8, 8, "s"), spread(-2, 2, "A")
    ('8–10 s', '8 s', '−2 to 2 A')
    """
    if low == high:
        return f"{shown(low)} {unit}"
    between = " to " if low < 0 else "–"
    return f"{shown(low)}{between}{shown(high)} {unit}"
