"""The k of n things whose nearest pair is farthest apart, with proof.

Bisection over the distances that occur finds the largest t for which k things all at least t apart exist. A short
exhaustive search decides this for most t; the rest is left to integer programming (HiGHS through SciPy): "choose k; of
a pair nearer than t at most one; totals within their limits".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array

MOST_STEPS = 20_000
"""Steps of the exhaustive search before the integer program takes over: about 0.02 s."""
MOST_NODES = 20_000
"""Branches that a single program may take; then the answer states that it is not proven. A limit in time would not
give the same answer on every machine."""
LIMIT_REACHED = 1
"""Status of `scipy.optimize.milp`."""


class StepsExhaustedError(Exception):
    """The search stopped before it was complete."""


class UndecidedError(Exception):
    """A program reached its limit before it was decided."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Totals that the chosen must keep: `costs` (limits, things), each row's sum at most its `most`."""

    costs: Array
    most: tuple[float, ...]

    @classmethod
    def none(cls, things: int) -> Limits:
        """No limit at all."""
        return cls(np.empty((0, things)), ())

    def kept(self, chosen: Sequence[int]) -> bool:
        """Whether these things keep every limit, up to rounding."""
        return all(
            math.fsum(row[list(chosen)]) <= most + 1e-9 * abs(most)
            for row, most in zip(self.costs, self.most, strict=True)
        )


@dataclass(frozen=True, slots=True)
class MaxMinSubset:
    """Chosen things in ascending order, the distance of their nearest pair, and what no choice exceeds.

    `proven` states that the bound is reached; `thresholds` is the number of distances that were decided.
    """

    chosen: tuple[int, ...]
    value: float
    bound: float
    proven: bool
    thresholds: int


def max_min_subset(
    distances: ArrayLike,
    count: int,
    must: Sequence[int] = (),
    limits: Limits | None = None,
    ties: bool = True,
) -> MaxMinSubset | None:
    """Choose the `count` things whose nearest pair is farthest apart.

    Parameters
    ----------
    distances
        Symmetric matrix (n, n); its diagonal does not count.
    count
        Number of things to choose, 2 to n.
    must
        Things that every choice contains.
    limits
        Totals to keep (None: no limit).
    ties
        Whether equal choices are decided by their next nearest pair, and so on.

    Returns
    -------
    MaxMinSubset or None
        None where no choice keeps the limits.

    Raises
    ------
    UndecidedError
        Where it remains open whether any choice keeps the limits.
    ValueError
        For a count outside 2 to n, and for more `must` than `count`.

    Examples
    --------
    >>> best = max_min_subset([[0, 1, 4], [1, 0, 3], [4, 3, 0]], 2)
    >>> best.chosen, best.value, best.proven
    ((0, 2), 4.0, True)

    """
    d = np.array(distances, dtype=np.float64)
    n = len(d)
    if not 2 <= count <= n:
        raise ValueError(f"{count} of {n} things cannot be chosen: at least 2 are needed, and no more than there are")
    if len(must) > count:
        raise ValueError(f"{len(must)} things must be among {count}")
    return _Bisection(d, count, tuple(must), limits or Limits.none(n)).best(ties)


def nearest_pair(distances: Array, chosen: Sequence[int]) -> float:
    """Distance of the nearest pair of the chosen."""
    part = distances[np.ix_(chosen, chosen)]
    return float(part[np.triu_indices(len(chosen), 1)].min())


