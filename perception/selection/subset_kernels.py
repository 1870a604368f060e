"""Compiled loops over subsets of a pool: one subset, or all of one size; imported only when something is chosen."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel

from ..arrays import Array


def _valued(correct: float, bits: float, duration_s: float, code: int) -> float:
    """The value of an objective by its code: 1 for correct, 2 for bits, 3 for bits a second."""
    if code == 1:
        return correct
    if code == 2:
        return bits
    return bits / duration_s


def _tally(counts: Any, size: int, draws: int, lapse: float) -> tuple[float, float]:
    """Proportion correct and bits of one person's counts (size, size)."""
    correct = 0.0
    bits = 0.0
    for b in range(size):
        column = 0.0
        for a in range(size):
            column += counts[a, b]
        answered = ((1.0 - lapse) * column / draws + lapse) / size
        correct += (1.0 - lapse) * counts[b, b] / draws + lapse / size
        for a in range(size):
            p = (1.0 - lapse) * counts[a, b] / draws + lapse / size
            if p > 0.0:
                bits += p / size * math.log2(p / answered)
    return correct / size, bits


def _swapped(half: Any, push: Any, lapse: Any, chosen: Any, place: int, others: Any) -> Any:
    """Proportion correct and bits (2, others, people) of a subset with one icon replaced by each of `others`.

    Who is nearest among those that stay is found once, so that each of `others` costs only its own distances.
    """
    people, draws, size = push.shape[0], push.shape[2], chosen.size
    each = np.empty((2, others.size, people))
    near = np.empty((size, draws))
    who = np.empty((size, draws), dtype=np.int64)
    for p in range(people):
        for a in range(size):
            for s in range(draws):
                best = a
                least = -push[p, chosen[a], s]
                for b in range(size):
                    value = half[p, chosen[a], chosen[b]] - push[p, chosen[b], s]
                    if b != place and value < least:
                        least = value
                        best = b
                near[a, s] = least
                who[a, s] = best
        for k in range(others.size):
            other = others[k]
            counts = np.zeros((size, size))
            for a in range(size):
                if a == place:
                    continue
                edge = half[p, chosen[a], other]
                for s in range(draws):
                    counts[a, place if edge - push[p, other, s] < near[a, s] else who[a, s]] += 1.0
            for s in range(draws):
                best = place
                least = -push[p, other, s]
                for b in range(size):
                    value = half[p, other, chosen[b]] - push[p, chosen[b], s]
                    if b != place and value < least:
                        least = value
                        best = b
                counts[place, best] += 1.0
            each[0, k, p], each[1, k, p] = tally(counts, size, draws, lapse[p])
    return each


def _all_subsets(
    half: Any, push: Any, lapse: Any, durations: Any, costs: Any, most: Any, asked: Any, best: Any, found: Any
) -> None:
    """All subsets of `best.size`, depth first; what is nearest so far is kept for every depth, so that one more icon
    costs one more look. `asked` is how many of the first are in every subset, and the code of the objective.
    """
    people, n, draws = push.shape
    count, forced, code = best.size, asked[0], asked[1]
    chosen = np.zeros(count, dtype=np.int64)
    least = np.empty((count, count, people, draws))
    named = np.empty((count, count, people, draws), dtype=np.int16)
    counts = np.zeros((count + 1, people, count, count))
    spent = np.zeros((count + 1, most.size))
    depth = 0
    chosen[0] = -1
    while depth >= 0:
        chosen[depth] += 1
        icon = chosen[depth]
        if icon > n - count + depth or (depth < forced and icon > depth):
            depth -= 1
            continue
        last = depth == count - 1
        fits = True
        for row in range(most.size):
            spent[depth + 1, row] = spent[depth, row] + costs[row, icon]
            # Costs may be negative (a module that generates), so that only a whole subset is judged.
            fits = fits and (not last or spent[depth + 1, row] <= most[row])
        if not fits:
            continue
        counts[depth + 1] = counts[depth]
        for p in range(people):
            mine_counts = counts[depth + 1, p]
            mine = push[p, icon]
            for a in range(depth):
                edge = half[p, chosen[a], icon]
                before, who = least[depth - 1, a, p], named[depth - 1, a, p]
                for s in range(draws):
                    if edge - mine[s] < before[s]:
                        mine_counts[a, who[s]] -= 1.0
                        mine_counts[a, depth] += 1.0
                if not last:
                    for s in range(draws):
                        value = edge - mine[s]
                        closer = value < before[s]
                        least[depth, a, p, s] = value if closer else before[s]
                        named[depth, a, p, s] = depth if closer else who[s]
            near, which = least[depth, depth, p], named[depth, depth, p]
            for s in range(draws):
                near[s] = -mine[s]
                which[s] = depth
            for a in range(depth):
                edge, other = half[p, icon, chosen[a]], push[p, chosen[a]]
                for s in range(draws):
                    value = edge - other[s]
                    closer = value < near[s]
                    near[s] = value if closer else near[s]
                    which[s] = a if closer else which[s]
            for s in range(draws):
                mine_counts[depth, which[s]] += 1.0
        if not last:
            depth += 1
            chosen[depth] = icon
            continue
        correct = 0.0
        bits = 0.0
        for p in range(people):
            one, two = tally(counts[count, p], count, draws, lapse[p])
            correct += one
            bits += two
        length = 0.0
        for a in range(count):
            length += durations[chosen[a]]
        value = valued(correct / people, bits / people, length / count, code)
        found[1] += 1.0
        if value > found[0]:
            found[0] = value
            best[:] = chosen


_compile: Any = kernel(nogil=True)
valued: Callable[[float, float, float, int], float] = _compile(_valued)
tally: Callable[..., tuple[float, float]] = _compile(_tally)
swapped: Callable[[Array, Array, Array, Any, int, Any], Array] = _compile(_swapped)
all_subsets: Callable[..., None] = _compile(_all_subsets)
