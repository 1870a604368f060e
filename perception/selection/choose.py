"""The best k of n icons: exact where that can be proven, else the best of seeded restarts with an upper bound.

Icons are compared at the range of the pool they come from, so that the d′ of a pair is the same in every choice; the
chosen icons are then evaluated again at their own range.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..identification.carry_over import CarryOver, task_among
from ..identification.laboratory import NewLaboratory
from ..identification.task import USUAL, Task
from ..observer.channels import USUAL_NORM
from ..observer.observer import Norm, Observer
from ..observer.people import People
from .appraise import Appraisal, appraise
from .max_min_subset import Limits, UndecidedError, max_min_subset
from .request import ChoiceError, Selection, UsableIcons, usable_icons
from .subset_identification import Objective, SubsetIdentification
from .upper_bounds import upper_bound

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon

ENUMERATED = 20
MOST_SUBSETS = 200_000
"""Pools of up to 20 icons, and all with at most this many choices, are enumerated completely."""
RESTARTS = 6
"""Random choices that larger pools are also climbed from."""
ONE_BY_ONE = 50
"""Number of people for each of whom the best choice is found."""


@dataclass(frozen=True, slots=True)
class SubsetChoice:
    """Places of the chosen icons, the objective's value, its bound, whether it is reached, and choices examined."""

    chosen: tuple[int, ...]
    value: float
    bound: float
    optimal: bool
    seen: int