class _Bisection:
    def __init__(self, d: Array, count: int, must: tuple[int, ...], limits: Limits) -> None:
        self.d, self.count, self.must, self.limits = d, count, must, limits
        self.thresholds = 0

    def best(self, ties: bool) -> MaxMinSubset | None:
        values = self._values()
        start = self._greedy()
        if start is None and (start := self._subset_at(float(values[0]))) is None:
            return None
        chosen, bound = self._widened(start, values)
        value = nearest_pair(self.d, chosen)
        if bound <= value and ties:
            chosen = self._ties_broken(chosen)
        return MaxMinSubset(tuple(sorted(chosen)), value, bound, bound <= value, self.thresholds)

    def _values(self) -> Array:
        return np.unique(self.d[np.triu_indices(len(self.d), 1)])

    def _widened(self, chosen: tuple[int, ...], values: Array) -> tuple[tuple[int, ...], float]:
        """The widest choice, and the largest value that is not proven to be out of reach."""
        low = int(np.searchsorted(values, self._nearest(chosen)))
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
                chosen, low = wider, max(middle, int(np.searchsorted(values, self._nearest(wider))))
        return chosen, float(values[closed - 1])

    def _ties_broken(self, chosen: tuple[int, ...]) -> tuple[int, ...]:
        """Of the choices with the same nearest pair the one whose next is widest: the pair is fixed, then ignored."""
        rest = _Bisection(self.d.copy(), self.count, self.must, self.limits)
        try:
            while len(rest.must) < self.count:
                members = sorted(chosen)
                pairs = [(rest.d[a, b], a, b) for k, a in enumerate(members) for b in members[k + 1 :]]
                _, a, b = min(pairs)
                rest.d[a, b] = rest.d[b, a] = math.inf
                rest.must = tuple(dict.fromkeys((*rest.must, a, b)))
                if not math.isfinite(rest._nearest(chosen)):
                    break
                chosen, _ = rest._widened(chosen, rest._values())
        except UndecidedError:
            pass
        self.thresholds += rest.thresholds
        return chosen

    def _nearest(self, chosen: Sequence[int]) -> float:
        return nearest_pair(self.d, chosen)

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
            if self.limits.kept(chosen) and (best is None or self._nearest(chosen) > self._nearest(best)):
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
        places = {int(thing): place for place, thing in enumerate(left)}
        try:
            clique = find_clique(
                compatible[np.ix_(left, left)],
                self.count,
                [places[thing] for thing in self.must],
                lambda clique: self.limits.kept([int(left[k]) for k in clique]),
                MOST_STEPS,
            )
        except StepsExhaustedError:
            return self._by_program(compatible, left)
        return None if clique is None else tuple(int(left[k]) for k in clique)

    def _by_program(self, compatible: NDArray[np.bool_], left: NDArray[np.intp]) -> tuple[int, ...] | None:
        """The same among the things that are left, by integer programming."""
        from scipy.optimize import Bounds, LinearConstraint, milp
        from scipy.sparse import csr_array

        first, second = np.nonzero(np.triu(~compatible[np.ix_(left, left)], 1))
        rows = np.arange(first.size)
        near = csr_array(
            (np.ones(2 * first.size), (np.tile(rows, 2), np.concatenate([first, second]))),
            shape=(first.size, left.size),
        )
        constraints = [LinearConstraint(np.ones((1, left.size)), self.count, self.count)]
        if first.size:
            constraints.append(LinearConstraint(near, ub=np.ones(first.size)))
        constraints += [
            LinearConstraint(costs[left][None], ub=most + 1e-9 * abs(most))
            for costs, most in zip(self.limits.costs, self.limits.most, strict=True)
        ]
        result = milp(
            np.zeros(left.size),
            integrality=np.ones(left.size, dtype=np.int64),
            bounds=Bounds(np.isin(left, self.must).astype(np.float64), 1.0),
            constraints=constraints,
            options={"node_limit": MOST_NODES},
        )
        if result.x is not None:
            return tuple(int(k) for k in left[result.x > 0.5])
        if result.status == LIMIT_REACHED:
            raise UndecidedError
        return None

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
    compatible: NDArray[np.bool_],
    size: int,
    must: Sequence[int],
    accepts: Callable[[Sequence[int]], bool],
    most_steps: int,
) -> tuple[int, ...] | None:
    """`size` mutually compatible things that contain `must` and are accepted; None where there are none.

    The things of `must` are taken to be compatible with each other. Raises `StepsExhaustedError` after `most_steps`.
    """
    neighbours = [sum(1 << int(k) for k in np.flatnonzero(row)) & ~(1 << i) for i, row in enumerate(compatible)]
    steps = 0

    def outside_groups(candidates: int, groups: int) -> int:
        """What is left of candidates without so many groups in which no pair is compatible: each gives one at most."""
        for _ in range(groups):
            group = candidates
            while group:
                one = group.bit_length() - 1
                candidates &= ~(1 << one)
                group &= ~(neighbours[one] | 1 << one)
        return candidates

    def extended(clique: tuple[int, ...], candidates: int) -> tuple[int, ...] | None:
        nonlocal steps
        steps += 1
        if steps > most_steps:
            raise StepsExhaustedError
        missing = size - len(clique)
        if missing == 0:
            return clique if accepts(clique) else None
        tried = outside_groups(candidates, missing - 1)  # whatever completes the clique has one of these
        while tried:
            last = tried.bit_length() - 1
            tried &= ~(1 << last)
            candidates &= ~(1 << last)
            complete = extended((*clique, last), candidates & neighbours[last])
            if complete is not None:
                return complete
        return None

    candidates = (1 << len(neighbours)) - 1
    for thing in must:
        candidates &= neighbours[thing]
    return extended(tuple(must), candidates)
