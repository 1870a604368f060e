"""Compiled loops that find the episodes of an icon.

An episode of quality q opens where ψ_q reaches the bar c and is not below the other quality, starts where ψ_q last rose
through c/2, and closes where ψ_q falls below c/2 or below the other quality. Two of one quality with a short gap and
nothing of the other between them are one; one with a valley of ψ that lies c or more below both its peaks is two.
"""

import math
from typing import Any

import numpy as np

from thermicon.base.numbers.compiled import kernel
from thermicon.base.numbers.vector_math import LEAST, exp, expm1, log, vectorised

FEATURES = 10
QUALITY, INTENSITY, RATE, LENGTH, PAUSE, NOISE, CUT, ONSET, START, RISE = range(FEATURES)
"""Columns of an episode: 0 cold or 1 warm; ln u at the peak; ln of the steepest rise of u in 1/s; ln of the time above
half the peak in s; ln of the pause before it; sensory noise of the intensity; 1 where the end of the trace cuts it;
ln u at the bar; start in s; rise of ψ in d′ from the bar, or from the valley at which the episode begins."""
MOST, USUAL = 64, 8
"""Episodes that an icon may have, and as many as there is room for at first."""
MERGED_S, SHORTEST_S, LOOK_BACK_S, PAUSE_FROM_S = 0.3, 0.2, 1.0, 0.5
HALF = 0.5


def _segments(psi: Any, other: Any, dt: float, bar: float, first: Any, last: Any) -> int:
    """Starts and ends (inclusive samples) of stretches of one quality; how many there are."""
    count, n, t = 0, psi.size, 0
    c_off = 0.5 * bar
    while t < n:
        if psi[t] < bar or psi[t] < other[t]:
            t += 1
            continue
        earliest = last[count - 1] + 1 if count > 0 else 0
        start = t
        while start > earliest and psi[start - 1] >= c_off:
            start -= 1
        end = t
        while end + 1 < n and psi[end + 1] >= c_off and psi[end + 1] >= other[end + 1]:
            end += 1
        merged = count > 0 and (start - last[count - 1]) * dt < MERGED_S
        if merged:
            for k in range(last[count - 1] + 1, t):
                if other[k] >= bar:
                    merged = False
        if merged:
            last[count - 1] = end
        else:
            first[count], last[count] = start, end
            count += 1
        t = end + 1
    return count


def _split_at(psi: Any, start: int, end: int, bar: float) -> int:
    """Sample of the deepest minimum that is the bar or more below the peaks before and after it; −1 for none."""
    deepest, place = math.inf, -1
    n = end - start + 1
    after = np.empty(n)
    after[n - 1] = psi[end]
    for k in range(n - 2, -1, -1):
        after[k] = max(after[k + 1], psi[start + k])
    before = psi[start]
    for k in range(1, n - 1):
        before = max(before, psi[start + k])
        if psi[start + k] < deepest and min(before, after[k]) - psi[start + k] >= bar:
            deepest, place = psi[start + k], start + k
    return place


def _episodes(psi_cold: Any, psi_warm: Any, dt: float, bar: float, a: float, p: float, found: Any) -> int:
    """Fill `found` (room, FEATURES) with the first episodes of one icon in the order of their starts.

    Returns how many there are, also where the room does not suffice; u = (b·(e^(ψ/a) − 1))^(1/p) with
    b = 1/(e^(1/a) − 1), and the bar is in d′.
    """
    b = 1.0 / math.expm1(1.0 / a)
    n = psi_cold.size
    first, last, floor = np.empty(n + 1, np.int64), np.empty(n + 1, np.int64), np.empty(n + 1)
    starts, ends, kinds, floors = (
        np.empty(2 * n, np.int64),
        np.empty(2 * n, np.int64),
        np.empty(2 * n, np.int64),
        np.empty(2 * n),
    )
    total = 0
    drives = np.empty((2, n))
    back = int(LOOK_BACK_S / dt)
    for quality in range(2):
        psi = psi_cold if quality == 0 else psi_warm
        other = psi_warm if quality == 0 else psi_cold
        count = segments(psi, other, dt, bar, first, last)
        if count == 0:
            continue
        # u is read where an episode looks back, and not beyond the last; a loop of its own that runs in vectors
        from_, to = max(first[0] - back - 1, 0), last[count - 1] + 1
        given, own = psi[from_:to], drives[quality, from_:to]
        for t in range(given.size):
            own[t] = exp(log(max(b * expm1(given[t] / a), LEAST)) / p)
        floor[:count] = bar
        k = 0
        while k < count:
            place = split_at(psi, first[k], last[k], bar)
            if place >= 0:
                for m in range(count, k + 1, -1):
                    first[m], last[m], floor[m] = first[m - 1], last[m - 1], floor[m - 1]
                first[k + 1], last[k + 1], floor[k + 1] = place + 1, last[k], max(bar, psi[place])
                last[k] = place
                count += 1
            else:
                k += 1
        for k in range(count):
            peak = 0.0
            for t in range(first[k], last[k] + 1):
                peak = max(peak, psi[t])
            if (last[k] - first[k]) * dt >= SHORTEST_S and peak >= bar:
                starts[total], ends[total], kinds[total], floors[total] = first[k], last[k], quality, floor[k]
                total += 1
    order = np.arange(total)
    for k in range(1, total):  # numba takes two seconds to compile its argsort
        e, m = order[k], k
        while m > 0 and starts[order[m - 1]] > starts[e]:
            order[m] = order[m - 1]
            m -= 1
        order[m] = e
    before = 0.0
    for k in range(min(total, found.shape[0])):
        e = order[k]
        u = drives[kinds[e]]
        top = starts[e]
        for t in range(starts[e], ends[e] + 1):
            if u[t] > u[top]:
                top = t
        steepest = 1e-6
        for t in range(max(1, starts[e] - back), top + 1):
            steepest = max(steepest, (u[t] - u[t - 1]) / dt)
        above = 0
        for t in range(starts[e], ends[e] + 1):
            if u[t] >= HALF * u[top]:
                above += 1
        raised = u[top] ** p
        found[k, QUALITY] = kinds[e]
        found[k, INTENSITY] = math.log(u[top])
        found[k, RATE] = math.log(steepest)
        found[k, LENGTH] = math.log(max(above, 1) * dt)
        found[k, PAUSE] = math.log(max(starts[e] * dt - before, 0.0) + PAUSE_FROM_S)
        found[k, NOISE] = (b + raised) / (a * p * raised)
        found[k, CUT] = 1.0 if ends[e] >= n - 1 else 0.0
        found[k, ONSET] = math.log((b * math.expm1(bar / a)) ** (1.0 / p))
        found[k, START] = starts[e] * dt
        found[k, RISE] = (psi_cold if kinds[e] == 0 else psi_warm)[top] - floors[e]
        before = ends[e] * dt
    return total


def _all_episodes(cold: Any, warm: Any, dt: float, bar: float, a: float, p: float, found: Any, counts: Any) -> None:
    """Episodes of all icons of every person; `cold` (people, icons, time)."""
    for person in range(cold.shape[0]):
        for icon in range(cold.shape[1]):
            counts[person, icon] = episodes(cold[person, icon], warm[person, icon], dt, bar, a, p, found[person, icon])


_compile: Any = kernel(nogil=True, error_model="numpy")
segments: Any = _compile(_segments)
split_at: Any = _compile(_split_at)
episodes: Any = vectorised(_episodes)
all_episodes: Any = _compile(_all_episodes)
