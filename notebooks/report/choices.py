"""The text about a goal or about the choice of the best few icons."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import count_of, listed, number, percent
from thermicon.perception.selection.goal import word_of

if TYPE_CHECKING:
    from thermicon.perception import Ranking
    from thermicon.perception.selection.advice import Way
    from thermicon.perception.selection.choose import Choice
    from thermicon.perception.selection.goal_result import GoalPartResult, GoalResult

MOST_WAYS = 3
"""Of the ways to a goal that were tried so many are shown, and the others counted."""
SHARE = "For a share of people: what at least so many reach, with the uncertainty of the model."
NAMES = {"worst": "the worst pair", "felt-and-named": "felt and named", "named": "the proportion named correctly",
         "bits": "bits", "bits-per-s": "bits per second"}  # fmt: skip


def goal_lines(goal: GoalResult, verdict: str = "", ways: Sequence[Way] = ()) -> Iterator[str]:
    """Report whether a goal is met, or another `verdict`: what was predicted of each part, and what is in the way.

    What a share of people means is said too, unless a `verdict` is given, whose command says it with its table. The
    `ways` that came nearest, of those tried, come with the part that is missed most, before and after.
    """
    yield f"Goal: {verdict or ('met' if goal.met else 'NOT met')}"
    for each in goal.parts:
        yield f"  {'✓' if each.met else '✗'} {each.part.text}: {goal_value(each)}"
    if not verdict and any(each.part.people is not None for each in goal.parts):
        yield f"  {SHARE}"
    if goal.binding:
        yield f"  In the way: {'; '.join(goal.binding)}"
    worst = min(goal.parts, key=lambda part: part.margin)
    nearest = sorted(range(len(ways)), key=lambda k: -ways[k].result.margin)[:MOST_WAYS]
    if others := len(ways) - len(nearest):
        yield f"  Tried, and farther from the goal: {count_of(others, 'other way')}"
    for way in (ways[k] for k in sorted(nearest)):
        after, which = way.after(worst), f"{word_of(worst.part.quantity)}{worst.part.whose}"
        met = "which meets the goal" if way.result.met else "which misses the goal"
        value = f"{_said(worst)} → {'about ' * way.rough}{_said(after)}"
        yield f"  Tried: {way_words(way, MOST_WAYS)}: {which} {value}, {met}"
    if goal.unreached:
        yield f"  Not reached, and judged as the rig would play them: {', '.join(goal.unreached)}; export refuses them"


def way_words(way: Way, most: int | None = None) -> str:
    """What was changed, in words; of more than `most` edits the first ones."""
    if way.choice is not None:
        return f"the best {len(way.choice.icons)}, {', '.join(way.choice.icons)}"
    if way.area_cm2 is not None:
        return f"a contact of {way.area_cm2:g} cm²"
    told = "; ".join(f"in {edit.icon}, {edit.old} → {edit.new}" for edit in way.edits[:most])
    return told if most is None or len(way.edits) <= most else f"{told}; and {len(way.edits) - most} more edits"


def _said(found: GoalPartResult) -> str:
    """The value of a part in its unit."""
    if found.value is None or found.part.unit == "%":
        return "none" if found.value is None else f"{100.0 * found.value:.1f} %"
    return found.verdict or f"{number(found.value, 2)} {found.part.unit}".rstrip()


def goal_value(found: GoalPartResult) -> str:
    """The prediction for a part of a goal, in its unit, and its distance from what is wanted."""
    if found.verdict:
        return f"{found.verdict} in this simulation; export judges the worst case"
    if found.value is None:
        return "none"
    unit, gap, said = found.part.unit, abs(found.value - found.part.limit), _said(found)
    missed = f"{100.0 * gap:.1f} points" if unit == "%" else f"{number(gap, 2)} {unit}".rstrip()
    return said if found.met else f"{said}, missed by {missed}"


def laboratory(ranking: Ranking) -> str:
    """Which laboratory an interval is for: a new one, or the one whose draws an observer's file holds."""
    return f"your laboratory, {ranking.observer}" if ranking.own_laboratory else "a new laboratory"


def maximised(objective: str, goal: GoalResult | None) -> str:
    """What a choice or a search maximised, in words."""
    return NAMES[objective] if goal is None or not goal.goal.of_sets else "the margin of the goal"


def choice_lines(choice: Choice, goal: GoalResult | None = None) -> Iterator[str]:
    """Report what was chosen, how certain that is, and the excluded icons."""
    objective = choice.objective
    yield f"Best {len(choice.icons)} of {choice.pool}, by {maximised(objective, goal)}: {', '.join(choice.icons)}"
    score = f"within the range of all {choice.pool}: {scored(objective, choice.value)}"
    yield score + (f" ({' and '.join(choice.worst_pair)})" if objective == "worst" else "")
    if choice.optimal:
        yield f"no other choice is better: {_searched(choice)}"
    else:
        yield (
            f"the best choice found; none exceeds {scored(objective, choice.bound)}, a bound that may be loose "
            f"({count_of(choice.seen, 'choice')} examined)"
        )
    energy = "" if math.isnan(choice.total_J) else f", total energy {number(choice.total_J)} J"
    yield f"total duration {number(choice.total_s)} s{energy}"
    yield from left_out(choice.excluded)


def left_out(excluded: Sequence[tuple[str, str]]) -> Iterator[str]:
    """A line for the icons that were left out for reasons of one kind, with that of the first.

    >>> list(left_out([(name, "is detected in 4 % of trials only") for name in "abcde"]))
    ['Left out: a, b, c and 2 more: a is detected in 4 % of trials only']
    """
    kinds: dict[str, list[str]] = {}
    for name, reason in excluded:
        kinds.setdefault(" ".join(reason.split()[:3]), []).append(name)
    for names in kinds.values():
        yield f"Left out: {f'{listed(names)}: ' * (len(names) > 1)}{names[0]} {dict(excluded)[names[0]]}"


def scored(objective: str, value: float) -> str:
    """Write the value of an objective with its meaning."""
    if objective == "worst":
        return f"d′ {number(value)} in the worst pair"
    if objective in ("felt-and-named", "named"):
        return f"{percent(value)} {objective.replace('-', ' ')}"
    return f"{value:.2f} {'bits' if objective == 'bits' else 'bits/s'}"


def _searched(choice: Choice) -> str:
    if choice.objective == "worst":
        return f"proven by bisection over d′ ({count_of(choice.seen, 'threshold')})"
    people = count_of(choice.people, "person", "people")
    if choice.seen == 1:
        return f"it is the only one, evaluated with {people}"
    return f"all {choice.seen} choices were evaluated, with {people}"
