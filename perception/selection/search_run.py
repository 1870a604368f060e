"""The climb of a search: pools of icons about the best set so far, out of each of which the best set is taken."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from .candidates import Candidate, sample_candidates
from .evaluator import Evaluator
from .max_min_subset import Limits, max_min_subset, nearest_pair
from .pool import Pool
from .request import ChoiceError
from .subset_identification import ALIKE, climb

if TYPE_CHECKING:
    from thermicon.icons import Family, Icon, IconSet

SAMPLED = 400
"""Listed icons that a search starts from, at most; of more, so many are drawn."""
SHRINK, FINEST = 0.85, 0.005
"""By what a step shrinks where nothing better is found, and the smallest one, as a share of a range."""


@dataclass(frozen=True, slots=True)
class JudgedPool:
    """Candidates that can be chosen, with their d′ (people, n, n) and its median (n, n), and totals to keep.

    Where each family gives one icon, its members are `ALIKE` in the median.
    """

    candidates: list[Candidate]
    pool: Pool
    d_prime: Array
    middle: Array
    limits: Limits


class SearchRun:
    """Pools of icons about the best set so far; the best set in each pool is looked for as in `choose`.

    `fixed` icons stay, `optional` ones may be left out, and `free` places are for those and members of the families;
    with `each`, every family has one place. `tried` counts icons.
    """

    def __init__(self, icons: IconSet, count: int | None, must: Sequence[str] | None) -> None:
        fixed, optional, self.free = split_icons(icons, count, must)
        self.fixed, self.optional = [Candidate(icon) for icon in fixed], [Candidate(icon) for icon in optional]
        self.families, self.each = icons.families, count is None
        self.must = tuple(range(len(fixed)))
        self.count = len(fixed) + self.free
        self.pool: list[Candidate] = []
        self.tried = 0

    def start(self, judge: Evaluator, rng: np.random.Generator) -> list[Candidate]:
        """The best of the members that the families count out, or of a sample of them."""
        self.pool = [*self.fixed, *self.optional, *sample_candidates(self.families, SAMPLED, rng)]
        found = self.best(self.pool, judge, None)
        if found is None:
            raise ChoiceError(self._nothing(judge))
        return found

    def improve(
        self,
        held: list[Candidate],
        judge: Evaluator,
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

    def best(self, pool: list[Candidate], judge: Evaluator, held: list[Candidate] | None) -> list[Candidate] | None:
        """The best set out of a pool that begins with the held one, plain icons first; None: no set can be played."""
        found = self._judged(pool, judge)
        chosen = None if found is None else self._best_places(found, judge, held)
        return None if found is None or chosen is None else self._ordered(found, chosen)

    def _best_places(self, pool: JudgedPool, judge: Evaluator, held: list[Candidate] | None) -> list[int] | None:
        first = max_min_subset(pool.middle, self.count, self.must, pool.limits)
        if first is None or nearest_pair(pool.middle, first.chosen) <= ALIKE:
            return None
        if judge.objective == "worst":
            return list(first.chosen)
        begin = first.chosen if held is None else range(self.count)
        namings = judge.namings(pool.d_prime, pool.pool)
        return climb(namings, begin, judge.objective, pool.middle, self.must, pool.limits)[0]

    def _judged(self, candidates: list[Candidate], judge: Evaluator) -> JudgedPool | None:
        """The icons that can be chosen, as people feel them; None where they are too few."""
        self.tried += len(candidates)
        pool = judge.pool([candidate.icon for candidate in candidates])
        d = judge.d_prime(pool)
        good = self._good(pool, judge)
        if len(good) < self.count:
            return None
        left, d, pool = [candidates[k] for k in good], d[:, good][:, :, good], pool.some(good)
        middle = np.median(d, axis=0)
        if self.each:
            own = np.array([self._place(candidate) for candidate in left])
            middle[(own[:, None] == own) & (own >= 0)] = ALIKE
        return JudgedPool(left, pool, d, middle, pool.limits(*judge.totals))

    def _good(self, pool: Pool, judge: Evaluator) -> list[int]:
        reasons = pool.objections(judge.goal, judge.observer)
        return [k for k, reason in enumerate(reasons) if k in self.must or reason is None]

    def _nothing(self, judge: Evaluator) -> str:
        """Why no set of the first pool can be chosen."""
        pool = judge.pool([candidate.icon for candidate in self.pool])
        bad = [reason for reason in pool.objections(judge.goal, judge.observer) if reason is not None]
        left = pool.some(self._good(pool, judge))
        first = f", the first of which {bad[0]}" if bad else ""
        over = f"; the totals: {left.totals_text(self.count, *judge.totals)}" if any(judge.totals) else ""
        return (
            f"no {self.count} icons can be chosen within the limits: {len(bad)} of {len(pool)} that were tried cannot "
            f"be chosen at all{first}{over}"
        )

    def _ordered(self, pool: JudgedPool, chosen: Sequence[int]) -> list[Candidate]:
        order = sorted(chosen, key=lambda k: (k not in self.must, self._place(pool.candidates[k]), k))
        return [pool.candidates[k] for k in order]

    def _place(self, candidate: Candidate) -> int:
        return -1 if candidate.family is None else self.families.index(candidate.family)


def better(judge: Evaluator, *sets: list[Candidate]) -> list[Candidate]:
    """The best of some sets for the people of an evaluator; the first of those that are equal."""

    def value(candidates: list[Candidate]) -> float:
        pool = judge.pool([candidate.icon for candidate in candidates])
        d = judge.d_prime(pool)
        if judge.objective == "worst":
            return nearest_pair(np.median(d, axis=0), range(len(pool)))
        return judge.namings(d, pool).score(range(len(pool)), judge.objective)

    return max(sets, key=value)


def split_icons(
    icons: IconSet, count: int | None, must: Sequence[str] | None
) -> tuple[tuple[Icon, ...], tuple[Icon, ...], int]:
    """Plain icons that stay, plain icons that may be left out, and how many icons are free; `must` None: all stay.

    Raises `ChoiceError` for a file without families, unknown names, and numbers of icons that leave nothing to search.
    """
    from thermicon.icons import Icon
    from thermicon.icons.model.icon import played_icons
    from thermicon.icons.near_words import did_you_mean

    families: tuple[Family, ...] = icons.families
    if not families:
        raise ChoiceError("nothing to search: the file has no family, such as icon dip(depth in 1..6 step 1 °C) { … }")
    for family in families:
        if next(iter(played_icons(family.template)), None) is not None:
            raise ChoiceError(f"family {family.name} plays another icon, which a search cannot carry along")
    plain = tuple(entry for entry in icons.entries if isinstance(entry, Icon))
    names = [icon.name for icon in plain]
    for name in must or ():
        if name not in names:
            known = did_you_mean(name, names) if names else "the file has families only"
            raise ChoiceError(f"no plain icon is called {name!r}, which must be in the set: {known}")
    if must and count is None:
        raise ChoiceError("which icons must stay is a question only where some are chosen: give --choose K as well")
    fixed = plain if must is None else tuple(icon for icon in plain if icon.name in must)
    optional = tuple(icon for icon in plain if icon not in fixed)
    wanted = len(fixed) + len(families) if count is None else count
    if wanted < 2:
        raise ChoiceError("one icon is never confused: ask for 2 or more with --choose K, or give a second family")
    if wanted <= len(fixed):
        raise ChoiceError(f"{wanted} icons leave nothing to search: {len(fixed)} that are not families must stay")
    return fixed, optional, wanted - len(fixed)
