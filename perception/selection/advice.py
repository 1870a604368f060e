"""Ways to a goal that a set misses: each is tried with the same people and draws before it is offered.

The cheapest come first: edits of the icons (hardly felt ones louder, close ones farther apart), fewer icons, a larger
contact.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from thermicon.circuit import Rig
from thermicon.icons import Icon
from thermicon.icons.model.context import Metadata

from ..criteria import DISTINGUISHABLE_DPRIME
from ..observer.observer_model import Crowd
from ..ranking.batches import Job
from ..ranking.rank import rank
from ..ranking.ranking import Ranking
from .choose import Choice, Chooser
from .edit import Edit, NoEdit, cheapest_edit
from .goal import Goal
from .goal_result import GoalPartResult, GoalResult, judge_goal
from .louder import louder
from .request import ChoiceError, Selection

Edits = Mapping[tuple[str, str], Edit | NoEdit]
ALMOST = 0.1
"""Icons are made so loud that people miss as many plays as the goal allows, then so small a share of these."""
FEW, HOPELESS = 24, -0.08
"""People and draws that judge a way first, and the margin below which it is left at that."""
CAREFUL = 2
"""Of so many numbers of icons the next best choices are judged too."""
FURTHER = 1.3
"""The worst pair is also edited to be so many times farther apart than it is."""
LARGER = (2.0, 4.0)
"""Contacts that are tried, times that of the rig."""
MOST_PAIRS = 6
"""Pairs, those confused most, that edits are looked for."""


@dataclass(frozen=True, slots=True)
class Way:
    """A change that was tried: `edits`, a `choice` of fewer icons, `must` among them, or a contact of `area_cm2`; and
    the goal with it. A `rough` one was left at what a few people and draws find, since it is far from the goal.
    """

    result: GoalResult
    rough: bool = False
    edits: tuple[Edit, ...] = ()
    choice: Choice | None = None
    area_cm2: float | None = None
    must: tuple[str, ...] = ()

    def after(self, before: GoalPartResult) -> GoalPartResult:
        """The part of the goal that was one before, with this change."""
        return next(each for each in self.result.parts if each.part == before.part)


def compatible(edits: Sequence[Edit | NoEdit]) -> tuple[Edit, ...]:
    """The edits that can be made together, the first of each icon."""
    first: dict[str, Edit] = {}
    for each in edits:
        if isinstance(each, Edit):
            first.setdefault(each.icon, each)
    return tuple(first.values())


def with_edits(icons: Sequence[Icon], edits: Sequence[Edit]) -> tuple[Icon, ...]:
    """The icons with edits made; who wrote an icon did not write its edit."""
    new = {each.icon: each.edited for each in edits}
    return tuple(
        replace(new[icon.name], metadata=Metadata(icon.metadata.means, tags=icon.metadata.tags))
        if icon.name in new
        else icon
        for icon in icons
    )


def ranked_as(job: Job, crowd: Crowd, icons: Sequence[Icon], draws: int, rig: Rig | None = None) -> Ranking:
    """Other icons, or the same on another rig, as the people and draws of a job find them."""
    where = job.rig if rig is None else rig
    return rank(tuple(icons), where, crowd=crowd, trials=job.trials, task=job.task, parameters=draws)


def until_met(ways: Iterable[Way]) -> tuple[Way, ...]:
    """The ways that were tried, one after the other, until one met the goal."""
    tried: list[Way] = []
    for way in ways:
        tried.append(way)
        if way.result.met:
            break
    return tuple(tried)


def ways_to(
    ranking: Ranking,
    missed: GoalResult,
    draws: int,
    edits: Edits,
    choice: Choice | None = None,
    must: tuple[str, ...] = (),
) -> Iterator[Way]:
    """Try ways to a goal that the set, or a choice out of it, misses, the cheapest first."""
    job, goal = ranking.job, missed.goal
    if choice is None and all(icon.playable for icon in ranking.icons) and _felt(missed):
        for some in _edits(ranking, missed, edits):
            if (found := _judged(job, ranking.crowd, with_edits(job.icons, some), goal, draws)) is not None:
                yield replace(found, edits=some)
    if _wrong(missed) != {"count"}:
        yield from _fewer(ranking, goal, draws, len(ranking.icons) if choice is None else len(choice.icons), must)
    names = ranking.labels if choice is None else choice.icons
    yield from contacts_to(job, ranking.crowd, [icon for icon in job.icons if icon.name in names], missed, draws)


def _fewer(ranking: Ranking, goal: Goal, draws: int, fewer_than: int, must: tuple[str, ...]) -> Iterator[Way]:
    """The best choices of fewer icons that have any hope, the largest first; then the nearest ones chosen with care."""
    asked = Selection(max(2, int(goal.of("count") or 2)), goal.objective, must, *goal.totals)
    chooser = Chooser(ranking.job, ranking.model, asked, goal, ranking.carry_over)
    try:
        chooser.feel(ranking.felt)
    except ChoiceError:
        return
    counts = range(min(fewer_than - 1, len(chooser.pool)), asked.count - 1, -1)
    hopeful = [count for count in counts if not goal.of_sets or chooser.hopes(count) >= HOPELESS]
    near: list[Way] = []
    for alone in (True, False):
        for count in hopeful:
            if (found := chooser.best(count, draws, lambda: None, alone=alone)) is not None:
                near.append(Way(judge_goal(goal, ranking, found), choice=found, must=must))
                yield near[-1]
        near.sort(key=lambda way: -way.result.margin)
        hopeful = [len(way.choice.icons) for way in near[:CAREFUL] if way.choice is not None and goal.of_sets]


def contacts_to(job: Job, crowd: Crowd, icons: Sequence[Icon], missed: GoalResult, draws: int) -> Iterator[Way]:
    """Try larger contacts with icons that miss a goal, where what is missed is felt."""
    for times in LARGER if _felt(missed) else ():
        area = float(f"{1e4 * times * job.rig.contact.area_m2:.3g}")
        try:
            larger = job.rig.with_(**{"contact.area_cm2": area})
        except ValueError:
            return
        if (found := _judged(job, crowd, icons, missed.goal, draws, larger)) is not None:
            yield replace(found, area_cm2=area)


def _judged(
    job: Job, crowd: Crowd, icons: Sequence[Icon], goal: Goal, draws: int, rig: Rig | None = None
) -> Way | None:
    """How icons meet a goal, roughly where a few people find them far from it; None: they cannot be played."""
    few = ranked_as(job, crowd.but(people=min(crowd.people, FEW)), icons, min(draws, FEW), rig)
    if not all(icon.playable for icon in few.icons):
        return None
    rough = judge_goal(goal, few)
    if rough.margin < HOPELESS:
        return Way(rough, rough=True)
    return Way(judge_goal(goal, ranked_as(job, crowd, icons, draws, rig)))


def _wrong(missed: GoalResult) -> set[str]:
    """What is missed."""
    return {each.part.quantity for each in missed.parts if not each.met}


def _felt(missed: GoalResult) -> bool:
    """Whether anything is missed that depends on what is felt."""
    return bool(_wrong(missed) - {"time", "energy", "count", "safety"})


def _edits(ranking: Ranking, missed: GoalResult, edits: Edits) -> Iterator[tuple[Edit, ...]]:
    """Different sets of edits, as they are found: hardly felt icons louder, then close pairs farther apart too."""
    seen: list[tuple[Edit, ...]] = [()]
    loud: tuple[Edit, ...] = ()
    for loud in _louder(ranking, missed):
        if loud not in seen:
            seen.append(loud)
            yield loud
    for some in _searched(ranking, edits) if ranking.pairs else ():
        if (both := compatible([*loud, *some])) not in seen:
            seen.append(both)
            yield both


def _louder(ranking: Ranking, missed: GoalResult) -> Iterator[tuple[Edit, ...]]:
    """Every icon that too few people feel for the goal made louder, just enough and for nearly everybody."""
    limits = [
        each.part.limit
        for each in missed.parts
        if not each.met and each.part.quantity in ("felt_and_named", "detected")
    ]
    wanted = max(limits, default=0.0)
    faint = [name for name, share in zip(ranking.labels, ranking.felt.detected, strict=True) if share < wanted]
    if faint:
        yield from louder(ranking, faint, (wanted, 1.0 - ALMOST * (1.0 - wanted)))


def _searched(ranking: Ranking, edits: Edits) -> Iterator[list[Edit | NoEdit]]:
    """Edits, the fewest first: of the worst pair, of all close pairs, of the worst pair to be far apart."""
    a, b = ranking.worst_pair or ("", "")
    yield [edits[a, b]] if (a, b) in edits else []
    near = sorted(ranking.pairs, key=lambda pair: -pair.confused_probability)[:MOST_PAIRS]
    close = {(p.a, p.b): edits.get((p.a, p.b)) for p in near if p.d_prime < DISTINGUISHABLE_DPRIME}
    yield [edit or cheapest_edit(ranking, *pair) for pair, edit in close.items()]
    apart = next(pair.d_prime for pair in ranking.pairs if (pair.a, pair.b) == (a, b))
    yield [cheapest_edit(ranking, a, b, wanted=FURTHER * max(apart, DISTINGUISHABLE_DPRIME))]
