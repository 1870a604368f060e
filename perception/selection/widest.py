"""The k of n things whose worst pair is best, proven: a search for cliques under a falling threshold.

k things all at least t apart are a clique of the graph that joins what is at least t apart. The largest t with a
clique is found by bisection over the distances there are; branch and bound with a colouring decides each graph.
Ties in the worst pair are broken by the next worst, and so on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array

MOST_NODES = 200_000
"""Branches of one search, some ten seconds of them; after that the answer says that it is not proven."""


class OutOfBudget(Exception):
    """A search was given up before it was decided."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What the chosen may cost together: `costs` (limits, things), each row's sum at most its `most`."""

    costs: Array
    most: tuple[float, ...]

    @classmethod
    def none(cls, things: int) -> Limits:
        """No limit at all."""
        return cls(np.empty((0, things)), ())

    def kept(self, chosen: Sequence[int]) -> bool:
        """Whether these things keep every limit, to the last bit or so."""
        return all(
            math.fsum(row[list(chosen)]) <= most + 1e-9 * abs(most)
            for row, most in zip(self.costs, self.most, strict=True)
        )


@dataclass(frozen=True, slots=True)
class Widest:
    """Chosen things in their order, the distance of their worst pair, and what no choice exceeds.

    `proven` says that the bound is reached; `nodes` is how many branches were looked at.
    """

    chosen: tuple[int, ...]
    value: float
    bound: float
    proven: bool
    nodes: int


def widest(
    distances: ArrayLike,
    count: int,
    must: Sequence[int] = (),
    limits: Limits | None = None,
    most_nodes: int = MOST_NODES,
    ties: bool = True,
) -> Widest | None:
    """The `count` things whose nearest pair is farthest apart; None where no choice keeps the limits.

    `distances` (n, n) is symmetric; its diagonal does not count. `must` are things that are in every choice.
    Without `ties` the value is the same and any choice that has it will do.
    Raises `OutOfBudget` where it stays open whether any choice keeps the limits, `ValueError` for a count outside
    2 to n, or more things that must be in than there is room for.

    >>> found = widest([[0, 1, 4], [1, 0, 3], [4, 3, 0]], 2)
    >>> found.chosen, found.value, found.proven
    ((0, 2), 4.0, True)
    """
    d = np.asarray(distances, dtype=np.float64)
    n = len(d)
    if not 2 <= count <= n:
        raise ValueError(f"{count} of {n} things cannot be chosen: at least 2 are needed, and no more than there are")
    if len(must) > count:
        raise ValueError(f"{len(must)} things must be among {count}")
    search = _Search(d, count, tuple(must), limits or Limits.none(n), most_nodes)
    return search.best(ties)


def worst(distances: Array, chosen: Sequence[int]) -> float:
    """Distance of the nearest pair of the chosen."""
    part = distances[np.ix_(chosen, chosen)]
    return float(part[np.triu_indices(len(chosen), 1)].min())


