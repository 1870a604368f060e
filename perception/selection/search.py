"""Search of families for a better set: their parameters are varied until the model predicts the best identification.

The best set among the listed members of the families is surrounded by slightly different icons; the best set of that
pool is found as in `choose`, surrounded again, and so on, in shrinking steps: first for the nominal person, then for a
few people. The sets that are held at the end (the start, the best for the nominal person, the best for a few people)
are evaluated for all people; the one that comes nearest to the goal, or has the best objective, is the result.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..identification.laboratory import DRAWS
from ..observer.channels import USUAL_NORM
from ..observer.observer import check_norm
from ..observer.observer_model import ObserverModel
from .appraise import Appraisal
from .candidates import Candidate, sample_candidates
from .evaluators import NominalEvaluator, PopulationEvaluator
from .finalists import FinalJudge
from .found_icons import at_ends, found_set, listed_only, names_of
from .goal import Goal
from .max_min_subset import Limits, max_min_subset, nearest_pair
from .request import ChoiceError
from .search_request import SearchRequest, split_icons
from .subset_identification import OBJECTIVES, Objective, SubsetIdentification

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Family, Icon, IconSet

Progress = Callable[[int, int], None]
EVALUATIONS = 2000
SAMPLED = 400
BATCH = 16
REFINING = 4
PER_ROUND = 3
"""Each round tries 16 variants per icon on the nominal person; a third as many rounds try 4 on a few people."""
WIDEST, REFINED, FINEST, SHRINK = 0.25, 0.05, 0.005, 0.85
ALIKE = -1.0
"""Stands for d′ between two members of one family, since each family gives one icon."""


@dataclass(frozen=True, slots=True)
class SearchResult:
    """The best set and the starting set, each appraised by all people, and how they were found.

    Attributes
    ----------
    found
        The best set.
    start
        Icons that the search started from.
    before, after
        Scores of the starting and of the best set.
    objective
        What was maximised.
    seed
        Seed of the search.
    evaluations
        Number of icons evaluated for the nominal person.
    refined
        Number of them that were tried after the first sample, near the best sets.
    at_ends
        Parameters of found members that lie at an end of their range, in words.
    listed
        Parameters with a unit that only take listed values, in words.
    finalists
        Number of different sets that were held at the end.
    chosen_by
        What the result was chosen by among them, in words.

    See Also
    --------
    search : Returns a result.
    """

    found: IconSet
    start: tuple[Icon, ...]
    before: Appraisal
    after: Appraisal
    objective: Objective
    seed: int
    evaluations: int
    refined: int
    at_ends: tuple[str, ...] = ()
    listed: tuple[str, ...] = ()
    finalists: int = 1
    chosen_by: str = ""

    def __repr__(self) -> str:
        before, after = self.before.value(self.objective), self.after.value(self.objective)
        return f"SearchResult({len(self.found)} icons by {self.objective}: {before:.3g} → {after:.3g})"


def search(
    icons: IconSet,
    rig: Rig,
    *,
    count: int | None = None,
    objective: Objective = "worst",
    evaluations: int = EVALUATIONS,
    people: int = 200,
    seed: int = 0,
    tracking: str | None = None,
    norm: str = USUAL_NORM,
    must: Sequence[str] | None = None,
    most_s: float | None = None,
    most_J: float | None = None,
    goal: Goal | str | None = None,
    parameters: int = DRAWS,
    observer: ObserverModel | Path | str | None = None,
    progress: Progress | None = None,
) -> SearchResult:
    """Search the parameters of the families for a better set: one icon per family, or `count` in all.

    Icons of the file that are not families stay as they are. Spans are continuous between their ends, counts and lists
    are not. A set with an icon that is not safe or not reached is refused. Same arguments, same set.

    Parameters
    ----------
    icons
        The set with its families.
    rig
        The rig that plays it.
    count
        Number of icons in all; None: one per family.
    objective
        What is maximised: `worst` (d′ of the worst pair), `correct`, `bits` or `bits-per-s`.
    evaluations
        Number of icons that are evaluated for the nominal person.
    people, seed
        Number of virtual people who appraise the result, and the seed of people, noise and search.
    tracking
        What every person gets: `replay`, `display` or `ideal`; None: what suits the control of each icon.
    norm
        What is remembered, as in `rank`.
    must
        Names of the icons of the file that are not families and must stay; None: all of them stay.
    most_s, most_J
        Most time in s and energy in J of all icons together; None: any.
    goal
        What is wanted of the set: its `count`, `time` and `energy` are kept, and icons left out that miss its
        `safety`, or for the nominal person its `detected` or `onset`. Of the sets held at the end, that which comes
        nearest to its other parts is the result. `rank` tells whether the result meets it.
    parameters
        Draws from the posterior, as in `rank`: for a goal for a share of people.
    observer
        An observer or its file, as in `rank`; None: the shipped one.
    progress
        Called with (steps done, steps in all).

    Returns
    -------
    SearchResult
        The set that was found, and the one it started from.

    Raises
    ------
    ChoiceError
        For a file without families, for fewer than two icons, or where no set can be played.
    ValueError
        For an unknown norm, and for a goal for a share of people without draws to judge it by.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import parse
    >>> text = "cue 1; icon dip { cool by 3 K at 2 K/s }; icon glow(k in 1..4 step 1 K) { warm by k at 2 K/s }"
    >>> result = search(parse(text), Rig.load("thenar"), evaluations=20, people=2)
    >>> result.after.d_prime >= result.before.d_prime
    True
    """
    if objective not in OBJECTIVES:
        raise ChoiceError(f"the objective is one of {', '.join(OBJECTIVES)}, not {objective!r}")
    wanted = Goal.parse(goal) if isinstance(goal, str) else goal
    if wanted is not None:
        wanted.check_count(count)
    if count is None and wanted is not None and wanted.of("count") is not None:
        count = int(wanted.of("count") or 0)
    fixed, optional, free = split_icons(icons, count, must)
    run, named = _Run(fixed, optional, icons.families, free, count is None), check_norm(norm)
    model, request = ObserverModel.of(observer), SearchRequest(most_s, most_J, wanted)
    nominal, few = (
        NominalEvaluator(rig, objective, named, seed, model, request),
        PopulationEvaluator(rig, objective, named, seed, model, tracking, request),
    )
    judge = FinalJudge(rig, objective, named, model, model.people(people, seed), seed, tracking, parameters, wanted)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 8]))

    def tell(tried: int) -> None:
        if progress is not None:
            progress(min(tried, evaluations), evaluations)

    start = run.start(nominal, rng)
    rounds = max(0, round((evaluations - run.tried) / (BATCH * free)))
    held = run.improve(start, nominal, rounds, BATCH, rng, WIDEST, tell)
    screened = run.tried
    best = run.improve(few.better(start, held), few, max(1, rounds // PER_ROUND), REFINING, rng, REFINED, tell)
    finalists = _different([start, best, held])
    scores = [judge.appraisal([gene.icon for gene in genes]) for genes in finalists]
    merits = [judge.merit([gene.icon for gene in genes], score) for genes, score in zip(finalists, scores, strict=True)]
    place = max(range(len(finalists)), key=lambda k: merits[k])
    best, after = finalists[place], scores[place]
    names = dict(zip((gene.icon.name for gene in best), names_of(best), strict=True))
    a, b = after.worst_pair
    return SearchResult(
        found=found_set(icons, best, seed),
        start=tuple(gene.icon for gene in start),
        before=scores[0],
        after=replace(after, worst_pair=(names[a], names[b])),
        objective=objective,
        seed=seed,
        evaluations=screened,
        refined=run.tried - screened,
        at_ends=at_ends(best),
        listed=listed_only(best),
        finalists=len(finalists),
        chosen_by=judge.words or objective,
    )


def _different(sets: Sequence[list[Candidate]]) -> list[list[Candidate]]:
    """Each set once, by its icons."""
    return list({tuple(gene.icon.name for gene in genes): genes for genes in sets}.values())


class _Run:
    """Pools of icons about the best set so far; the best set in each pool is looked for as in `choose`."""

    def __init__(
        self, fixed: tuple[Icon, ...], optional: tuple[Icon, ...], families: tuple[Family, ...], free: int, each: bool
    ) -> None:
        self.fixed, self.optional = [Candidate(icon) for icon in fixed], [Candidate(icon) for icon in optional]
        self.families, self.free, self.each = families, free, each
        self.tried = 0

    def start(self, judge: NominalEvaluator | PopulationEvaluator, rng: np.random.Generator) -> list[Candidate]:
        """The best of the members that the families count out, or of a sample of them."""
        pool = [*self.fixed, *self.optional, *sample_candidates(self.families, SAMPLED, rng)]
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
        tell: Any,
    ) -> list[Candidate]:
        """The best set of pools that surround the best before, in steps that shrink where nothing better is found."""
        for _ in range(rounds):
            about = held[len(self.fixed) :]
            near = [gene.moved(rng, step * float(rng.exponential())) for gene in about for _ in range(batch)]
            others = [gene for gene in self.optional if gene not in held]
            pool = [*held, *others, *(gene for gene in near if gene is not None)]
            better = self.best(pool, judge, held)
            moved = better is not None and [g.icon for g in better] != [g.icon for g in held]
            held = better if better is not None else held
            step = step if moved else max(SHRINK * step, FINEST)
            tell(self.tried)
        return held

    def best(
        self, pool: list[Candidate], judge: NominalEvaluator | PopulationEvaluator, held: list[Candidate] | None
    ) -> list[Candidate] | None:
        """The best set out of a pool, plain icons first; None where no set can be played."""
        self.tried += len(pool)
        d = judge.pairwise_dprime([gene.icon for gene in pool])
        must = len(self.fixed)
        good = [k for k in range(len(pool)) if k < must or judge.objections[k] is None]
        pool, d = [pool[k] for k in good], d[:, good][:, :, good]
        if len(pool) < must + self.free:
            return None
        middle = np.median(d, axis=0)
        if self.each:
            own = np.array([self._place(gene) for gene in pool])
            middle[(own[:, None] == own) & (own >= 0)] = ALIKE
        limits = None if judge.limits is None else Limits(judge.limits.costs[:, good], judge.limits.most)
        first = max_min_subset(middle, must + self.free, tuple(range(must)), limits)
        if first is None or nearest_pair(middle, first.chosen) <= ALIKE:
            return None
        chosen = list(first.chosen)
        if judge.objective != "worst":
            begin = list(range(must + self.free)) if held is not None else chosen
            chosen = climbed(
                judge.namings(d, [gene.icon for gene in pool]), begin, judge.objective, middle, must, limits
            )
        return [pool[k] for k in sorted(chosen, key=lambda k: (k >= must, self._place(pool[k]), k))]

    def _place(self, gene: Candidate) -> int:
        return -1 if gene.family is None else self.families.index(gene.family)


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
        allowed = np.ones((len(chosen), len(middle)), dtype=bool)
        allowed[:, chosen] = False
        for place, thing in enumerate(chosen):
            rest = [k for k in chosen if k != thing]
            allowed[place] &= (middle[rest] > ALIKE).all(axis=0) & (thing >= must)
            if limits is not None:
                for k in np.flatnonzero(allowed[place]).tolist():
                    allowed[place, k] = limits.kept([*rest, k])
        found = namings.swapped(chosen, objective, allowed)
        place, other = (int(k) for k in np.unravel_index(int(found.argmax()), found.shape))
        if not found[place, other] > score + 1e-9:
            return chosen
        score, chosen[place] = float(found[place, other]), other
