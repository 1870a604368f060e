"""What ``thermicon pilot`` prints: the data beside their prediction, and the prediction before and after."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import percent, percent_span, signed

from . import measured_text
from .answers_text import LEAST_LABORATORIES, fit_sentences, observed_sentences, people_table
from .tables import show, table

if TYPE_CHECKING:
    from rich.table import Table

    from thermicon.perception.pilot.observed import Observed

MOST_CONSTANTS = 8
LEAST_CARRIED = 30
"""Laboratories of measurements below which an interval is rough."""


def show_observed(found: Observed[Any, Any], files: Sequence[str], last: Sequence[str] = ()) -> None:
    """Print what was observed, how it fits, what the predictions of all sets become, and some last lines."""
    from thermicon.perception.pilot.data import Answered

    title = found.predictions[0].before.title
    told: list[Table | str]
    if isinstance(found.data, Answered):
        told = [people_table(found.data, found.own), "", *observed_sentences(found.data), "", *fit_sentences(found)]
    else:
        told = [measured_text.conditions_table(found), "", *measured_text.fit_sentences(found)]
    show(
        *([title, ""] if title else []),
        *told,
        "",
        sets_table(found, files),
        "",
        *draws_sentences(found),
        *(["", *last] if last else []),
    )


def sets_table(found: Observed[Any, Any], files: Sequence[str]) -> Table:
    """Each set before and after: per cent correct and bits of people who did not take part."""
    enough = len(found.conditioned.after) >= LEAST_LABORATORIES
    columns = ["set", "", "correct", "95 %", "bits", "95 %"] + ["narrower"] * enough
    made = table(*columns, numbers=("correct", "bits", "narrower"))
    for file, each in zip(files, found.predictions, strict=True):
        for when, one in (("before", each.before), ("after", each.after)):
            (share, low, high), (bits, least, most) = one.proportion_correct, one.information_bits
            made.add_row(
                Path(file).name if when == "before" else "",
                when,
                percent(share),
                percent_span(low, high),
                f"{bits:.2f}",
                f"{least:.2f}–{most:.2f}",
                *[f"{each.narrower:.2f} ×" if when == "after" else ""] * enough,
            )
    return made


def draws_sentences(found: Observed[Any, Any]) -> list[str]:
    """How many draws carry the result, and which constants moved."""
    own, people, answered = found.conditioned, found.predictions[0].after.people, bool(found.own)
    carried = f"effective sample size {own.effective:.0f} of {len(own.before)} draws"
    if own.rounds:
        rounds = "1 round" if own.rounds == 1 else f"{own.rounds} rounds"
        how = " by their pooled answers" if answered else f", of which {own.effective_after:.0f} are effective"
        carried += f", too few to be weighted: {len(own.after)} fresh laboratories were sampled in {rounds}{how}"
    lines = [
        f"Before and after are for {people} people of this laboratory who did not take part, with 95 % of "
        "laboratories.",
        f"The {'answers' if answered else 'values'} weigh the draws: {carried}.",
    ]
    if not answered and own.effective_after < LEAST_CARRIED:
        lines.append("So few carry rough intervals only: use more --draws.")
    return lines + few_lines(found) + constant_lines(found)


def few_lines(found: Observed[Any, Any]) -> list[str]:
    """That the intervals after are too rough to compare their widths, where few laboratories make them."""
    if (count := len(found.conditioned.after)) >= LEAST_LABORATORIES:
        return []
    return [
        f"Intervals after rest on {count} laboratories, too few to say by how much they narrowed: use --draws "
        f"{2 * LEAST_LABORATORIES} or more."
    ]


def constant_lines(found: Observed[Any, Any]) -> list[str]:
    """The constants that moved, with units; offsets of the laboratories of the evidence are left out."""
    header = found.prior.draws.header
    moved = [each for each in found.constants if not header.is_offset(each.name)]
    if not moved:
        return ["No constant moved by more than chance."]
    lines = ["What moved or narrowed most (median and 95 %, before → after):"]
    for each in moved[:MOST_CONSTANTS]:
        unit = f" {each.unit}" if each.unit else ""
        lines.append(f"  - {each.name}: {_three(each.before)} → {_three(each.after)}{unit}")
    return lines


def rank_lines(command: str, correct: float, people: int) -> list[str]:
    """What ``rank`` shows of a laboratory that was kept, and the command that does.

    >>> rank_lines("thermicon rank six-icons --observer lab.csv", 0.874, 200)[0]
    'rank shows 87 % correct for this laboratory: 200 other people at the first of the kept draws.'
    """
    return [
        f"rank shows {percent(correct)} correct for this laboratory: {people} other people at the first of the kept "
        "draws.",
        f"  {command}",
    ]


def _three(ends: tuple[float, float, float]) -> str:
    middle, low, high = (signed(end, ".3g") for end in ends)
    return f"{middle} ({low} to {high})"
