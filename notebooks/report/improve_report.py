"""The report of ``thermicon improve``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import count_of, number, percent, percent_span

from .blocks import Block, Bullets, Heading, Text, grid
from .choices import NAMES, goal_lines, laboratory, left_out, maximised
from .rank_details import crowd_text, edit_text, trouble_lines
from .rank_report import BARELY

if TYPE_CHECKING:
    from thermicon.perception.selection.advice import Way
    from thermicon.perception.selection.frontier import Frontier
    from thermicon.perception.selection.search import SearchResult

    from .set_report import SetReport

REFINING_PEOPLE = 24
"""As in `thermicon.perception.selection.search_run`, repeated here to avoid its imports."""


def frontier_report(found: Frontier, title: str, following: str = "", ways: Sequence[Way] = ()) -> list[Block]:
    """Report one row for each number of icons, the largest choice, what was left out, and what follows.

    `ways` were tried with the choice that comes nearest to a goal that none meets.
    """
    heads = (
        "icons",
        "felt and named",
        "95 % of people",
        "d′",
        "bits",
        "time",
        "energy",
        *(["goal"] * bool(found.goals)),
    )
    rows = [
        (
            str(len(point.icons)) + ("" if point.optimal else " *"),
            percent(point.at_own_range.felt_and_named),
            f"from {percent(point.reached)}",
            number(point.at_own_range.d_prime),
            f"{point.at_own_range.information_bits:.2f}",
            f"{number(point.total_s)} s",
            "–" if point.total_J != point.total_J else f"{number(point.total_J)} J",
            *("✓" if goal.met else "✗" for goal in found.goals[k : k + 1]),
        )
        for k, point in enumerate(found.points)
    ]
    job, largest = found.job, found.points[-1]
    crowd = count_of(job.people, "virtual person", "virtual people")
    what_if = f" with {', '.join(job.rig.changes)}" if job.rig.changes else ""
    aim = maximised(largest.objective, next(iter(found.goals), None))
    met = [point for point, goal in zip(found.points, found.goals, strict=False) if goal.met]
    named = met[-1] if met else largest
    amber = found.amber(named)
    names = ", ".join(f"{name} (amber)" if name in amber else name for name in named.icons)
    said = [
        f"The {len(named.icons)}{' that meet the goal' * bool(met)}: {names}",
        *(["* not proven to be the best of their number"] * any(not point.optimal for point in found.points)),
        *_goal(found, ways),
        *left_out(largest.excluded),
        *([f"Next: {following}"] if following else []),
    ]
    return [
        *([Heading(title, 1)] if title else []),
        grid(heads, rows, heads[:7]),
        Text("\n".join(said)),
        Text(
            f"The best by {aim} of {largest.pool} icons that can be "
            f"{'chosen' if found.goals else 'played'}, for {crowd} on the {job.rig.name} rig{what_if} (seed "
            f"{job.seed}). {_reached(found)} These are predictions of a model, not measurements."
        ),
        *([Text(f"Rough: {crowd}; each per cent within about 3 points; refining …")] if found.rough else []),
    ]


def _goal(found: Frontier, ways: Sequence[Way]) -> Iterator[str]:
    """The largest choice that meets the goal with its parts, or the nearest with what is in its way."""
    judged = list(zip(found.points, found.goals, strict=False))
    if met := [each for each in judged if each[1].met]:
        point, result = met[-1]
        more = "the largest choice here" if point is judged[-1][0] else "by no larger choice of these"
        yield from goal_lines(result, f"met by the best {len(point.icons)}, {more}")
    elif judged:
        point, result = found.nearest
        yield from goal_lines(result, f"met by none of these choices; the best {len(point.icons)}:", ways)


def _reached(found: Frontier) -> str:
    if found.draws:
        return (
            "What 95 % of people reach is about people and the uncertainty of the model together "
            f"({found.draws} draws), as in a goal."
        )
    return "What 95 % of people reach is about people alone, at the nominal constants: milder than in a goal."


def edits_report(made: SetReport, title: str, following: str) -> list[Block]:
    """Report the edits of a set without its ranking: the goal, each edit or why there is none, and their effect."""
    ranking, after, said = made.ranking, made.edited, list[str]()
    for a, b in made.edits:
        pair = next(each for each in ranking.pairs if {each.a, each.b} == {a, b})
        if text := edit_text(made, pair):
            said.append(f"{a} and {b}, d′ {number(pair.d_prime)}: {text}")
    missed = made.goal is not None and not made.goal.met
    effect = "No edit that was tried meets the goal." if missed else "No pair has an edit that helps."
    if after is not None and after.worst is not None:
        effect = (
            f"With {'the edits that meet the goal' if made.way else 'these edits'}: felt and named "
            f"{percent(ranking.felt_and_named)} → {percent(after.felt_and_named)}, worst pair {after.worst.a} and "
            f"{after.worst.b}, d′ {number(after.worst.d_prime)}."
        )
    elif not said and not missed:
        effect = "Every pair is distinguishable: no edit is needed." if ranking.pairs else "There is no pair to edit."
    return [
        *([Heading(title, 1)] if title else []),
        *([Text("\n".join(goal_lines(made.goal, "", made.ways)))] if made.goal else []),
        *[Text(line, "warn") for line in trouble_lines(ranking.icons, {})],
        *([Bullets(tuple(said))] if said else []),
        Text("\n".join([effect, f"Next: {following}"])),
        Text(f"Predicted, not measured: {crowd_text(ranking)}."),
    ]


def search_report(found: SearchResult, before: SetReport, after: SetReport, title: str, following: str) -> list[Block]:
    """Report the found set, its scores next to those of the initial set, the goal, what follows, and the caveat."""
    from thermicon.perception.selection.candidates import FOUND

    ranking, icons = after.ranking, found.found
    tried = [f"{icon.name}: {icon.metadata.tags[-1]}" for icon in icons if FOUND in icon.metadata.tags]
    said = [*_remarks(found, after), f"After: worst pair {' and '.join(found.after.worst_pair)}"]
    said.append(f"Before: {', '.join(icon.name for icon in found.start)}")
    goal: list[Block] = []
    if after.goal is not None:
        goal.append(Text("\n".join(goal_lines(after.goal, ways=after.ways))))
        if not after.goal.met:
            stays = "".join(f", and {name}, which is no family, stays" for name in _in_the_way(found, after))
            goal.append(Text(f"Not reached by this search: more --evaluations may find a better set{stays}."))
    return [
        *([Heading(title, 1)] if title else []),
        Text("Found:"),
        Bullets(tuple(tried)),
        grid(("", "before", "after"), _scores(found, before, after), ("before", "after")),
        Text("\n".join(said)),
        *goal,
        Text(f"Next: {following}"),
        Text(
            f"{found.evaluations} icons were tried on a nominal person and {found.refined} on {REFINING_PEOPLE} "
            f"people, whatever --people is; what they maximised was {maximised(found.objective, after.goal)} (seed "
            f"{found.seed}). Of {count_of(found.finalists, 'set')} held at the end, this one was chosen by "
            f"{NAMES.get(found.chosen_by, found.chosen_by)}. Before and after are for "
            f"{count_of(ranking.people, 'virtual person', 'virtual people')} on the {ranking.job.rig.name} rig.\n"
            "These are predictions of a model, not measurements, and the set was optimised for that same model: "
            "expect lower scores from people."
        ),
    ]


def _scores(found: SearchResult, before: SetReport, after: SetReport) -> Iterator[tuple[str, str, str]]:
    """Rows of scores."""
    a, b, pair = found.before, found.after, (before.ranking, after.ranking)
    yield "worst pair, d′", number(a.d_prime), number(b.d_prime)
    yield "felt and named", percent(a.felt_and_named), percent(b.felt_and_named)
    if pair[1].people > 1:
        one, other = (percent_span(*each.felt_and_named_interval) for each in pair)
        yield "  middle 95 % of people", one, other
    intervals = [each.new_laboratory for each in pair if each.new_laboratory]
    if len(intervals) == len(pair):
        one, other = (percent_span(*each.felt_and_named) for each in intervals)
        yield f"  {laboratory(pair[1])} (95 %)", one, other
    yield "named", percent(a.proportion_correct), percent(b.proportion_correct)
    yield "information, bits", f"{a.information_bits:.2f}", f"{b.information_bits:.2f}"
    yield "information rate, bits/s", f"{a.bits_per_s:.2f}", f"{b.bits_per_s:.2f}"
    yield "total duration, s", number(pair[0].total_s), number(pair[1].total_s)


def _in_the_way(found: SearchResult, after: SetReport) -> list[str]:
    """The icon that is felt and named least, where no search changes it."""
    from thermicon.perception.selection.candidates import FOUND

    least = min(after.ranking.icons, key=lambda icon: icon.felt_and_named).name
    return [icon.name for icon in found.found if icon.name == least and FOUND not in icon.metadata.tags]


def _remarks(found: SearchResult, after: SetReport) -> Iterator[str]:
    """Ranges that end too early, and icons that cannot be played, are not green, or that many people will miss."""
    if found.at_ends:
        yield f"At the end of its range: {'; '.join(found.at_ends)}. A wider range may hold a better set."
    yield from trouble_lines(after.ranking.icons, {})
    for icon in after.ranking.icons:
        if icon.detected_probability < BARELY:
            yield f"{icon.name} is detected in {percent(icon.detected_probability)} of trials only"