class _Search:
    def __init__(self, d: Array, count: int, must: tuple[int, ...], limits: Limits, most_nodes: int) -> None:
        self.d, self.count, self.must, self.limits = d, count, must, limits
        self.n, self.nodes, self.most_nodes = len(d), 0, most_nodes
        self.free: set[tuple[int, int]] = set()

    def best(self, ties: bool) -> Widest | None:
        values = np.unique(self.d[np.triu_indices(self.n, 1)])
        found = self._greedy()
        if found is None and (found := self._clique(float(values[0]))) is None:
            return None
        low = int(np.searchsorted(values, worst(self.d, found)))
        high = closed = len(values)
        while high - low > 1:
            middle = (low + high) // 2
            try:
                better = self._clique(float(values[middle]))
            except OutOfBudget:
                high = middle  # nothing is known of it: the search goes on below, the bound stays above
                continue
            if better is None:
                high = closed = middle
            else:
                found, low = better, int(np.searchsorted(values, worst(self.d, better)))
        value, proven = worst(self.d, found), closed == low + 1
        if proven and ties:
            found = self._ties_broken(found, value)
        return Widest(tuple(sorted(found)), value, float(values[closed - 1]), proven, self.nodes)

    def _ties_broken(self, found: tuple[int, ...], value: float) -> tuple[int, ...]:
        """Of the choices with this worst pair the one whose next worst is widest: the pair is set, then let go."""
        held = _Search(self.d.copy(), self.count, self.must, self.limits, self.most_nodes)
        while True:
            pairs = [(a, b) for k, a in enumerate(found) for b in found[k + 1 :]]
            tied = [(a, b) for a, b in pairs if held.d[a, b] <= value]
            for a, b in tied[:1]:
                held.d[a, b] = held.d[b, a] = math.inf
                held.must = tuple(dict.fromkeys((*held.must, a, b)))
            finite = [held.d[a, b] for a, b in pairs if math.isfinite(held.d[a, b])]
            if not finite or len(held.must) == self.count:
                return found
            values = np.unique(held.d[np.triu_indices(self.n, 1)])
            low, high = int(np.searchsorted(values, min(finite))), len(values)
            try:
                while high - low > 1:
                    middle = (low + high) // 2
                    better = held._clique(float(values[middle]))
                    if better is None:
                        high = middle
                    else:
                        found, low = better, max(middle, int(np.searchsorted(values, worst(held.d, better))))
            except OutOfBudget:
                return found
            finally:
                self.nodes += held.nodes
                held.nodes = 0
            value = worst(held.d, found)

    def _greedy(self) -> tuple[int, ...] | None:
        """The best of the choices that start anywhere and add what is farthest from all before it."""
        best: tuple[int, ...] | None = None
        for start in range(self.n):
            chosen = list(self.must) or [start]
            if self.must and start not in chosen and len(chosen) < self.count:
                chosen.append(start)
            nearest = self.d[chosen].min(axis=0)
            while len(chosen) < self.count:
                nearest[chosen] = -math.inf
                chosen.append(int(nearest.argmax()))
                nearest = np.minimum(nearest, self.d[chosen[-1]])
            if self.limits.kept(chosen) and (best is None or worst(self.d, chosen) > worst(self.d, best)):
                best = tuple(chosen)
        return best

    def _clique(self, threshold: float) -> tuple[int, ...] | None:
        """`count` things all at least the threshold apart that keep the limits; None where there are none."""
        joined = self.d >= threshold
        np.fill_diagonal(joined, False)
        beside = [int.from_bytes(np.packbits(row, bitorder="little").tobytes(), "little") for row in joined]
        open_ = (1 << self.n) - 1
        for k, a in enumerate(self.must):
            if any(not beside[a] >> b & 1 for b in self.must[k + 1 :]):
                return None
            open_ &= beside[a]
        spent = [math.fsum(row[list(self.must)]) for row in self.limits.costs]
        budget = self.nodes + self.most_nodes
        return self._grow(beside, list(self.must), open_, spent, budget)

    def _grow(
        self, beside: list[int], chosen: list[int], open_: int, spent: list[float], budget: int
    ) -> tuple[int, ...] | None:
        self.nodes += 1
        need = self.count - len(chosen)
        if need == 0:
            return tuple(chosen) if self.limits.kept(chosen) else None
        if self.nodes > budget:
            raise OutOfBudget
        if open_.bit_count() < need or not self._affordable(open_, need, spent):
            return None
        order, colour = _coloured(beside, open_)
        for place in range(len(order) - 1, -1, -1):
            if colour[place] < need:
                return None
            thing = order[place]
            added = [total + float(row[thing]) for total, row in zip(spent, self.limits.costs, strict=True)]
            found = self._grow(beside, [*chosen, thing], open_ & beside[thing], added, budget)
            if found is not None:
                return found
            open_ &= ~(1 << thing)
        return None

    def _affordable(self, open_: int, need: int, spent: Sequence[float]) -> bool:
        """Whether the cheapest that are left would still keep every limit."""
        if not self.limits.most:
            return True
        left = [k for k in range(self.n) if open_ >> k & 1]
        return all(
            total + math.fsum(sorted(row[left])[:need]) <= most + 1e-9 * abs(most)
            for total, row, most in zip(spent, self.limits.costs, self.limits.most, strict=True)
        )


def _coloured(beside: Sequence[int], open_: int) -> tuple[list[int], list[int]]:
    """Things by a greedy colouring: up to a thing no clique has more members than its colour."""
    order: list[int] = []
    colours: list[int] = []
    colour, left = 0, open_
    while left:
        colour += 1
        apart = left
        while apart:
            lowest = apart & -apart
            thing = lowest.bit_length() - 1
            order.append(thing)
            colours.append(colour)
            left ^= lowest
            apart ^= lowest
            apart &= ~beside[thing]
    return order, colours