@dataclass(frozen=True, slots=True)
class Choice:
    """The chosen icons in the order of the file, and whether it is proven that no other choice is better.

    Attributes
    ----------
    icons
        Names of the chosen.
    objective
        What was maximised.
    value
        Its value at the range of the pool: median d′ of the worst pair over all people, or proportion correct, bits or
        bits a second of the first `people`.
    optimal
        Whether no other choice is better.
    bound
        A value that no choice exceeds.
    worst_pair
        Names of the pair with the smallest d′.
    total_s, total_J
        Time in s and energy in J of all chosen icons together.
    pool
        Number of icons that could be chosen.
    people
        Number of people behind `value`.
    seen
        Number of choices looked at.
    excluded
        Icons that could not be chosen, and why.
    best_share
        Share of the first 50 people for whom no other choice has a better worst pair; None but for `worst`.
    loss
        Median loss of these people, d′; None but for `worst`.
    at_own_range
        The chosen icons alone, as a set of their own.
    new_laboratory
        What a new laboratory will find with the chosen; None: not requested.

    See Also
    --------
    choose : Returns a choice.
    """

    icons: tuple[str, ...]
    objective: Objective
    value: float
    optimal: bool
    bound: float
    worst_pair: tuple[str, str]
    total_s: float
    total_J: float
    pool: int
    people: int
    seen: int
    excluded: tuple[tuple[str, str], ...]
    best_share: float | None
    loss: float | None
    at_own_range: Appraisal
    new_laboratory: NewLaboratory | None = None

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `rank --json`."""
        elsewhere = self.new_laboratory
        return {
            "icons": list(self.icons),
            "objective": self.objective,
            "value": self.value,
            "optimal": self.optimal,
            "bound": self.bound,
            "worst_pair": list(self.worst_pair),
            "total_s": self.total_s,
            "total_J": self.total_J,
            "pool": self.pool,
            "people": self.people,
            "looked_at": self.seen,
            "excluded": [{"icon": name, "reason": reason} for name, reason in self.excluded],
            "best_for_people": self.best_share,
            "median_loss": self.loss,
            "at_own_range": {
                **self.at_own_range.to_dict(),
                "proportion_correct_interval_new_laboratory": None
                if elsewhere is None
                else elsewhere.proportion_correct,
                "information_bits_interval_new_laboratory": None if elsewhere is None else elsewhere.information_bits,
                "d_prime_interval_new_laboratory": None if elsewhere is None else elsewhere.pair(*self._nearest),
                "icons": [] if elsewhere is None else elsewhere.rows(self.icons),
            },
        }

    @property
    def _nearest(self) -> tuple[int, int]:
        a, b = (self.icons.index(name) for name in self.at_own_range.worst_pair)
        return a, b

    def __repr__(self) -> str:
        how = "proven best" if self.optimal else f"none exceeds {self.bound:.3g}"
        return f"Choice({', '.join(self.icons)}: {self.objective} {self.value:.3g}, {how})"


def choose(
    asked: Selection,
    icons: Sequence[Icon],
    rig: Rig,
    traces: Sequence[Trace],
    d_prime: Array,
    crowd: People,
    *,
    seed: int = 0,
    tracking: str | None = None,
    norm: Norm = USUAL_NORM,
    task: Task = USUAL,
    left: CarryOver | None = None,
    observer: Observer | None = None,
) -> Choice:
    """Choose among icons of which the d′ of every person and the nominal traces are known.

    Parameters
    ----------
    asked
        The request.
    icons
        The pool.
    rig
        The rig that plays it.
    traces
        Nominal traces of the icons.
    d_prime
        d′ from memory (people, icons, icons).
    crowd
        The people.
    seed
        Seed of the noise of identification.
    tracking
        What every person gets: `replay`, `display` or `ideal`; None: what suits the control of each icon.
    norm
        How episodes are remembered: `episodes` or `naming`.
    task
        The task that `d_prime` was found in.
    left
        What icons leave behind for the next there; None: nothing.
    observer
        The nominal observer; None: the shipped one.

    Returns
    -------
    Choice
        The chosen icons, and whether it is proven that no other choice is better.

    Raises
    ------
    ChoiceError
        Where too few icons are usable or no choice keeps the limits.

    See Also
    --------
    rank : With `choosing`, computes what this needs and calls it.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception import rank
    >>> asked = Selection(2)
    >>> made = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0, choosing=asked)
    >>> len(made.chosen.icons)
    2
    """
    pool = usable_icons(asked, icons, traces, rig)
    places = list(pool.places)
    d = d_prime[:, places][:, :, places]
    must = [k for k, place in enumerate(places) if icons[place].name in asked.must]
    limits = limits_of(asked, pool)
    namings = None
    if asked.objective != "worst":
        favour = replace(task, places=tuple(places)).favour(0, len(d), len(places), seed)
        namings = SubsetIdentification.of(d, crowd.lapse, pool.durations_s, seed, favour=favour)
    picked = pick(np.median(d, axis=0), namings, asked.count, asked.objective, must, limits, seed)
    if picked is None:
        raise ChoiceError(nothing_fits(asked, pool))
    chosen = [places[k] for k in picked.chosen]
    names = [icons[k].name for k in chosen]
    share, loss = _for_people(d, picked, must, limits) if asked.objective == "worst" else (None, None)
    return Choice(
        icons=tuple(names),
        objective=asked.objective,
        value=picked.value,
        optimal=picked.optimal,
        bound=picked.bound,
        worst_pair=_worst_pair(np.median(d_prime, axis=0)[np.ix_(chosen, chosen)], names),
        total_s=math.fsum(pool.durations_s[list(picked.chosen)]),
        total_J=math.fsum(pool.energies_J[list(picked.chosen)]),
        pool=len(places),
        people=len(d) if namings is None else len(namings.lapse),
        seen=picked.seen,
        excluded=pool.excluded,
        best_share=share,
        loss=loss,
        at_own_range=appraise(
            [icons[k] for k in chosen],
            rig,
            people=crowd,
            seed=seed,
            tracking=tracking,
            norm=norm,
            task=task_among(task, left, chosen),
            observer=observer,
        ),
    )


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


def _for_people(d: Array, picked: SubsetChoice, must: Sequence[int], limits: Limits) -> tuple[float, float]:
    """Share of people for whom no other choice has a better worst pair, and the median loss (d′)."""
    own = list(picked.chosen)
    losses = []
    for one in d[:ONE_BY_ONE]:
        mine = float(one[np.ix_(own, own)][np.triu_indices(len(own), 1)].min())
        best = max_min_subset(one, len(own), must, limits, ties=False)
        losses.append(max(0.0, (mine if best is None else best.value) - mine))
    return float(np.mean(np.array(losses) <= 1e-9)), float(np.median(losses))


def _worst_pair(middle: Array, names: Sequence[str]) -> tuple[str, str]:
    first, second = np.triu_indices(len(names), 1)
    k = int(middle[first, second].argmin())
    return names[first[k]], names[second[k]]


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
