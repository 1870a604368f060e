"""Search of families for a better set.

The best set among the listed members of the families is surrounded by slightly different icons; the best set of that
pool is found as in `choose`, surrounded again, and so on, in shrinking steps: first for the nominal person, then for a
few people. The sets that are held at the end (the start and the best of each climb) are evaluated for all people; the
one that comes nearest to the goal, or has the best objective, is the result.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array
from thermicon.circuit.rig.rig import AnyRig, Rig
from thermicon.icons import Icon, IconSet
from thermicon.icons.files.shipped import Icons, set_of

from ..identification.new_laboratory import DRAWS
from ..kernels.parallel import Progress
from ..observer.observer_model import EVERYBODY, Crowd, CrowdWords
from ..ranking.rank import rank
from .appraise import Appraisal, appraise
from .candidates import FOUND, Candidate, at_ends, names_of, set_of_run
from .goal import Goal, GoalPart, word_of
from .request import Objective
from .search_run import PEOPLE, Evaluator, SearchRun

EVALUATIONS = 2000
BATCH = 16
REFINING = 4
PER_ROUND = 3
"""Each round tries 16 variants per icon on the nominal person; a third as many rounds try 4 on a few people."""
WIDEST, REFINED = 0.25, 0.05
"""First steps of both climbs, as shares of the range of a parameter."""


@dataclass(frozen=True, slots=True)
class SearchResult:
    """The best set and the starting set, each appraised by all people, and how they were found.

    Attributes
    ----------
    found, start
        The best set, and the icons that the search started from.
    before, after
        Scores of the starting and of the best set.
    objective, seed
        What was maximised, and the seed of the search.
    evaluations, refined
        Number of icons evaluated for the nominal person, and of those tried on a few people near the best sets.
    at_ends
        Parameters of found members that lie at an end of their range, in words.
    finalists, chosen_by
        Number of different sets that were held at the end, and what the result was chosen by among them, in words.
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
    finalists: int = 1
    chosen_by: str = ""

    def __repr__(self) -> str:
        before, after = self.before.value(self.objective), self.after.value(self.objective)
        return f"SearchResult({len(self.found)} icons by {self.objective}: {before:.3g} → {after:.3g})"


@checked
def search(
    icons: Icons,
    rig: AnyRig = None,
    *,
    crowd: Crowd = EVERYBODY,
    count: int | None = None,
    objective: Objective = "worst",
    evaluations: int = EVALUATIONS,
    goal: Goal | str | None = None,
    parameters: int | None = None,
    progress: Progress | None = None,
    best_so_far: Callable[[IconSet], None] | None = None,
    **words: Unpack[CrowdWords],
) -> SearchResult:
    """Search the parameters of the families for a better set: one icon per family, or `count` in all.

    Icons of the file that are not families stay as they are. Spans are continuous between their ends, counts and lists
    are not. A set with an icon that is not safe or not reached is refused. The search begins from the best choice of
    the members that the families count out, and does not end below it. Same arguments, same set.

    Parameters
    ----------
    icons
        The set with its families, or its name or file.
    rig
        The rig that plays it, or its name or file; None: the shipped rig of the icons' site, else thenar.
    crowd
        Who appraises the result; its seed is also that of the search.
    count
        Number of icons in all; None: one per family.
    objective
        What is maximised: `worst` (d′ of the worst pair), `felt-and-named`, `named`, `bits` or `bits-per-s`.
    evaluations
        Number of icons that are evaluated for the nominal person.
    goal
        What is wanted of the set: its `count`, `time` and `energy` are kept, and icons left out that miss its
        `safety`, `detected` or `onset`, at first for the nominal person, then for people. What is maximised is the
        least margin of its other parts, of means until the sets held at the end are judged by all people. `rank` says
        whether the result meets it.
    parameters
        Draws from the posterior, as in `rank`, for a goal for a share of people (None: 128, or as many as there are).
    progress
        Called with (steps done, steps in all).
    best_so_far
        Called with the set that the search starts from, and with that which it holds after each of its rounds.
    **words
        Single words of the crowd, such as ``people=50``.

    Returns
    -------
    SearchResult
        The set that was found, and the one it started from.

    Raises
    ------
    ChoiceError
        For a file without families, for fewer than two icons, or where no set can be played.
    ValueError
        For draws that there are not, and a goal for a share of people without draws to judge it by.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import parse
    >>> text = "cue 1; icon dip { cool by 3 K at 2 K/s }; icon glow(k in 1..4 step 1 K) { warm by k at 2 K/s }"
    >>> result = search(parse(text), Rig.load("thenar"), evaluations=20, people=2)
    >>> result.after.d_prime >= result.before.d_prime
    True
    """
    icons, crowd = set_of(icons), crowd.but(**words)
    rig, seed, wanted = Rig.of(rig, icons.context.site), crowd.seed, Goal.parse(goal) if isinstance(goal, str) else goal
    if wanted is not None:
        wanted.check_count(count)
    if count is None and wanted is not None and wanted.of("count") is not None:
        count = int(wanted.of("count") or 0)
    run, model = SearchRun(icons, count), crowd.model
    crowd = crowd.but(observer=model)  # a file is read once
    nominal = Evaluator(rig, objective, crowd.memory, seed, model.nominal, crowd.tracking, wanted)
    few = replace(nominal, crowd=model.people(PEOPLE, seed))
    draws, parts = model.draw_count(parameters, DRAWS), () if wanted is None else _judging(wanted)
    if wanted is not None:
        wanted.check_draws(draws)

    def as_set(candidates: list[Candidate]) -> IconSet:
        return set_of_run(icons, candidates, rig, FOUND, FOUND, f"seed {seed}")

    def tell(tried: int, held: list[Candidate]) -> None:
        if progress is not None:
            progress(min(tried, evaluations), evaluations)
        if best_so_far is not None:
            best_so_far(as_set(held))

    start, finalists, screened = _climbed(run, nominal, few, evaluations, tell)
    sets = [tuple(candidate.icon for candidate in candidates) for candidates in finalists]
    scores = [appraise(of_set, rig, crowd=crowd) for of_set in sets]
    persons: list[dict[str, Array]] = [{} for _ in sets]
    if any(part.people is not None for part in parts):
        ranked = [rank(of_set, rig, crowd=crowd, parameters=draws) for of_set in sets]
        persons = [one.new_laboratory.persons for one in ranked if one.new_laboratory is not None]
    place = max(range(len(sets)), key=lambda k: _merit(parts, objective, scores[k], persons[k]))
    best = finalists[place]
    return SearchResult(
        found=as_set(best),
        start=tuple(as_set(start)),
        before=_as_written(scores[0], start),
        after=_as_written(scores[place], best),
        objective=objective,
        seed=seed,
        evaluations=screened,
        refined=run.tried - screened,
        at_ends=at_ends(best),
        finalists=len(finalists),
        chosen_by=" and ".join(word_of(part.quantity) + part.whose for part in parts) or objective,
    )


