"""Cliques of a given size by exhaustive search that stops after a number of steps.

Where compatible things are rare, a few thousand steps decide what takes an integer program a second or more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray


class StepsExhaustedError(Exception):
    """The search stopped before it was complete."""


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
