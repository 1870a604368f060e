"""Compiled alignment of sequences of episodes.

    D[i, j] = min(D[i−1, j] + g_i², D[i, j−1] + g_j², D[i−1, j−1] + m_ij² where the qualities agree),  d′ = √D[n, m]
    m² = max(ΔI²/(σ_I² + s²) + (ΔR² + ΔW² + ΔP²)/σ_T², Δg²),   g = min(max(I − I_on, 0)/√(σ_I² + s²), r)

with intensity I, rate R, length W, pause P of an episode, the noise s of its sensation, and its rise r in d′. Without
Δg² a faint episode could be missed and then taken for a strong one, for less than a strong one is missed.
"""

import math
from typing import Any

import numpy as np

from thermicon.base.numbers.compiled import kernel

from .episodes import CUT, INTENSITY, LENGTH, NOISE, ONSET, PAUSE, QUALITY, RATE, RISE

SAME = 1e-12
"""Sums of costs that differ by less, as a share or in d′², differ by their order alone."""
SHARES = 5
MISSING, BY_INTENSITY, BY_RATE, BY_LENGTH, BY_PAUSE = range(SHARES)
"""Places of the parts of d′²: episodes without a partner, and the features of those with one."""


def _unmatched(x: Any, intensity: Any) -> float:
    above = max(x[INTENSITY] - x[ONSET], 0.0)
    sd = intensity[int(x[QUALITY])]
    return float(min(above / math.sqrt(sd * sd + x[NOISE] * x[NOISE]), x[RISE]))


def _matched(x: Any, y: Any, intensity: Any, timing: float, parts: Any) -> float:
    """m² of two episodes of one quality, its parts in `parts` (SHARES,); of Δg² the excess counts as intensity."""
    sd = intensity[int(x[QUALITY])]
    noise = sd * sd + 0.5 * (x[NOISE] * x[NOISE] + y[NOISE] * y[NOISE])
    parts[MISSING] = 0.0
    parts[BY_INTENSITY] = (x[INTENSITY] - y[INTENSITY]) ** 2 / noise
    parts[BY_RATE] = ((x[RATE] - y[RATE]) / timing) ** 2
    whole = x[CUT] == 0.0 and y[CUT] == 0.0  # the length of an episode that the end cuts is the tail's
    parts[BY_LENGTH] = ((x[LENGTH] - y[LENGTH]) / timing) ** 2 if whole else 0.0
    parts[BY_PAUSE] = ((x[PAUSE] - y[PAUSE]) / timing) ** 2
    # Not parts.sum(): that part of numba imports scipy.linalg, for a fifth of a second.
    square = parts[BY_INTENSITY] + parts[BY_RATE] + parts[BY_LENGTH] + parts[BY_PAUSE]
    excess = max((unmatched(x, intensity) - unmatched(y, intensity)) ** 2 - square, 0.0)
    parts[BY_INTENSITY] += excess
    return float(square + excess)


def _put(place: Any, values: Any) -> None:
    """Copy one element after another: numba compiles a slice as target for a second, for the text of its errors."""
    for k in range(values.size):
        place[k] = values[k]


def _aligned(one: Any, ones: int, two: Any, twos: int, intensity: Any, timing: float, shares: Any) -> float:
    """d′² between two sequences at the least cost, in order; `shares` (SHARES,) gets its parts."""
    cost = np.zeros((ones + 1, twos + 1))
    parts = np.zeros((ones + 1, twos + 1, SHARES))
    own = np.empty(SHARES)
    for i in range(ones + 1):
        for j in range(twos + 1):
            if i == 0 and j == 0:
                continue
            best = math.inf
            if i > 0:
                lone = unmatched(one[i - 1], intensity) ** 2
                best = cost[i - 1, j] + lone
                put(parts[i, j], parts[i - 1, j])
                parts[i, j, MISSING] += lone
            if j > 0:
                lone = unmatched(two[j - 1], intensity) ** 2
                if cost[i, j - 1] + lone < best:
                    best = cost[i, j - 1] + lone
                    put(parts[i, j], parts[i, j - 1])
                    parts[i, j, MISSING] += lone
            if i > 0 and j > 0 and one[i - 1][QUALITY] == two[j - 1][QUALITY]:
                pair = matched(one[i - 1], two[j - 1], intensity, timing, own)
                if cost[i - 1, j - 1] + pair < best:
                    best = cost[i - 1, j - 1] + pair
                    put(parts[i, j], parts[i - 1, j - 1])
                    for k in range(SHARES):
                        parts[i, j, k] += own[k]
            cost[i, j] = best
    put(shares, parts[ones, twos])
    return float(cost[ones, twos])


