"""The climb of a search: repeated pools of icons about the best set so far."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig
from thermicon.icons import Icon, IconSet
from thermicon.icons.model.statements import played_icons

from ..criteria import FELT_FROM
from ..identification.population import ReceptorTemperatures, memory_dprime, respond
from ..identification.task import USUAL
from ..observer.observer import MemoryForm, Observer
from ..observer.people import People
from ..sensation.detection import pooled
from .candidates import Candidate, sample_candidates
from .goal import Goal, GoalPart
from .max_min_subset import max_min_subset, nearest_pair
from .pool import POOL_HZ, Pool
from .request import ChoiceError, Objective
from .subset_identification import ALIKE, SubsetIdentification, climb

PEOPLE = 24
"""Of the seed the first, who differ in contact, skin and thresholds."""
SAMPLED = 400
"""Listed icons that a search starts from, at most; of more, so many are drawn."""
SHRINK, FINEST = 0.85, 0.005
"""By what a step shrinks where nothing better is found, and the smallest one, as a share of a range."""


@dataclass(frozen=True, slots=True)
class Evaluator:
    """Scores of pools and sets: by the nominal person unless there is a `crowd`.

    `goal` says what is asked of single icons and of totals.
    """

    rig: Rig
    objective: Objective
    memory: MemoryForm
    seed: int
    observer: Observer
    tracking: str | None = None
    goal: Goal | None = None
    crowd: People | None = None

    @property
    def parts(self) -> tuple[GoalPart, ...]:
        """What sets are chosen by, rather than by the objective alone."""
        return () if self.goal is None else self.goal.of_sets

    @property
    def totals(self) -> tuple[float | None, float | None]:
        """Most time, s, and energy, J, of all icons together."""
        return (None, None) if self.goal is None else self.goal.totals

    def felt(self, candidates: Sequence[Candidate]) -> tuple[Pool, Array, Array, Array]:
        """The candidates on the nominal rig, their d′ (people, icons, icons) from memory, how often each person
        reports them, (people, icons), and when people do, in s (icons,), where the goal has an onset.
        """
        pool = Pool.of([candidate.icon for candidate in candidates], self.rig, self.observer)
        if self.crowd is None:
            reports, onset_s = pool.felt_by(self.observer)
            return pool, pool.dprimes(pool, self.memory, self.observer)[None], reports[None], onset_s
        how = self.rig, self.observer, pool.end_s, POOL_HZ, self.tracking
        met = ReceptorTemperatures.simulated(pool.icons, self.crowd, *how)
        timed = self.goal is not None and self.goal.of("onset") is not None
        felt = respond(met, self.crowd, self.observer, times=timed)
        apart, found = memory_dprime(felt, self.memory, self.crowd.memory, self.observer, USUAL), felt.detected
        onset_s = np.zeros(len(pool))
        if timed:
            onset_s = pooled(found.probability, found.cold_share, found.reported_sum()[0], found.dt_s).onset_s
        return pool, apart, found.probability, onset_s

    def namings(self, d_prime: Array, reports: Array, pool: Pool, middle: Array) -> SubsetIdentification:
        """The namings of every person, for goals and the objectives that count errors."""
        lapse = np.array([self.observer.lapse]) if self.crowd is None else self.crowd.lapse
        found = SubsetIdentification.of(d_prime, lapse, reports, pool.durations_s, self.seed)
        return replace(found, middle=middle, parts=self.parts)

    def score(self, candidates: Sequence[Candidate]) -> float:
        """The objective of a whole set, or its margin of the goal."""
        pool, d, reports, _ = self.felt(candidates)
        middle = np.median(d, axis=0)
        if self.objective == "worst" and not self.parts:
            return nearest_pair(middle, range(len(pool)))
        return self.namings(d, reports, pool, middle).score(range(len(pool)), self.objective)


class SearchRun:
    """Pools of icons about the best set so far; the best set in each pool is looked for as in `choose`.

    `fixed` icons stay, and `free` places are for members of the families; with `each`, every family has one place.
    `tried` counts icons.
    """

    def __init__(self, icons: IconSet, count: int | None) -> None:
        fixed, self.free = split_icons(icons, count)
        self.fixed = [Candidate(icon) for icon in fixed]
        self.families, self.each = icons.families, count is None
        self.must = tuple(range(len(fixed)))
        self.count = len(fixed) + self.free
        self.tried = 0

    def start(self, judge: Evaluator, rng: np.random.Generator) -> list[Candidate]:
        """The best of the members that the families count out, or of a sample of them."""
        self._check_fixed(judge)
        pool = [*self.fixed, *sample_candidates(self.families, SAMPLED, rng)]
        if (found := self.best(pool, judge)) is None:
            raise ChoiceError(self._nothing(judge, pool))
        return found

    def _check_fixed(self, judge: Evaluator) -> None:
        """Refuse icons that no search changes where fewer than half of plays, or than the goal asks, are reported."""
        asked = None if judge.goal is None else judge.goal.least_detected
        least = FELT_FROM if asked is None else asked
        shares = judge.felt(self.fixed)[2].mean(axis=0).tolist() if self.fixed else []
        for each, share in zip(self.fixed, shares, strict=True):
            if share < least:
                raise ChoiceError(
                    f"{each.icon.name} is no family, so that it stays in every set, but is detected in "
                    f"{100.0 * share:.0f} % of trials only: leave it out of the file, make it a family, or ask for "
                    "detected >= a smaller share in the goal"
                )

    def improve(
        self,
        held: list[Candidate],
        judge: Evaluator,
        rounds: int,
        batch: int,
        rng: np.random.Generator,
        step: float,
        tell: Callable[[int, list[Candidate]], None],
    ) -> list[Candidate]:
        """The best set of pools that surround the best before, in steps that shrink where nothing better is found."""
        for _ in range(rounds):
            about = held[len(self.fixed) :]
            near = [candidate.moved(rng, step * float(rng.exponential())) for candidate in about for _ in range(batch)]
            pool = [*held, *(candidate for candidate in near if candidate is not None)]
            better = self.best(pool, judge, held) or held
            moved = [g.icon for g in better] != [g.icon for g in held]
            held, step = better, step if moved else max(SHRINK * step, FINEST)
            tell(self.tried, held)
        return held

    def best(
        self, candidates: list[Candidate], judge: Evaluator, held: list[Candidate] | None = None
    ) -> list[Candidate] | None:
        """The best set out of a pool that begins with the held one, plain icons first; None: no set can be played.

        Where each family gives one icon, its members are `ALIKE` in the median.
        """
        self.tried += len(candidates)
        pool, d, reports, onset_s = judge.felt(candidates)
        good = self._good(pool, reports, onset_s, judge)
        if len(good) < self.count:
            return None
        left, d, pool, reports = (
            [candidates[k] for k in good],
            d[:, good][:, :, good],
            pool.some(good),
            reports[:, good],
        )
        family = np.array([-1 if one.family is None else self.families.index(one.family) for one in left])
        middle, limits = np.median(d, axis=0), pool.limits(*judge.totals)
        if self.each:
            middle[(family[:, None] == family) & (family >= 0)] = ALIKE
        first = max_min_subset(middle, self.count, self.must, limits)
        if first is None or nearest_pair(middle, first.chosen) <= ALIKE:
            return None
        chosen = list(first.chosen)
        if judge.objective != "worst" or judge.parts:
            begin, namings = chosen if held is None else range(self.count), judge.namings(d, reports, pool, middle)
            chosen = climb(namings, begin, judge.objective, middle, self.must, limits)[0]
        return [left[k] for k in sorted(chosen, key=lambda k: (k not in self.must, family[k], k))]

    def _good(self, pool: Pool, reports: Array, onset_s: Array, judge: Evaluator) -> list[int]:
        reasons = pool.objections(judge.goal, reports.mean(axis=0), onset_s)
        return [k for k, reason in enumerate(reasons) if k in self.must or reason is None]

    def _nothing(self, judge: Evaluator, candidates: list[Candidate]) -> str:
        """Why no set of the first pool can be chosen."""
        pool, _, reports, onset_s = judge.felt(candidates)
        objections = pool.objections(judge.goal, reports.mean(axis=0), onset_s)
        bad = [reason for reason in objections if reason is not None]
        left = pool.some(self._good(pool, reports, onset_s, judge))
        first = f", the first of which {bad[0]}" if bad else ""
        over = f"; the totals: {left.totals_text(self.count, *judge.totals)}" if any(judge.totals) else ""
        return (
            f"no {self.count} icons can be chosen within the limits: {len(bad)} of {len(pool)} that were tried cannot "
            f"be chosen at all{first}{over}"
        )


def split_icons(icons: IconSet, count: int | None) -> tuple[list[Icon], int]:
    """Plain icons, which stay, and how many icons are free.

    Raises `ChoiceError` for a file without families, and for numbers of icons that leave nothing to search.
    """
    if not icons.families:
        raise ChoiceError("nothing to search: the file has no family, such as icon dip(depth in 1..6 step 1 °C) { … }")
    for family in icons.families:
        if next(iter(played_icons(family.template)), None) is not None:
            raise ChoiceError(f"family {family.name} plays another icon, which a search cannot carry along")
    fixed = [entry for entry in icons.entries if isinstance(entry, Icon)]
    wanted = len(fixed) + len(icons.families) if count is None else count
    if wanted < 2:
        raise ChoiceError("one icon is never confused: give a second family, or ask for 2 or more").to(count=2)
    if wanted <= len(fixed):
        raise ChoiceError(f"{wanted} icons leave nothing to search: {len(fixed)} that are not families must stay")
    return fixed, wanted - len(fixed)
