"""The report of a plan for ``thermicon pilot``: sizes of experiments with their precision."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import number, percent, percent_span

from .blocks import Block, Grid, Text, grid

if TYPE_CHECKING:
    from thermicon.perception.pilot.plan import ExperimentPlan, ExperimentSize

NOTEWORTHY = 1.02
"""Data that makes an interval hardly narrower is not listed."""


def plan_report(found: ExperimentPlan, names: Sequence[str]) -> list[Block]:
    """Report predictions, designs, and the one to take."""
    predicted, designed = (Text("\n".join(lines)) for lines in (prediction_lines(found, names), design_lines(found)))
    return [predicted, designs_table(found), designed, *worth_blocks(found)]


def worth_blocks(found: ExperimentPlan) -> list[Block]:
    """What each kind of data could tell of a laboratory before anything is measured, and which pair tells most."""
    wanted = "per cent named" if found.difference is None else "difference"
    design = found.cheapest or max(found.designs, key=lambda each: each.narrower)
    answers = f"answers of {design.participants} participants, {design.trials} trials each"
    rows = [(answers, f"{design.narrower:.1f}"), *((each.data, f"{each.narrower:.2f}") for each in found.worth)]
    rows = [row for row in rows if float(row[1]) >= NOTEWORTHY]
    one, other = found.worst_pair
    return [
        Text(f"How many times narrower data makes the 95 % of laboratories of the {wanted}, at most:"),
        grid(("data", "narrower"), rows, ("narrower",)),
        Text(f"{one} and {other} are confused most: shown in half of the trials, their pair needs half as many."),
    ]


def prediction_lines(found: ExperimentPlan, names: Sequence[str]) -> list[str]:
    """The prediction before any answer."""
    lines = []
    for name, each in zip(names, found.predictions, strict=True):
        share, low, high = each.proportion_correct
        lines.append(f"{name}: {percent(share)} named, 95 % of laboratories {percent_span(low, high)}")
    if found.difference is not None:
        points = [number(100 * value) for value in found.difference]
        lines.append(f"Difference of the two: {points[0]} points, 95 % of laboratories {points[1]} to {points[2]}")
    return lines


def designs_table(found: ExperimentPlan) -> Grid:
    """Participants down, trials across: width of the interval, or share of experiments that distinguish the sets."""
    trials = sorted({each.trials for each in found.designs})
    headings = [f"{each} trials" for each in trials]
    rows = []
    for people in sorted({each.participants for each in found.designs}):
        row = {each.trials: each for each in found.designs if each.participants == people}
        rows.append((str(people), *(_cell(found, row[each]) for each in trials)))
    return grid(("participants", *headings), rows, headings)


def _cell(found: ExperimentPlan, design: ExperimentSize) -> str:
    text = f"{100 * design.width:.1f}" if design.found is None else percent(design.found)
    return f"{text} *" if found.enough(design) else f"{text}  "


def design_lines(found: ExperimentPlan) -> list[str]:
    """The reading of the table, and the size to take."""
    best = found.cheapest
    if found.difference is None:
        wanted = f"an interval of {number(100 * found.wanted)} points or less"
        lines = [f"Mean width of the 95 % interval of the per cent named, in points; * marks {wanted}."]
        cure, each_set = " participants or trials; try larger --participants.", ""
    else:
        wanted = f"{percent(found.wanted)} of experiments distinguish the sets"
        wrong = max(each.wrong or 0.0 for each in found.designs)
        lines = [
            "Share of experiments that distinguish the two sets in the right direction (paired t test at 5 %, every "
            f"participant names both); * marks {percent(found.wanted)} or more. At most {percent(wrong)} find the "
            "wrong direction."
        ]
        hardly = "where the sets hardly differ in many laboratories that the evidence allows"
        cure, each_set = f", or cannot be had {hardly}: pilot first.", " of each set"
    if best is None:
        return [*lines, f"None of these sizes is enough: {wanted} needs more{cure}"]
    return [*lines, f"Fewest trials: {best.participants} participants with {best.trials} trials each{each_set}."]
