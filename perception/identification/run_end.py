"""When the run of a set ends: after its longest icon, and a tail in which people may still report it."""

from __future__ import annotations

import math
from collections.abc import Iterable

TAIL_S, RATE_HZ = 10.0, 100.0
"""Time after the longest icon, s, and rows of a run a second, as in `rank`."""


def run_end_s(durations_s: Iterable[float], rate_Hz: float = RATE_HZ) -> float:
    """End of a run of icons that last so long: `TAIL_S` after the longest, on a whole row, s.

    >>> run_end_s([4.0, 2.5])
    14.0
    """
    return math.ceil((max(durations_s) + TAIL_S) * rate_Hz - 1e-6) / rate_Hz
