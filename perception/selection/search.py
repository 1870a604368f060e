"""Search of families for a better set.

The best set among the listed members of the families is surrounded by slightly different icons; the best set of that
pool is found as in `choose`, surrounded again, and so on, in shrinking steps: first for the nominal person, then for a
few people. The sets that are held at the end (the start and the best of each climb) are evaluated for all people; the
one that comes nearest to the goal, or has the best objective, is the result.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self, Unpack

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array
from thermicon.circuit.rig.rig import AnyRig, Rig
from thermicon.icons import Icon, IconSet
from thermicon.icons.files.shipped import Icons, set_of

from ..identification.new_laboratory import DRAWS
from ..kernels.parallel import Progress
from ..observer.channels import forms_in
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
    rig, wanted = Rig.of(rig, icons.context.site), Goal.parse(goal) if isinstance(goal, str) else goal
    model = crowd.model
    crowd = crowd.but(observer=model)  # a file is read once
    if wanted is not None:
        wanted.check_count(count)
        if count is None and (least := wanted.of("count")) is not None:
            count = int(least)
    run, draws, parts = SearchRun(icons, count), model.draw_count(parameters, DRAWS), list[GoalPart]()
    if wanted is not None:
        wanted.check_draws(draws)
        # Those for a share of people first.
        judged = [part for part in wanted.parts if part in wanted.of_sets or part.quantity == "detected"]
        parts = sorted(judged, key=lambda part: (part.people is None, -(part.people or 0.0)))
    nominal = Evaluator(rig, objective, forms_in(crowd.memory)[0], crowd.seed, model.nominal, crowd.tracking, wanted)
    few = replace(nominal, crowd=model.people(PEOPLE, crowd.seed))
    rng = np.random.default_rng(np.random.SeedSequence([crowd.seed, 8]))

    def as_set(of: list[Candidate]) -> IconSet:
        return set_of_run(icons, of, rig, FOUND, FOUND, f"seed {crowd.seed}")

    def tell(tried: int, held: list[Candidate]) -> None:
        if progress is not None:
            progress(min(tried, evaluations), evaluations)
        if best_so_far is not None:
            best_so_far(as_set(held))

    start = run.start(few, rng)  # as a choice would
    tell(run.tried, start)
    rounds = max(0, round((evaluations - run.tried) / (BATCH * run.free)))
    climbed = run.improve(start, nominal, rounds, BATCH, rng, WIDEST, tell)
    screened, higher = run.tried, max((start, climbed), key=few.score)
    refined = run.improve(higher, few, max(1, rounds // PER_ROUND), REFINING, rng, REFINED, tell)
    different = {frozenset(one.icon.name for one in each): each for each in (start, refined, climbed)}
    finalists = list(different.values())
    appraised = Appraised.all_of(finalists, rig, crowd, draws if any(part.people is not None for part in parts) else 0)
    best = max(appraised, key=lambda each: each.merit(parts, objective))
    return SearchResult(
        found=as_set(best.candidates),
        start=tuple(as_set(start)),
        before=appraised[0].as_written,
        after=best.as_written,
        objective=objective,
        seed=crowd.seed,
        evaluations=screened,
        refined=run.tried - screened,
        at_ends=at_ends(best.candidates),
        finalists=len(finalists),
        chosen_by=" and ".join(word_of(part.quantity) + part.whose for part in parts) or objective,
    )


@dataclass(frozen=True, slots=True)
class Appraised:
    """A set that is held at the end, appraised by all people.

    `persons` are values of single people of all draws, as in `rank`, for parts of a goal about a share of people.
    """

    candidates: list[Candidate]
    scores: Appraisal
    persons: Mapping[str, Array]

    @classmethod
    def all_of(cls, finalists: Sequence[list[Candidate]], rig: Rig, crowd: Crowd, draws: int) -> list[Self]:
        """Appraise several sets, and single people where there are draws."""
        appraised = []
        for candidates in finalists:
            icons, persons = tuple(candidate.icon for candidate in candidates), dict[str, Array]()
            scores = appraise(icons, rig, crowd=crowd)
            if draws and (known := rank(icons, rig, crowd=crowd, parameters=draws).new_laboratory) is not None:
                persons = dict(known.persons)
            appraised.append(cls(candidates, scores, persons))
        return appraised

    @property
    def as_written(self) -> Appraisal:
        """The scores, with the worst pair by the names that a file gives."""
        of = self.candidates
        names = dict(zip((candidate.icon.name for candidate in of), names_of(of), strict=True))
        a, b = self.scores.worst_pair
        return replace(self.scores, worst_pair=(names[a], names[b]))

    def merit(self, parts: Sequence[GoalPart], objective: Objective) -> tuple[float, ...]:
        """The order of sets: the least margin of the goal, then values of its parts, then of the objective."""
        scores = self.scores
        means = {
            "felt_and_named": scores.felt_and_named,
            "named": scores.proportion_correct,
            "detected": float(scores.detected.min()),
            "bits": scores.information_bits,
            "d_prime": scores.d_prime,
        }
        values = [
            means[part.quantity]
            if part.people is None
            else float(np.quantile(self.persons[part.quantity], 1.0 - part.people))
            for part in parts
        ]
        margins = [float(part.margin(value)) for part, value in zip(parts, values, strict=True)]
        return (min(margins, default=0.0), *values, scores.value(objective))
