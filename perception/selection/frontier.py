"""The frontier of a pool: how well the best few icons of it are distinguished, by how many they are.

For each number of icons the best choice is found as in `choose`, and judged by people who know only these icons. What
95 % of people reach depends, as in a goal, on people and on the uncertainty of the model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..arrays import Array
from ..drawn import Drawn
from ..identification.confusion import confuse
from ..identification.laboratory import DRAWS
from ..identification.run_end import RATE_HZ, run_end_s
from ..observer.channels import USUAL_NORM
from ..observer.observer import check_norm
from ..observer.observer_model import ObserverModel
from ..progress import Progress, step_counter
from ..ranking.batches import Execution, Job, collect_batches
from .appraise import identified
from .frontier_point import FrontierPoint, PointJudge
from .goal import Goal
from .nominal import end_of, sense
from .pick import limits_of, nothing_fits, pick
from .request import ChoiceError, Selection, UsableIcons, check_selection, usable_icons
from .search_request import SearchRequest, soft_finding
from .subset_identification import Objective, SubsetIdentification

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet

MOST = 12
"""Most icons that a choice has unless more are asked for."""


@dataclass(frozen=True, slots=True)
class Frontier(Drawn):
    """Best choices of rising size from one pool.

    Attributes
    ----------
    rig, rig_changes
        Name of the rig, and its changed keys.
    people, seed, norm, objective
        How choices were made and judged.
    pool
        Number of icons that could be chosen.
    excluded
        Icons that could not be chosen, and why.
    points
        The choices.
    draws
        Draws of the posterior behind `low_with_model`; 0 for none.
    goal
        The goal; None without one.

    See Also
    --------
    frontier : Makes it.
    """

    rig: str
    rig_changes: tuple[str, ...]
    people: int
    seed: int
    norm: str
    objective: Objective
    pool: int
    excluded: tuple[tuple[str, str], ...]
    points: tuple[FrontierPoint, ...]
    draws: int = 0
    goal: Goal | None = None

    def rows(self) -> list[dict[str, Any]]:
        """One plain row for each size."""
        return [
            {
                "icons": len(point.icons),
                "proportion_correct": point.proportion_correct,
                "proportion_correct_95_percent_of_people": point.low,
                "information_bits": point.information_bits,
                "d_prime": point.d_prime,
                "total_s": point.total_s,
                "total_J": point.total_J,
                "proven_best": point.optimal,
                "names": " ".join(point.icons),
                "proportion_correct_95_percent_of_people_and_model": point.low_with_model,
                "amber": " ".join(point.amber),
                "meets_goal": None if point.goal is None else point.goal.met,
            }
            for point in self.points
        ]

    def to_frame(self) -> pd.DataFrame:
        """The rows as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows())

    def __repr__(self) -> str:
        sizes = f"{len(self.points[0].icons)} to {len(self.points[-1].icons)}" if self.points else "no"
        return f"Frontier({sizes} of {self.pool} icons by {self.objective} on {self.rig}, {self.people} people)"


