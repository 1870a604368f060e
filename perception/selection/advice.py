"""Ways to a goal that a set misses: each is tried with the same people and draws before it is offered.

The cheapest come first: edits of the icons, fewer icons, a larger contact.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from thermicon.circuit import Rig
from thermicon.icons import Icon
from thermicon.icons.model.context import Metadata

from ..criteria import DISTINGUISHABLE_DPRIME
from ..ranking.rank import rank
from ..ranking.ranking import Ranking
from .choose import Choice, choose
from .edit import Edit, NoEdit, cheapest_edit
from .goal_result import GoalPartResult, GoalResult, judge_goal
from .request import ChoiceError, Selection

Edits = Mapping[tuple[str, str], Edit | NoEdit]
FURTHER = 1.3
"""The worst pair is also edited to be so many times farther apart than it is."""
LARGER = (2.0, 4.0)
"""Contacts that are tried, times that of the rig."""
MOST_PAIRS = 6
"""Pairs, those confused most, that edits are looked for."""


@dataclass(frozen=True, slots=True)
class Way:
    """A change that was tried: `edits`, a `choice` of fewer icons, `must` among them, or a contact of `area_cm2`; and
    the goal with it.
    """

    result: GoalResult
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


def ranked_as(ranking: Ranking, icons: Sequence[Icon], draws: int, rig: Rig | None = None) -> Ranking:
    """Other icons, or the same on another rig, as the people and draws of a ranking find them."""
    job = ranking.job
    where = job.rig if rig is None else rig
    return rank(tuple(icons), where, crowd=ranking.crowd, trials=job.trials, task=job.task, parameters=draws)


def ways_to(
    ranking: Ranking,
    missed: GoalResult,
    draws: int,
    edits: Edits,
    choice: Choice | None = None,
    must: tuple[str, ...] = (),
) -> Iterator[Way]:
    """Try ways to a goal that the set, or a choice out of it, misses, the cheapest first."""
    job, goal, playable = ranking.job, missed.goal, all(icon.playable for icon in ranking.icons)
    wrong = {each.part.quantity for each in missed.parts if not each.met}
    felt = wrong - {"time", "energy", "count", "safety"}
    if choice is None and playable and felt and ranking.pairs:
        for some in _edits(ranking, edits):
            yield Way(judge_goal(goal, ranked_as(ranking, with_edits(job.icons, some), draws)), edits=some)
    least = max(2, int(goal.of("count") or 2))
    most = len(ranking.icons) if choice is None else len(choice.icons)
    for count in range(most - 1, least - 1, -1) if wrong != {"count"} else ():
        try:
            fewer = choose(ranking, Selection(count, goal.objective, must, *goal.totals), goal=goal, parameters=draws)
        except ChoiceError:
            continue
        yield Way(judge_goal(goal, ranking, fewer), choice=fewer, must=must)
    names = ranking.labels if choice is None else choice.icons
    for times in LARGER if felt and playable else ():
        area = float(f"{1e4 * times * job.rig.contact.area_m2:.3g}")
        try:
            larger = job.rig.with_(**{"contact.area_cm2": area})
        except ValueError:
            return
        found = ranked_as(ranking, [icon for icon in job.icons if icon.name in names], draws, larger)
        if all(icon.playable for icon in found.icons):
            yield Way(judge_goal(goal, found), area_cm2=area)


def _edits(ranking: Ranking, edits: Edits) -> Iterator[tuple[Edit, ...]]:
    """Different sets of edits, as they are found."""
    seen: list[tuple[Edit, ...]] = [()]
    for some in map(compatible, _searched(ranking, edits)):
        if some not in seen:
            seen.append(some)
            yield some


def _searched(ranking: Ranking, edits: Edits) -> Iterator[list[Edit | NoEdit]]:
    """Edits, the fewest first: of the worst pair, of all close pairs, of the worst pair to be far apart."""
    a, b = ranking.worst_pair or ("", "")
    yield [edits[a, b]] if (a, b) in edits else []
    near = sorted(ranking.pairs, key=lambda pair: -pair.confused_probability)[:MOST_PAIRS]
    close = {(p.a, p.b): edits.get((p.a, p.b)) for p in near if p.d_prime < DISTINGUISHABLE_DPRIME}
    yield [edit or cheapest_edit(ranking, *pair) for pair, edit in close.items()]
    apart = next(pair.d_prime for pair in ranking.pairs if (pair.a, pair.b) == (a, b))
    yield [cheapest_edit(ranking, a, b, wanted=FURTHER * max(apart, DISTINGUISHABLE_DPRIME))]