def _of_pair(one: Any, a: int, i: int, two: Any, b: int, j: int, intensity: Any, timing: float) -> float:
    """m² of episode i of icon a in `one` and j of b in `two`, of one quality, without Δg²."""
    sd = intensity[int(one[a, i, QUALITY])]
    square = (one[a, i, RATE] - two[b, j, RATE]) ** 2 + (one[a, i, PAUSE] - two[b, j, PAUSE]) ** 2
    if one[a, i, CUT] == 0.0 and two[b, j, CUT] == 0.0:
        square += (one[a, i, LENGTH] - two[b, j, LENGTH]) ** 2
    noise = sd * sd + 0.5 * (one[a, i, NOISE] * one[a, i, NOISE] + two[b, j, NOISE] * two[b, j, NOISE])
    return float((one[a, i, INTENSITY] - two[b, j, INTENSITY]) ** 2 / noise + square / (timing * timing))


def _least_cost(
    one: Any, a: int, ones: int, alone: Any, c: float, two: Any, b: int, twos: int, missing: Any, sd: Any,
    timing: float, cost: Any,
) -> float:  # fmt: skip
    """d′² between icon a of `one` and b of `two` (icons, room, FEATURES) by g of their episodes, (icons, room).

    Those of `one` cost `c` more; `cost` (room + 1,) is for use. Places instead of slices: half of the time.
    """
    cost[0] = 0.0
    for j in range(twos):
        cost[j + 1] = cost[j] + missing[b, j] * missing[b, j]
    for i in range(ones):
        lone = alone[a, i] * alone[a, i] + c
        before, cost[0] = cost[0], cost[0] + lone
        for j in range(twos):
            best = min(cost[j + 1] + lone, cost[j] + missing[b, j] * missing[b, j])
            if one[a, i, QUALITY] == two[b, j, QUALITY]:
                off = alone[a, i] - missing[b, j]
                best = min(best, before + max(of_pair(one, a, i, two, b, j, sd, timing), off * off))
            before, cost[j + 1] = cost[j + 1], best
    return float(cost[twos])


def _distances(
    one: Any, ones: Any, two: Any, twos: Any, same: bool, intensity: Any, timing: Any, apart: Any
) -> None:  # fmt: skip
    """d′ (people, n, m) from every icon of `one` to every icon of `two`; noises are (people, 2) and (people,).

    Where both are the `same`, each pair is compared once.
    """
    alone, missing = np.empty(one.shape[1:3]), np.empty(two.shape[1:3])
    cost = np.empty(two.shape[2] + 1)
    for person in range(apart.shape[0]):
        sd, own, other = intensity[person], one[person], two[person]
        for i in range(apart.shape[1]):
            for k in range(ones[person, i]):
                alone[i, k] = unmatched(one[person, i, k], sd)
        for j in range(apart.shape[2]):
            for k in range(twos[person, j]):
                missing[j, k] = unmatched(two[person, j, k], sd)
        for i in range(apart.shape[1]):
            for j in range(i + 1 if same else 0, apart.shape[2]):
                square = least_cost(
                    own, i, ones[person, i], alone, 0.0, other, j, twos[person, j], missing, sd, timing[person], cost
                )
                apart[person, i, j] = math.sqrt(square)
                if same:
                    apart[person, j, i] = apart[person, i, j]
            if same:
                apart[person, i, i] = 0.0


def _noisy(x: Any, intensity: Any, timing: float, louder: float, z: Any, now: Any) -> float:
    """Put an episode with its noise, `louder` times standard normal numbers z (4,), into `now`; its g is returned."""
    sd = intensity[int(x[QUALITY])]
    total = math.sqrt(sd * sd + x[NOISE] * x[NOISE])
    put(now, x)
    now[INTENSITY] = x[INTENSITY] + total * louder * z[0]
    now[RATE] = x[RATE] + timing * louder * z[1]
    now[LENGTH] = x[LENGTH] + timing * louder * z[2]
    now[PAUSE] = x[PAUSE] + timing * louder * z[3]
    return float(max(min((x[INTENSITY] - x[ONSET]) / total, x[RISE]) + louder * z[0], 0.0))


