"""Compiled crossing: the log probability that noisy sensation has stayed below a criterion until each time.

Noise of unit SD and autocorrelation e^(−t²/2τ²) is added to a sensation ψ that rises at the rate r. The criterion c
that has not been passed yet is passed, per unit of time, at Rice's rate over the probability of being below it:

    (φ(z) + z·Φ(z))/τ · φ(g)/Φ(g),   z = r·τ,   g = c − ψ

A drive that is g times as large has the sensation a·ln(1 + g^p·(e^(ψ/a) − 1)). Rankings read reports of it (`reports`),
experiments the times at which shares of trials have passed, and how often the noise of another channel passes first.
"""

import math
from typing import Any

import numpy as np

from thermicon.base.numbers.compiled import kernel
from thermicon.base.numbers.vector_math import log1p

SQRT_HALF = math.sqrt(0.5)
INV_SQRT_2PI = 1.0 / math.sqrt(2.0 * math.pi)


def _cumulative(x: float) -> float:
    return 0.5 * math.erfc(-x * SQRT_HALF)


def _survive(
    risen: Any, raised: float, a: float, begin: int, end: int, steps: Any, criterion: float, tau: float,
    at_start: float, alone: float, certain: float, room: Any, log_left: Any,
) -> None:  # fmt: skip
    """Fill the log probability (n_time,) that a sensation, `at_start` subtracted, has not passed the criterion yet.

    `risen` (n_time,) is e^(ψ/a) − 1 of a sensation that matters from the sample `begin` to `end`, `raised` how much
    larger its drive is, `steps` (n_time,) the times in s since the sample before. `log_left[0]` is what it starts from.
    `alone` is the share of the crossings of noise alone that is left out: 1 makes it relative to no change at all. What
    comes after it is `certain` that the criterion was passed is not computed; it is asked after every n samples, which
    go through the processor's vectors in `room` (2, n + 1).
    """
    silent = RISE[Z_MIDDLE] / tau * between(MILLS, (criterion - GAP_FROM) / GAP_STEP)
    left, psi, fall, at_once = log_left[0], room[0], room[1], room.shape[1] - 1
    log_left[:begin] = left
    last = abs(a * log1p(raised * risen[begin - 1]) - at_start)
    for start in range(begin, end, at_once):
        count = min(at_once, end - start)
        own, step, now, before = risen[start : start + count], steps[start : start + count], psi[1:], psi
        before[0] = last
        for i in range(count):
            now[i] = abs(a * log1p(raised * own[i]) - at_start)
        for i in range(count):
            z = (now[i] - before[i]) * (tau / step[i])
            fall[i] = max(between(RISE, (z - Z_FROM) / Z_STEP), z)
        for i in range(count):
            twice = now[i] + before[i]
            rate = fall[i] / tau * between(MILLS, (criterion - 0.5 * twice - GAP_FROM) / GAP_STEP)
            fall[i] = step[i] * ((rate if twice > 0.0 else silent) - alone * silent)
        last = psi[count]
        for i in range(count):
            left -= fall[i]
            log_left[start + i] = left
            if left < certain:
                log_left[start + i :] = left
                return
    log_left[end:] = left


def _passage(risen: Any, time: Any, raised: Any, a: float, criterion: Any, tau: float, shares: Any, times: Any) -> Any:
    """Times (lanes, shares) in s at which these shares of trials have passed the criterion; inf where they never do.

    A lane is a person and a size of gain: `raised` (lanes,) is the gain to the power p, `criterion` (lanes,) in d′.
    `risen` (n_time,) is that of gain 1 at `time` (n_time,) in s, in steps of any size. Noise alone passes too. Returns
    the probability (lanes,) of having passed by the end.
    """
    lanes, samples = raised.size, risen.size
    passed, targets, steps = np.empty(lanes), np.log(1.0 - shares), np.empty(samples)
    logs, room = np.empty(samples), np.empty((2, SAMPLES_AT_ONCE + 1))
    for t in range(1, samples):
        steps[t] = time[t] - time[t - 1]
    for lane in range(lanes):
        c, begin = criterion[lane], 1
        # As long as the criterion is out of reach, nothing happens.
        reach = math.expm1(max(c - OUT_OF_REACH, 0.0) / a) / raised[lane]
        while begin < samples - 1 and risen[begin] < reach:
            begin += 1
        logs[0] = math.log(cumulative(c))
        survive(risen, raised[lane], a, begin, samples, steps, c, tau, 0.0, 0.0, SURE, room, logs)
        passed[lane] = 1.0 - math.exp(logs[samples - 1])
        for k in range(shares.size):
            t = first_below(logs, targets[k], samples - 1)
            if logs[t] > targets[k]:
                times[lane, k] = np.inf
            elif t == 0:
                times[lane, k] = 0.0
            else:
                times[lane, k] = time[t - 1] + (logs[t - 1] - targets[k]) / (logs[t - 1] - logs[t]) * steps[t]
    return passed


