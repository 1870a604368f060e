"""The frontier of a pool: how well the best few icons of it are distinguished, by how many they are.

For every number of icons the best choice is looked for as in `choose`, and judged with people who know it alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..identification.confusion import confuse
from ..identification.measures import information_bits, proportion_correct
from ..observer.channels import USUAL_NORM
from ..observer.observer import check_norm
from ..observer.observer_model import ObserverModel
from ..selection.choose import SubsetChoice, pick
from ..selection.max_min_subset import Limits
from ..selection.request import ChoiceError, Selection, UsableIcons, usable_icons
from ..selection.subset_identification import Objective, SubsetIdentification
from .batches import RATE_HZ, Execution, Job, collect_batches
from .rank import TAIL_S

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

MOST = 12
"""Most icons that a choice has unless more are asked for."""
Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class FrontierPoint:
    """The best choice of one size.

    Attributes
    ----------
    icons
        Names of the chosen.
    proportion_correct, low
        Mean over people, and what 95 % of them reach, 0–1.
    information_bits
        Information, bits.
    d_prime
        Median d′ of the worst pair.
    total_s, total_J
        Time and energy of all of them; NaN on a thermode, which states no energy.
    optimal
        Whether no other choice of the size is better by the objective.
    """

    icons: tuple[str, ...]
    proportion_correct: float
    low: float
    information_bits: float
    d_prime: float
    total_s: float
    total_J: float
    optimal: bool

    def __repr__(self) -> str:
        return (
            f"FrontierPoint({len(self.icons)} icons: {100 * self.proportion_correct:.0f} % correct, {self.total_s:g} s)"
        )


@dataclass(frozen=True, slots=True)
class Frontier:
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
            }
            for point in self.points
        ]

    def to_frame(self) -> pd.DataFrame:
        """The rows as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows())

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw proportion correct over the number of icons, with total times; return the axes."""
        from ..plots.draw_frontier import plot_frontier

        return plot_frontier(self, ax)

    def __repr__(self) -> str:
        sizes = f"{len(self.points[0].icons)} to {len(self.points[-1].icons)}" if self.points else "no"
        return f"Frontier({sizes} of {self.pool} icons by {self.objective} on {self.rig}, {self.people} people)"

    def _repr_html_(self) -> str:
        from ..plots.draw import as_svg

        return as_svg(self.plot())


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
        Where not even two icons can be chosen.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> found = frontier(read_cue("six-icons"), Rig.load("thenar"), people=4, most=3)
    >>> [len(point.icons) for point in found.points]
    [2, 3]
    """
    from thermicon.circuit import duration_s, simulate_all

    members, chosen, model = list(icons), check_norm(norm), ObserverModel.of(observer)
    if most < 2:
        raise ChoiceError(f"a choice of {most} has no pair to compare: give 2 or more")
    durations = [duration_s(icon, rig) for icon in members]
    end = math.ceil((max(durations, default=0.0) + TAIL_S) * RATE_HZ - 1e-6) / RATE_HZ
    traces = list(simulate_all(members, rig, end_s=end, rate_Hz=RATE_HZ))
    pool = usable_icons(Selection(2, objective, most_s=most_s), members, traces, rig)
    able = [members[k] for k in pool.places]
    job = Job(tuple(able), rig, end, people, seed, 1, tracking, chosen, observer=model.for_jobs())
    largest = min(most, len(able))
    steps = job.batches + largest - 1
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, steps)

    d_prime, crowd = collect_batches(job, Execution(), step).d_prime, model.people(people, seed)
    namings = SubsetIdentification.of(d_prime, crowd.lapse, pool.durations_s, seed)
    limits = Limits.none(len(able)) if most_s is None else Limits(pool.durations_s[None], (most_s,))
    points: list[FrontierPoint] = []
    for count in range(2, largest + 1):
        picked = pick(np.median(d_prime, axis=0), namings, count, objective, (), limits, seed)
        step()
        if picked is None:
            break
        points.append(_point(picked, [icon.name for icon in able], pool, d_prime, crowd.lapse, seed))
    return Frontier(
        rig.name, tuple(rig.changes), people, seed, chosen, objective, len(able), pool.excluded, tuple(points)
    )


def _point(
    picked: SubsetChoice, names: Sequence[str], pool: UsableIcons, d_prime: Array, lapse: Array, seed: int
) -> FrontierPoint:
    places = list(picked.chosen)
    own = d_prime[:, places][:, :, places]
    named = confuse(own, lapse=lapse, seed=seed).probability
    each = proportion_correct(named)
    first, second = np.triu_indices(len(places), 1)
    return FrontierPoint(
        icons=tuple(names[k] for k in places),
        proportion_correct=float(each.mean()),
        low=float(np.quantile(each, 0.05)),
        information_bits=float(information_bits(named).mean()),
        d_prime=float(np.median(own, axis=0)[first, second].min()),
        total_s=math.fsum(pool.durations_s[places]),
        total_J=math.fsum(pool.energies_J[places]),
        optimal=picked.optimal,
    )
