"""Times of rows as loggers write them: clocks and dates as seconds, stamps with too few digits, and times that fall."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from datetime import date
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

CLOCK = re.compile(r"(\d{1,2}):(\d{2})(?:[:.](\d{2})(?:[.,:](\d+))?|([.,]\d+))?(?:\s*([AaPp])\.?[Mm]\.?)?")
ZONE = re.compile(r"\s*(?:Z|UTC|GMT|CEST|CET|EST|EDT)?\s*(?:[+-]\d{2}:?\d{2})?\s*$")
MONTHS = {name: at + 1 for at, name in enumerate(re.findall("...", "janfebmaraprmayjunjulaugsepoctnovdec"))}
DAY_S, HOUR_S = 86_400.0, 3600.0
PLAIN_CURE = "write times as seconds from any start, or as 2026-03-02 23:59:58.050"
LEAST_STAMPS = 3
"""Stamps that a clock with too few digits has at least; rows of fewer are of one time."""
PAIRED, SAWTOOTH = 20, -0.75
"""Rows from which readings in pairs may come of such a clock, and correlation of changes below which they are steps."""


def seconds_of(cells: Sequence[str]) -> tuple[list[float], int | None]:
    """Seconds (rows,) from the first midnight of times of day, with or without dates; and the first cell that is none.

    Past midnight without a date, and past the full hour where a spreadsheet cut the hours off, the time goes on.

    >>> seconds_of(["2026-03-02 23:59:58.5", "2026-03-03 00:00:01,5"]), seconds_of(["59:59.5", "00:00.5"])[0]
    (([86398.5, 86401.5], None), [3599.5, 3600.5])
    """
    times, days, wrap = list[float](), list[str](), DAY_S
    for row, cell in enumerate(cells):
        if not (found := CLOCK.search(cell)):
            return [], row
        first, second, third, fraction, cut, half = found.groups()
        if cut:  # minutes and seconds
            wrap, time = HOUR_S, 60.0 * int(first) + float(second + cut.replace(",", "."))
        else:
            hours = int(first) % 12 + 12 * (half in ("p", "P")) if half else int(first)
            time = HOUR_S * hours + 60.0 * int(second) + float(f"{third or 0}.{fraction or 0}")
        times.append(time)
        days.append((cell[: found.start()] + ZONE.sub("", cell[found.end() :])).strip(" T,;"))
    numbers = _days(list(dict.fromkeys(days)))
    if numbers is None:
        return [], 0
    offset, total = 0.0, list[float]()
    for time, day in zip(times, days, strict=True):
        now = time + DAY_S * numbers[day]
        if total and now + offset < total[-1] - 0.5 * wrap and len(numbers) == 1:
            offset += wrap
        total.append(now + offset)
    return total, None


def _days(texts: list[str]) -> dict[str, int] | None:
    """The number of each date from the first, in that order of day, month and year by which they lie closest."""
    parts = [[int(MONTHS.get(word[:3].lower(), word)) for word in re.findall(r"\d+|(?<![a-zA-Z])(?:"
             + "|".join(MONTHS) + r")[a-z]*", text, re.IGNORECASE)] for text in texts]  # fmt: skip
    if all(re.fullmatch(r"|\d+ days?|\d+", text) for text in texts):
        return {text: each[0] if each else 0 for text, each in zip(texts, parts, strict=True)}
    found = list[list[int]]()
    for order in itertools.permutations(range(3)):
        try:
            dates = [[each[at] for at in order] for each in parts]
            found.append([date(y + 2000 * (y < 100), m, d).toordinal() for y, m, d in (each[:3] for each in dates)])
        except (ValueError, IndexError):
            continue
    if not found:
        return None
    best = min(found, key=lambda days: (any(b < a for a, b in itertools.pairwise(days)), max(days) - min(days)))
    return {text: day - best[0] for text, day in zip(texts, best, strict=True)}


def spread(time: Array, values: Sequence[Array], steps: bool) -> tuple[Array, int]:
    """Times whose equal stamps, of a clock with too few digits, are spread evenly until the next; and how many rows.

    With ``steps``, two readings at one time are a step and stay, unless they come of such a clock.
    """
    import numpy as np

    starts = np.flatnonzero(np.diff(time, prepend=-np.inf) != 0)
    counts = np.diff(starts, append=len(time))
    if counts.max(initial=1) == 1 or len(starts) < LEAST_STAMPS or (np.diff(time) < 0).any():
        return time, 0
    if steps and counts.max() == 2 and not _paired(starts, counts, values[0]):
        return time, 0
    stamps = time[starts]
    gap = np.diff(stamps, append=stamps[-1] + np.median(np.diff(stamps)))
    place = np.arange(len(time)) - np.repeat(starts, counts)
    return time + place * np.repeat(gap / counts, counts), int((counts - 1).sum())


def _paired(starts: NDArray[np.intp], counts: NDArray[np.intp], values: Array) -> bool:
    """Whether readings in pairs follow each other as in one course, and do not jump within each pair."""
    import numpy as np

    if len(values) < PAIRED or np.median(counts[1:-1]) < 2:
        return False
    whole = np.flatnonzero((counts[:-1] == 2) & (counts[1:] == 2))
    first = starts[whole]
    within, between = values[first + 1] - values[first], values[first + 2] - values[first + 1]
    size = float(np.sqrt((within**2).sum() * (between**2).sum()))
    return size > 0 and float((within * between).sum()) > SAWTOOTH * size


def order_fault(time: Array) -> tuple[int, str] | None:
    """The first row whose time falls, and what helps against its cause; None where times do not fall."""
    import numpy as np

    falls = np.flatnonzero(np.diff(time) < 0) + 1
    if not falls.size:
        return None
    at = int(falls[0])
    if falls.size == len(time) - 1 and len(time) > 2:
        return at, "the rows run backward: sort them by time"
    if falls.size == 1 and at + 1 < len(time) and time[at + 1] >= time[at - 1]:
        return at, "this row is out of place: remove it"
    if falls.size == 1 and (at == 1 or time[at] >= time[at - 2]):
        return at, "the row before is out of place: remove it"
    pieces = np.diff(falls, prepend=0, append=len(time))
    if pieces.min() > 1 and falls.size <= 0.1 * len(time):
        return at, "the clock starts again here: give each recording its own file"
    return at, "the rows are mixed: sort them by time"