def _judging(goal: Goal) -> Sequence[GoalPart]:
    """Parts of a goal that the sets held at the end are judged by, those for a share of people first."""
    judged = [part for part in goal.parts if part in goal.of_sets or part.quantity == "detected"]
    return sorted(judged, key=lambda part: (part.people is None, -(part.people or 0.0)))


def _climbed(
    run: SearchRun, nominal: Evaluator, few: Evaluator, evaluations: int, tell: Callable[[int, list[Candidate]], None]
) -> tuple[list[Candidate], list[list[Candidate]], int]:
    """The start, the different sets that are held at the end, and how many icons the nominal person evaluated."""
    rng = np.random.default_rng(np.random.SeedSequence([nominal.seed, 8]))
    start = run.start(few, rng)  # as a choice would
    tell(run.tried, start)
    rounds = max(0, round((evaluations - run.tried) / (BATCH * run.free)))
    last = max(1, rounds // PER_ROUND)
    held = run.improve(start, nominal, rounds, BATCH, rng, WIDEST, tell)
    screened = run.tried
    best = run.improve(max((start, held), key=few.score), few, last, REFINING, rng, REFINED, tell)
    different = {frozenset(one.icon.name for one in each): each for each in (start, best, held)}
    return start, list(different.values()), screened


def _as_written(scores: Appraisal, candidates: list[Candidate]) -> Appraisal:
    """The scores, with the worst pair under the names that a file gives its icons."""
    names = dict(zip((candidate.icon.name for candidate in candidates), names_of(candidates), strict=True))
    a, b = scores.worst_pair
    return replace(scores, worst_pair=(names[a], names[b]))


def _merit(
    parts: Sequence[GoalPart], objective: Objective, scores: Appraisal, persons: dict[str, Array]
) -> tuple[float, ...]:
    """The order of sets: the least margin of the goal, then values of its parts, then of the objective.

    `persons` are values of single people of all draws, as in `rank`, for parts about a share of people.
    """
    means = {
        "felt_and_named": scores.felt_and_named,
        "named": scores.proportion_correct,
        "detected": float(scores.detected.min()),
        "bits": scores.information_bits,
        "d_prime": scores.d_prime,
    }
    values = [
        means[part.quantity] if part.people is None else float(np.quantile(persons[part.quantity], 1.0 - part.people))
        for part in parts
    ]
    margins = [float(part.margin(value)) for part, value in zip(parts, values, strict=True)]
    return (min(margins, default=0.0), *values, scores.value(objective))