def frontier(
    icons: IconSet,
    rig: Rig,
    *,
    most: int = MOST,
    objective: Objective = "correct",
    people: int = 200,
    seed: int = 0,
    tracking: str | None = None,
    norm: str = USUAL_NORM,
    most_s: float | None = None,
    goal: Goal | str | None = None,
    parameters: int | None = None,
    observer: ObserverModel | Path | str | None = None,
    progress: Progress | None = None,
) -> Frontier:
    """Choose the best 2, 3, … icons of a pool, and judge each choice with people who know it alone.

    Parameters
    ----------
    icons
        The pool; families count with all their members.
    rig
        The rig that plays it.
    most
        Largest choice; fewer where the pool has fewer icons that can be played.
    objective
        What a choice maximises: `worst` (d′ of the worst pair), `correct`, `bits` or `bits-per-s`.
    people, seed, tracking, norm
        As in `rank`.
    most_s
        Most time of all chosen icons together, s; None: any.
    goal
        What is wanted: icons are left out that miss its `safety`, or for the nominal person its `detected` or `onset`,
        its `time` and `energy` are kept, and every choice is judged by it.
    parameters
        Draws from the posterior for what 95 % of people reach, as in `rank` (None: 128, or as many as there are; 0:
        none).
    observer
        An observer or its file, as in `rank`.
    progress
        Called with (steps done, steps in all).

    Returns
    -------
    Frontier
        One point for each size that can be chosen.

    Raises
    ------
    ChoiceError
        Where not even two icons can be chosen, or no two keep the limits.
    ValueError
        For an unknown norm, a single draw, and more draws than there are; a `GoalError` for a goal for a share of
        people without draws.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> found = frontier(read_cue("six-icons"), Rig.load("thenar"), people=4, most=3, parameters=0)
    >>> [len(point.icons) for point in found.points]
    [2, 3]
    """
    from thermicon.circuit.solver.simulate import duration_s, simulate_all

    members, chosen, model = list(icons), check_norm(norm), ObserverModel.of(observer)
    if most < 2:
        raise ChoiceError(f"a choice of {most} has no pair to compare: give 2 or more")
    wanted = Goal.parse(goal) if isinstance(goal, str) else goal
    draws = model.draw_count(parameters, DRAWS)
    if wanted is not None:
        wanted.check_draws(draws)
    request = SearchRequest(most_s, None, wanted)
    time, energy = request.totals
    asked = Selection(2, objective, most_s=time, most_J=energy)
    check_selection(asked, [icon.name for icon in members])
    end = run_end_s(duration_s(icon, rig) for icon in members)
    traces = list(simulate_all(members, rig, end_s=end, rate_Hz=RATE_HZ))
    pool = usable_icons(asked, members, traces, rig)
    if wanted is not None:
        pool = _fit_for(request, members, pool, rig, model)
    amber = {members[k].name for k in pool.places if soft_finding(traces[k])}
    able = [members[k] for k in pool.places]
    job = Job(tuple(able), rig, end, people, seed, 1, tracking, chosen, observer=model.for_jobs())
    largest = min(most, len(able))
    step = step_counter(progress, job.batches + largest - 1)
    pooled, crowd = collect_batches(job, Execution(), step), model.people(people, seed)

    def named(places: Sequence[int]) -> Array:
        """Confusions of people who know only these icons; what is named directly is felt again."""
        if chosen == "naming":
            alone = [able[k] for k in places]
            return identified(alone, rig, crowd, tracking, chosen, seed=seed, observer=model.nominal)[1].probability
        own = pooled.d_prime[:, places][:, :, places]
        return confuse(own, lapse=crowd.lapse, seed=seed).probability

    names = [icon.name for icon in able]
    judge = PointJudge(pooled, crowd, pool, names, amber, chosen, model, draws, seed, wanted, named)
    namings = SubsetIdentification.of(pooled.d_prime, crowd.lapse, pool.durations_s, seed)
    limits = limits_of(asked, pool)
    points: list[FrontierPoint] = []
    for count in range(2, largest + 1):
        picked = pick(pooled.middle, namings, count, objective, (), limits, seed)
        if picked is None:
            break
        points.append(judge.point(picked))
        step()
    for _ in range(len(points) + 1, largest):  # sizes that no longer keep the limits
        step()
    if not points:
        raise ChoiceError(nothing_fits(asked, pool))
    changes = tuple(rig.changes)
    return Frontier(
        rig.name, changes, people, seed, chosen, objective, len(able), pool.excluded, tuple(points), draws, wanted
    )


def _fit_for(
    request: SearchRequest, members: Sequence[Icon], pool: UsableIcons, rig: Rig, model: ObserverModel
) -> UsableIcons:
    """The pool without icons that miss what a goal asks of single icons; the same as in a search."""
    from thermicon.circuit.solver.simulate import duration_s

    able = [members[k] for k in pool.places]
    felt = sense(able, rig, end_of([duration_s(icon, rig) for icon in able]), model.nominal)
    reasons = request.objections(felt, model.nominal, rig)
    left = [place for place, reason in enumerate(reasons) if reason is None]
    missed = [(icon.name, reason) for icon, reason in zip(able, reasons, strict=True) if reason is not None]
    if len(left) < 2:
        raise ChoiceError(
            f"fewer than two of {len(members)} icons are left by the goal, the first of the others: "
            f"{missed[0][0]} {missed[0][1]}"
        )
    return UsableIcons(
        tuple(pool.places[k] for k in left),
        pool.durations_s[left],
        pool.energies_J[left],
        (*pool.excluded, *missed),
    )
