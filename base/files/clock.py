"""Times of a table's rows in seconds from the stamps of a logger's clock."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

ELAPSED = re.compile(r"(\d+)(?: days? \+?|:(?=\d\d:\d\d:))(\d\d:\d\d:\d\d(?:\.\d+)?)")
"""Days and a time of day, as pandas and cameras write them."""
STARTED_AGAIN = "the clock starts again here: give each recording its own file"
DAY_S, HOUR_S, LONGEST_STAMP = 86_400.0, 3600.0, 60


def seconds_of(cells: Sequence[str]) -> Array | None:
    """Seconds (rows,) from the first of times of day, with or without dates, day or month first; None where it is none.

    Past midnight without a date, and past the full hour where a spreadsheet cut the hours off, the time goes on.

    >>> seconds_of(["23:59:58.5", "00:00:01,5"]).tolist(), seconds_of(["59:59.5", "00:00.5"]).tolist()
    ([0.0, 3.0], [0.0, 1.0])
    """
    import numpy as np
    import pandas as pd

    cut = re.fullmatch(r"\d+:\d\d[.,]\d+", cells[0]) is not None
    bare = [re.sub(r"^(\d\d[A-Za-z]{3}\d{4}):", r"\1 ", cell.strip("[]() ")) for cell in cells]
    plain = [re.sub(r"[,:](\d{3,6})(?=\D*$)", r".\1", f"0:{cell}" if cut else cell) for cell in bare]
    if all(map(ELAPSED.fullmatch, plain)):
        spans = pd.to_timedelta(pd.Series([ELAPSED.sub(r"\1 days \2", cell) for cell in plain]))
        return np.asarray((spans - spans.iloc[0]).dt.total_seconds(), dtype=np.float64)
    found: list[Array] = []
    for day_first in (False, True) if max(map(len, cells)) <= LONGEST_STAMP else ():
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                times = pd.to_datetime(pd.Series(plain), dayfirst=day_first)
            found.append(np.asarray((times - times.iloc[0]).dt.total_seconds(), dtype=np.float64))
        except (ValueError, OverflowError, TypeError, AttributeError):
            continue
    if not found:
        return None
    time = min(found, key=np.ptp)
    wrap = HOUR_S if cut else DAY_S
    return np.asarray(time + wrap * np.cumsum(np.diff(time, prepend=0.0) < -0.5 * wrap))


def spread(time: Array, steps: bool) -> tuple[Array, int] | None:
    """Times whose equal stamps, of a clock with too few digits, are spread evenly until the next; and how many rows.

    The first and the last stamp may be seen in part, so that their rows are as far apart as others; None where no
    stamp is seen whole. With ``steps``, two readings at one time are a step, and stay.
    """
    import numpy as np

    starts = np.flatnonzero(np.diff(time, prepend=-np.inf) != 0)
    counts = np.diff(starts, append=len(time))
    if counts.max() <= 1 + steps and len(starts) > 1:
        return time, 0
    if len(starts) < 3:
        return None
    stamps = time[starts]
    apart = np.append(np.diff(stamps), 0.0) / counts
    apart[[0, -1]] = np.minimum(np.median(apart[1:-1]), [apart[0], np.inf])
    stamps[0] = stamps[1] - counts[0] * apart[0]
    place = np.arange(len(time)) - np.repeat(starts, counts)
    return np.repeat(stamps, counts) + place * np.repeat(apart, counts), len(time) - len(starts)


def order_fault(time: Array) -> tuple[int, str] | None:
    """The first row whose time falls, and what helps against its cause; None where times do not fall."""
    import numpy as np

    falls = np.flatnonzero(np.diff(time) < 0) + 1
    if not falls.size:
        return None
    at = int(falls[0])
    if falls.size == 1 and time[at + 1 : at + 2].max(initial=-np.inf) >= time[at - 1]:
        return at, "this row is out of place: remove it"
    if falls.size == 1 and (at == 1 or time[at] >= time[at - 2]):
        return at, "the row before is out of place: remove it"
    if np.diff(falls, prepend=0, append=len(time)).min() > 1 and falls.size <= 0.1 * len(time):
        return at, STARTED_AGAIN
    mixed = "are mixed" if falls.size < len(time) - 1 else "run backward"
    return at, f"the rows {mixed}: sort them by time"
