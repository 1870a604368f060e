"""The k of n things whose nearest pair is farthest apart.

Bisection over the distances that occur finds the largest t for which k things all at least t apart exist. Each t is
decided by an exhaustive search of cliques; where that takes too long, the answer says that it is not proven.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermicon.base.numbers.arrays import Array

from .request import UndecidedError

MOST_STEPS = 20_000
"""Steps of a single exhaustive search. A limit in time would not give the same answer on every machine."""


@dataclass(frozen=True, slots=True)
class Totals:
    """Totals that the chosen must keep: `costs` (limits, things), each row's sum at most its `most`."""

    costs: Array
    most: tuple[float, ...]

    @classmethod
    def none(cls, things: int) -> Totals:
        """No limit at all."""
        return cls(np.empty((0, things)), ())

    def kept(self, chosen: Sequence[int]) -> bool:
        """Whether these things keep every limit, up to rounding."""
        return all(
            math.fsum(row[list(chosen)]) <= most + 1e-9 * abs(most)
            for row, most in zip(self.costs, self.most, strict=True)
        )


@dataclass(frozen=True, slots=True)
class SubsetChoice:
    """Chosen things in ascending order, their value, what no choice exceeds, and how many looks that took.

    Looks are distances that were decided, or choices that were scored. `others` are the next best, where they are kept.
    """

    chosen: tuple[int, ...]
    value: float
    bound: float
    seen: int
    others: tuple[tuple[int, ...], ...] = ()

    @property
    def optimal(self) -> bool:
        """Whether the bound is reached, so that no other choice is better."""
        return self.bound <= self.value


def max_min_subset(
    distances: ArrayLike, count: int, must: Sequence[int] = (), limits: Totals | None = None
) -> SubsetChoice | None:
    """Choose the `count` of n things, `must` among them, whose nearest pair is farthest apart; None: none fits limits.

    The diagonal of `distances` (n, n) does not count. Equal choices are decided by their next nearest pair, and so on.
    Raises `UndecidedError` where it remains open whether any choice keeps the limits.

    >>> best = max_min_subset([[0, 1, 4], [1, 0, 3], [4, 3, 0]], 2)
    >>> best.chosen, best.value, best.optimal
    ((0, 2), 4.0, True)
    """
    d = np.array(distances, dtype=np.float64)
    return _Bisection(d, count, tuple(must), limits or Totals.none(len(d))).best()


def nearest_pair(distances: Array, chosen: Sequence[int]) -> float:
    """Distance of the nearest pair of the chosen."""
    part = distances[np.ix_(chosen, chosen)]
    return float(part[np.triu_indices(len(chosen), 1)].min())


