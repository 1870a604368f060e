"""The climb of a search: pools of icons about the best set so far, out of each of which the best set is taken."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .candidates import Candidate, sample_candidates
from .evaluators import NominalEvaluator, PopulationEvaluator
from .max_min_subset import Limits, max_min_subset, nearest_pair
from .pick import pick, swaps
from .request import ChoiceError
from .share_evaluator import ShareEvaluator
from .subset_identification import Objective, SubsetIdentification

if TYPE_CHECKING:
    from thermicon.icons import Family, Icon

SAMPLED = 400
"""Listed icons that a search starts from, at most; of more, so many are drawn."""
SHRINK, FINEST = 0.85, 0.005
"""By what a step shrinks where nothing better is found, and the smallest one, as a share of a range."""
ALIKE = -1.0
"""Stands for d′ between two members of one family, where each family gives one icon."""
SHORTLIST = 8
"""Listed icons per place of a set that are tried for a share of people: those whose swap serves the mean best."""


@dataclass(frozen=True, slots=True)
class JudgedPool:
    """Candidates with their d′ (people, n, n) and its median (n, n), in which members of one family may be alike."""

    candidates: list[Candidate]
    d_prime: Array
    middle: Array
    limits: Limits | None

    @property
    def icons(self) -> list[Icon]:
        """Their icons."""
        return [candidate.icon for candidate in self.candidates]


class SearchRun:
    """Pools of icons about the best set so far; the best set in each pool is looked for as in `choose`."""

    def __init__(
        self, fixed: tuple[Icon, ...], optional: tuple[Icon, ...], families: tuple[Family, ...], free: int, each: bool
    ) -> None:
        self.fixed, self.optional = [Candidate(icon) for icon in fixed], [Candidate(icon) for icon in optional]
        self.families, self.free, self.each = families, free, each
        self.pool: list[Candidate] = []
        self.tried = 0

    def start(self, judge: NominalEvaluator | PopulationEvaluator, rng: np.random.Generator) -> list[Candidate]:
        """The best of the members that the families count out, or of a sample of them."""
        pool = [*self.fixed, *self.optional, *sample_candidates(self.families, SAMPLED, rng)]
        self.pool = pool
        found = self.best(pool, judge, None)
        if found is None:
            bad = [reason for reason in judge.objections if reason is not None]
            good = [place for place, reason in enumerate(judge.objections) if reason is None]
            raise ChoiceError(
                f"no {self.free + len(self.fixed)} icons can be chosen within the limits: {len(bad)} of {len(pool)} "
                f"that were tried cannot be chosen at all{', the first of which ' + bad[0] if bad else ''}"
                + judge.request.least_totals(judge.limits, good, self.free + len(self.fixed))
            )
        return found

    def improve(
        self,
        held: list[Candidate],
        judge: NominalEvaluator | PopulationEvaluator,
        rounds: int,
        batch: int,
        rng: np.random.Generator,
        step: float,
        tell: Callable[[int], None],
    ) -> list[Candidate]:
        """The best set of pools that surround the best before, in steps that shrink where nothing better is found."""
        for _ in range(rounds):
            about = held[len(self.fixed) :]
            near = [candidate.moved(rng, step * float(rng.exponential())) for candidate in about for _ in range(batch)]
            others = [candidate for candidate in self.optional if candidate not in held]
            pool = [*held, *others, *(candidate for candidate in near if candidate is not None)]
            better = self.best(pool, judge, held)
            moved = better is not None and [g.icon for g in better] != [g.icon for g in held]
            held = better if better is not None else held
            step = step if moved else max(SHRINK * step, FINEST)
            tell(self.tried)
        return held

    def listed(
        self, mean: PopulationEvaluator, share: ShareEvaluator, start: list[Candidate], seed: int
    ) -> tuple[list[Candidate], list[Candidate]]:
        """The best listed sets: for the mean of a few people, as in a frontier, and for the share of a goal."""
        pool = self._judged(self.pool, mean)
        count, must = self.free + len(self.fixed), len(self.fixed)
        chosen = None if pool is None else self._picked(pool, mean, count, must, seed)
        if pool is None or chosen is None:
            return start, start
        namings = mean.namings(pool.d_prime, pool.icons)
        swapped = namings.swapped(chosen, mean.objective, _swaps(chosen, pool.middle, must, pool.limits))
        near = {int(k) for row in swapped for k in np.argsort(-row)[:SHORTLIST] if np.isfinite(row[k])}
        by_mean = self._ordered(pool, chosen)
        held = share.better(by_mean, start)
        others = [
            candidate
            for candidate in (*by_mean, *start, *(pool.candidates[k] for k in sorted(near)))
            if candidate not in held
        ]
        by_share = self.best([*held, *dict.fromkeys(others)], share, held)
        return by_mean, held if by_share is None else by_share

    def _picked(
        self, pool: JudgedPool, judge: PopulationEvaluator, count: int, must: int, seed: int
    ) -> list[int] | None:
        """Places of the best set of a pool, as a frontier picks them; of one icon per family, by a single climb."""
        namings = judge.namings(pool.d_prime, pool.icons)
        if not self.each:
            picked = pick(pool.middle, namings, count, judge.objective, tuple(range(must)), pool.limits, seed)
            return None if picked is None else list(picked.chosen)
        first = max_min_subset(pool.middle, count, tuple(range(must)), pool.limits)
        if first is None or nearest_pair(pool.middle, first.chosen) <= ALIKE:
            return None
        return climbed(namings, list(first.chosen), judge.objective, pool.middle, must, pool.limits)

    def best(
        self, pool: list[Candidate], judge: NominalEvaluator | PopulationEvaluator, held: list[Candidate] | None
    ) -> list[Candidate] | None:
        """The best set out of a pool, plain icons first; None where no set can be played."""
        found, must = self._judged(pool, judge), len(self.fixed)
        if found is None:
            return None
        first = max_min_subset(found.middle, must + self.free, tuple(range(must)), found.limits)
        if first is None or nearest_pair(found.middle, first.chosen) <= ALIKE:
            return None
        chosen = list(first.chosen)
        if judge.objective != "worst":
            begin = list(range(must + self.free)) if held is not None else chosen
            namings = judge.namings(found.d_prime, found.icons)
            chosen = climbed(namings, begin, judge.objective, found.middle, must, found.limits)
        return self._ordered(found, chosen)

    def _judged(self, pool: list[Candidate], judge: NominalEvaluator | PopulationEvaluator) -> JudgedPool | None:
        """The icons of a pool that can be chosen, as people feel them; None where they are too few."""
        self.tried += len(pool)
        d = judge.pairwise_dprime([candidate.icon for candidate in pool])
        must = len(self.fixed)
        good = [k for k in range(len(pool)) if k < must or judge.objections[k] is None]
        candidates, d = [pool[k] for k in good], d[:, good][:, :, good]
        if len(candidates) < must + self.free:
            return None
        middle = np.median(d, axis=0)
        if self.each:
            own = np.array([self._place(candidate) for candidate in candidates])
            middle[(own[:, None] == own) & (own >= 0)] = ALIKE
        limits = None if judge.limits is None else Limits(judge.limits.costs[:, good], judge.limits.most)
        return JudgedPool(candidates, d, middle, limits)

    def _ordered(self, pool: JudgedPool, chosen: Sequence[int]) -> list[Candidate]:
        must = len(self.fixed)
        order = sorted(chosen, key=lambda k: (k >= must, self._place(pool.candidates[k]), k))
        return [pool.candidates[k] for k in order]

    def _place(self, candidate: Candidate) -> int:
        return -1 if candidate.family is None else self.families.index(candidate.family)


def climbed(
    namings: SubsetIdentification,
    chosen: list[int],
    objective: Objective,
    middle: Array,
    must: int,
    limits: Limits | None = None,
) -> list[int]:
    """Single swaps that improve an objective until none does; the first `must` stay, and no two alike come in."""
    score = namings.score(chosen, objective)
    while True:
        found = namings.swapped(chosen, objective, _swaps(chosen, middle, must, limits))
        place, other = (int(k) for k in np.unravel_index(int(found.argmax()), found.shape))
        if not found[place, other] > score + 1e-9:
            return chosen
        score, chosen[place] = float(found[place, other]), other


def _swaps(chosen: Sequence[int], middle: Array, must: int, limits: Limits | None) -> NDArray[np.bool_]:
    """Which icon (chosen, n) may replace a chosen one, and is not alike one that stays."""
    allowed = swaps(chosen, range(must), limits or Limits.none(len(middle)), len(middle))
    for place in range(len(chosen)):
        rest = [k for other, k in enumerate(chosen) if other != place]
        allowed[place] &= (middle[rest] > ALIKE).all(axis=0)
    return allowed