def _name(
    felt: Any, counts: Any, intensity: Any, timing: float, louder: Any, c: float, noise: Any, answers: Any
) -> None:
    """Count the names that one person gives: noise on what is felt, the template that costs least.

    `felt` (icons, room, FEATURES), `louder` (icons,) multiplies the noise of an icon, `noise` (most, icons, samples, 4)
    are standard normal; `answers` (icons, icons) is added to. What is felt without a partner costs `c` more than the
    square of its size, since noise is part of it.
    """
    icons = felt.shape[0]
    now, alone, missing = np.empty((1, *felt.shape[1:])), np.empty((1, felt.shape[1])), np.empty(felt.shape[:2])
    cost = np.empty(felt.shape[1] + 1)
    for j in range(icons):
        for k in range(counts[j]):
            missing[j, k] = unmatched(felt[j, k], intensity)
    for i in range(icons):
        for s in range(noise.shape[2]):
            for k in range(counts[i]):
                alone[0, k] = noisy(felt[i, k], intensity, timing, louder[i], noise[k, i, s], now[0, k])
            best, name = math.inf, 0
            for j in range(icons):
                square = least_cost(now, 0, counts[i], alone, c, felt, j, counts[j], missing, intensity, timing, cost)
                if square < best:
                    best, name = square, j
            answers[i, name] += 1.0


def _name_apart(
    felt: Any, counts: Any, played: Any, intensity: Any, timing: float, c: float, noise: Any, answers: Any
) -> None:
    """The same for icons on several surfaces: costs add over surfaces, and names of one cost share an answer.

    `felt` (tracks, room, FEATURES), `played` (surfaces, icons) the track of a surface in an icon, `noise` (surfaces,
    most, icons, samples, 4).
    """
    surfaces, icons = played.shape
    now, alone = np.empty((surfaces, *felt.shape[1:])), np.empty((surfaces, felt.shape[1]))
    missing, cost = np.empty(felt.shape[:2]), np.empty(felt.shape[1] + 1)
    total, known = np.empty(icons), np.empty((surfaces, len(felt)))
    for j in range(len(felt)):
        for k in range(counts[j]):
            missing[j, k] = unmatched(felt[j, k], intensity)
    for i in range(icons):
        for s in range(noise.shape[3]):
            for surface in range(surfaces):
                own = played[surface, i]
                for k in range(counts[own]):
                    alone[surface, k] = noisy(
                        felt[own, k], intensity, timing, 1.0, noise[surface, k, i, s], now[surface, k]
                    )
                for j in range(icons):
                    known[surface, played[surface, j]] = -1.0
            most, ties = math.inf, 0
            for turn in range(icons):
                j, total[turn] = (i + turn) % icons, 0.0  # the own name first: the others are soon dearer
                for surface in range(surfaces):
                    own, other = played[surface, i], played[surface, j]
                    if known[surface, other] < 0.0:  # icons share tracks
                        known[surface, other] = least_cost(
                            now, surface, counts[own], alone, c, felt, other, counts[other], missing, intensity, timing,
                            cost,
                        )  # fmt: skip
                    total[turn] += known[surface, other]
                    if total[turn] > most:
                        break
                most = min(most, total[turn] * (1.0 + SAME) + SAME)
            for turn in range(icons):
                ties += total[turn] <= most
            for turn in range(icons):
                if total[turn] <= most:
                    answers[i, (i + turn) % icons] += 1.0 / ties


_compile: Any = kernel(nogil=True, error_model="numpy")
unmatched: Any = _compile(_unmatched)
matched: Any = _compile(_matched)
put: Any = _compile(_put)
aligned: Any = _compile(_aligned)
of_pair: Any = _compile(_of_pair)
least_cost: Any = _compile(_least_cost)
distances: Any = _compile(_distances)
noisy: Any = _compile(_noisy)
name: Any = _compile(_name)
name_apart: Any = _compile(_name_apart)