class _Bisection:
    def __init__(self, d: Array, count: int, must: tuple[int, ...], limits: Totals) -> None:
        self.d, self.count, self.must, self.limits = d, count, must, limits
        self.thresholds = 0

    def best(self) -> SubsetChoice | None:
        values = self._values()
        start = self._greedy()
        if start is None and (start := self._subset_at(float(values[0]))) is None:
            return None
        chosen, bound = self._widened(start, values)
        value = nearest_pair(self.d, chosen)
        if bound <= value:
            chosen = self._ties_broken(chosen)
        return SubsetChoice(tuple(sorted(chosen)), value, bound, self.thresholds)

    def _values(self) -> Array:
        return np.unique(self.d[np.triu_indices(len(self.d), 1)])

    def _widened(self, chosen: tuple[int, ...], values: Array) -> tuple[tuple[int, ...], float]:
        """The widest choice, and the largest value that is not proven to be out of reach."""
        low = int(np.searchsorted(values, nearest_pair(self.d, chosen)))
        high = closed = len(values)
        step = 1
        while high - low > 1:
            # A greedy choice is close to the best: double the step upwards first, then halve the interval.
            middle = low + step if closed == high == len(values) and low + step < high else (low + high) // 2
            step *= 2
            try:
                wider = self._subset_at(float(values[middle]))
            except UndecidedError:
                high = middle  # the search goes on below, the bound stays above
                continue
            if wider is None:
                high = closed = middle
            else:
                chosen, low = wider, max(middle, int(np.searchsorted(values, nearest_pair(self.d, wider))))
        return chosen, float(values[closed - 1])

    def _ties_broken(self, chosen: tuple[int, ...]) -> tuple[int, ...]:
        """Of the choices with the same nearest pair the one whose next is widest: the pair is fixed, then ignored."""
        rest = _Bisection(self.d.copy(), self.count, self.must, self.limits)
        while len(rest.must) < self.count:
            _, a, b = min((rest.d[a, b], a, b) for a, b in combinations(sorted(chosen), 2))
            rest.d[a, b] = rest.d[b, a] = math.inf
            rest.must = tuple(dict.fromkeys((*rest.must, a, b)))
            if not math.isfinite(nearest_pair(rest.d, chosen)):
                break
            chosen, _ = rest._widened(chosen, rest._values())
        self.thresholds += rest.thresholds
        return chosen

    def _greedy(self) -> tuple[int, ...] | None:
        """The best of the choices that start anywhere and add what is farthest from all before it."""
        best: tuple[int, ...] | None = None
        for start in range(len(self.d)):
            chosen = list(self.must) or [start]
            if self.must and start not in chosen and len(chosen) < self.count:
                chosen.append(start)
            nearest = self.d[chosen].min(axis=0)
            while len(chosen) < self.count:
                nearest[chosen] = -math.inf
                chosen.append(int(nearest.argmax()))
                nearest = np.minimum(nearest, self.d[chosen[-1]])
            if self.limits.kept(chosen) and (best is None or nearest_pair(self.d, chosen) > nearest_pair(self.d, best)):
                best = tuple(chosen)
        return best

    def _subset_at(self, threshold: float) -> tuple[int, ...] | None:
        """`count` things all at least the threshold apart that keep the limits; None where there are none."""
        compatible = self.d >= threshold
        np.fill_diagonal(compatible, True)
        left = self._pruned(compatible)
        if left is None:
            return None
        self.thresholds += 1
        limits = Totals(self.limits.costs[:, left], self.limits.most)
        must = np.flatnonzero(np.isin(left, self.must)).tolist()
        clique = find_clique(compatible[np.ix_(left, left)], self.count, must, limits)
        return None if clique is None else tuple(left[list(clique)].tolist())

    def _pruned(self, compatible: NDArray[np.bool_]) -> NDArray[np.intp] | None:
        """Things that can be in a choice: compatible with all of `must` and with at least `count` − 1 of the others."""
        left = np.flatnonzero(compatible[list(self.must)].all(axis=0))
        while left.size >= self.count and set(self.must) <= set(left.tolist()):
            keep = compatible[np.ix_(left, left)].sum(axis=1) >= self.count
            if keep.all():
                return left
            left = left[keep]
        return None


def find_clique(
    compatible: NDArray[np.bool_], size: int, must: Sequence[int], limits: Totals
) -> tuple[int, ...] | None:
    """`size` mutually compatible things that contain `must` and keep the limits; None where there are none.

    The things of `must` are taken to be compatible with each other. Raises `UndecidedError` after `MOST_STEPS`.
    """
    neighbours = [sum(1 << int(k) for k in np.flatnonzero(row)) & ~(1 << i) for i, row in enumerate(compatible)]
    by_cost = [np.argsort(row, kind="stable").tolist() for row in limits.costs]
    steps = 0

    def within(clique: tuple[int, ...], candidates: int) -> bool:
        """Whether the cheapest candidates would complete the clique within each limit."""
        for row, most, order in zip(limits.costs, limits.most, by_cost, strict=True):
            cheapest = [k for k in order if candidates >> k & 1][: size - len(clique)]
            if math.fsum(row[[*clique, *cheapest]]) > most + 1e-9 * abs(most):
                return False
        return True

    def branches(candidates: int, groups: int) -> Iterator[int]:
        """Candidates outside so many groups in which no pair is compatible: whatever completes a clique has one."""
        left = candidates
        for _ in range(groups):
            group = left
            while group:
                one = group.bit_length() - 1
                left &= ~(1 << one)
                group &= ~(neighbours[one] | 1 << one)
        while left:
            one = left.bit_length() - 1
            left &= ~(1 << one)
            yield one

    def extended(clique: tuple[int, ...], candidates: int) -> tuple[int, ...] | None:
        nonlocal steps
        steps += 1
        if steps > MOST_STEPS:
            raise UndecidedError("it could not be decided whether any choice keeps the totals: relax one of them")
        if not within(clique, candidates):
            return None
        if len(clique) == size:
            return clique
        for last in branches(candidates, size - len(clique) - 1):
            candidates &= ~(1 << last)
            complete = extended((*clique, last), candidates & neighbours[last])
            if complete is not None:
                return complete
        return None

    candidates = (1 << len(neighbours)) - 1
    for thing in must:
        candidates &= neighbours[thing]
    return extended(tuple(must), candidates)