def _outrun(
    risen: Any, time: Any, raised: Any, a: float, criterion: Any, tau: float, other: Any, moments: Any, place: Any,
    wrong: Any,
) -> None:  # fmt: skip
    """Fill the share (lanes,) of trials that the noise of another channel, with the criterion `other`, decides.

    That noise counts from the same start; what passes at a moment arrives together with the sample `place` (moments,)
    of the channel that rises. Who has not answered by the end guesses.
    """
    samples = time.size
    steps, logs, room = np.empty(samples), np.empty(samples), np.empty((2, SAMPLES_AT_ONCE + 1))
    steps[1:] = time[1:] - time[:-1]
    for lane in range(raised.size):
        c, o = criterion[lane], other[lane]
        logs[0] = math.log(cumulative(c))
        survive(risen, raised[lane], a, 1, samples, steps, c, tau, 0.0, 0.0, SURE, room, logs)
        rate = RISE[Z_MIDDLE] / tau * between(MILLS, (o - GAP_FROM) / GAP_STEP)
        below = quiet = cumulative(o)
        share, before, seldom = 0.0, 0.0, 1.0 - below + rate * time[samples - 1] < SELDOM
        for t in range(moments.size):
            log_left = between(logs, place[t])
            decided = math.exp(log_left)
            still = below * math.exp(-rate * moments[t])
            share += (1.0 - below) * decided if t == 0 else 0.5 * (quiet - still) * (decided + before)
            quiet, before = still, decided
            if log_left < SURE or seldom:
                break
        wrong[lane] = share + (0.5 * quiet * math.exp(logs[samples - 1]) if logs[samples - 1] > SURE else 0.0)


def _first_below_index(falling: Any, level: float, end: int) -> int:
    """Index of the first number of a falling column that is at or below a level; `end` where none is."""
    low, high = 0, end
    while low < high:
        middle = (low + high) // 2
        if falling[middle] <= level:
            high = middle
        else:
            low = middle + 1
    return low


def _between(table: Any, place: float) -> float:
    """A table at a place between its entries, without branches: what lies outside counts as its end."""
    within = min(max(place, 0.0), table.size - 1.000001)
    k = np.uint32(np.int32(within))
    return float(table[k] + (within - k) * (table[k + np.uint32(1)] - table[k]))


SAMPLES_AT_ONCE = 16
"""Samples of a passage, of which there are few, between two looks at whether it is certain."""
GAP_FROM, GAP_STEP, GAP_POINTS = -6.0, 0.01, 1401
Z_FROM, Z_STEP, Z_TO = -4.0, 0.01, 4.0
Z_MIDDLE = 400
CERTAIN = -16.0
SELDOM = 1e-6
"""Share of trials that noise decides, so small that it is not computed."""
OUT_OF_REACH = 5.0
"""Gap in d′ above which a criterion is passed less than once in a day."""
SURE = -5.0
"""Log probabilities of not having answered below which an answer is certain: of one course, and of one lane."""


def _mills_table() -> Any:
    """φ(g)/(√(2π)·Φ(g)) over the gap g between criterion and sensation: Rice's rate over being below."""
    gaps = GAP_FROM + GAP_STEP * np.arange(GAP_POINTS)
    below = np.array([0.5 * math.erfc(-gap / math.sqrt(2.0)) for gap in gaps.tolist()])
    return INV_SQRT_2PI * np.exp(-0.5 * gaps * gaps) / below


def _rise_table() -> Any:
    """φ(z) + z·Φ(z): the mean of the rising part of a Gaussian slope with mean z and SD 1."""
    z = np.arange(Z_FROM, Z_TO + 2 * Z_STEP, Z_STEP)
    below = np.array([0.5 * math.erfc(-each / math.sqrt(2.0)) for each in z.tolist()])
    return INV_SQRT_2PI * np.exp(-0.5 * z * z) + z * below


MILLS, RISE = _mills_table(), _rise_table()


_compile: Any = kernel(nogil=True, error_model="numpy")
_vector: Any = kernel(
    nogil=True, error_model="numpy", fastmath={"reassoc", "nsz", "contract", "arcp"}, forceinline=True
)
cumulative: Any = _compile(_cumulative)
between: Any = _vector(_between)
first_below: Any = _compile(_first_below_index)
survive: Any = _vector(_survive)
passage: Any = _vector(_passage)
outrun: Any = _vector(_outrun)
