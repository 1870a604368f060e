"""The best k places of a pool, by one objective: exact where that can be proven, else the best of seeded restarts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .max_min_subset import Limits, UndecidedError, max_min_subset
from .request import ChoiceError, Selection, UsableIcons
from .subset_identification import Objective, SubsetIdentification
from .upper_bounds import upper_bound

ENUMERATED = 20
MOST_SUBSETS = 200_000
"""Pools of up to 20 icons, and all with at most this many choices, are enumerated completely."""
RESTARTS = 6
"""Random choices that larger pools are also climbed from."""


@dataclass(frozen=True, slots=True)
class SubsetChoice:
    """Places of the chosen icons, the objective's value, its bound, whether it is reached, and choices examined."""

    chosen: tuple[int, ...]
    value: float
    bound: float
    optimal: bool
    seen: int


def pick(
    middle: Array,
    namings: SubsetIdentification | None,
    count: int,
    objective: Objective,
    must: Sequence[int] = (),
    limits: Limits | None = None,
    seed: int = 0,
) -> SubsetChoice | None:
    """The best `count` by one objective: of median d′ (n, n) for `worst`, else of the namings; None: no choice fits."""
    within = limits or Limits.none(len(middle))
    if namings is None or objective == "worst":
        try:
            best = max_min_subset(middle, count, must, within)
        except UndecidedError:
            raise ChoiceError(
                "it could not be decided whether any choice keeps the totals: relax one of them"
            ) from None
        if best is None:
            return None
        return SubsetChoice(best.chosen, best.value, best.bound, best.proven, best.thresholds)
    n, free = len(middle), count - len(must)
    if n <= ENUMERATED or math.comb(n - len(must), free) <= MOST_SUBSETS:
        optimum = namings.enumerated(count, objective, must, within.costs, within.most)
        return None if optimum is None else SubsetChoice(optimum[0], optimum[1], optimum[1], True, optimum[2])
    return _climbed(middle, namings, count, objective, must, within, seed)


def _climbed(
    middle: Array,
    namings: SubsetIdentification,
    count: int,
    objective: Objective,
    must: Sequence[int],
    limits: Limits,
    seed: int,
) -> SubsetChoice | None:
    """The best of the widest choice and of random ones, each improved by single swaps until none helps."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 6]))
    others = [k for k in range(len(middle)) if k not in must]
    starts = [pick(middle, None, count, "worst", must, limits)]
    if starts[0] is None:
        return None
    first = starts[0].chosen
    drawn = [
        [*must, *sorted(int(k) for k in rng.choice(others, count - len(must), replace=False))] for _ in range(RESTARTS)
    ]
    best, value, seen = first, -math.inf, 0
    for start in [list(first), *(one for one in drawn if limits.kept(one))]:
        chosen, score = start, namings.score(start, objective)
        while True:
            allowed = swaps(chosen, must, limits, len(middle))
            found = namings.swapped(chosen, objective, allowed)
            seen += int(allowed.sum())
            place, other = (int(k) for k in np.unravel_index(int(found.argmax()), found.shape))
            if not found[place, other] > score:
                break
            score, chosen[place] = float(found[place, other]), other
        ordered = tuple(sorted(chosen))
        if score > value + 1e-12:
            best, value = ordered, namings.score(ordered, objective)
    bound = upper_bound(namings, count, objective)
    return SubsetChoice(best, value, max(bound, value), value >= bound, seen)


def swaps(chosen: Sequence[int], must: Sequence[int], limits: Limits, n: int) -> NDArray[np.bool_]:
    """Which icon (chosen, n) may replace a chosen one: not one of those that must stay, and within the limits."""
    allowed = np.ones((len(chosen), n), dtype=bool)
    allowed[:, list(chosen)] = False
    for place, thing in enumerate(chosen):
        if thing in must:
            allowed[place] = False
        elif limits.most:
            rest = [k for k in chosen if k != thing]
            for other in np.flatnonzero(allowed[place]):
                allowed[place, other] = limits.kept([*rest, int(other)])
    return allowed


def limits_of(asked: Selection, pool: UsableIcons) -> Limits:
    """The totals that a request sets to the icons of a pool."""
    rows = [
        (costs, most)
        for costs, most in ((pool.durations_s, asked.most_s), (pool.energies_J, asked.most_J))
        if most is not None
    ]
    if not rows:
        return Limits.none(len(pool.places))
    return Limits(np.stack([costs for costs, _ in rows]), tuple(most for _, most in rows))


def nothing_fits(asked: Selection, pool: UsableIcons) -> str:
    """Why no choice keeps the totals of a request, with the least that so many icons take."""
    totals = []
    for costs, most, unit, what in (
        (pool.durations_s, asked.most_s, "s", "shortest last"),
        (pool.energies_J, asked.most_J, "J", "most frugal take"),
    ):
        if most is not None:
            least = math.fsum(np.sort(costs)[: asked.count])
            totals.append(f"{most:g} {unit} (the {asked.count} {what} {least:.3g} {unit})")
    forced = f" with {', '.join(asked.must)} among them" if asked.must else ""
    return f"no {asked.count} of the {len(pool.places)} icons{forced} stay within a total of {' and '.join(totals)}"
