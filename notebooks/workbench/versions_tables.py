"""Versions A and B as HTML: what is predicted of each, by how much they differ, and the lines that were changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from thermicon.icons.number_text import number, percent, seconds

from ..report.blocks import fragment
from .goal_field import SAFETY, goal_row

if TYPE_CHECKING:
    from thermicon.perception import Ranking
    from thermicon.perception.selection.goal_result import GoalResult

    from .versions_model import RankedVersions

Row = tuple[str, str, str, str]


def results_html(both: RankedVersions) -> str:
    """The scores of both versions with their difference, icons by name, and why a version has none.

    Of proportion correct the difference is person by person, so its interval is narrower than those of the versions.
    """
    reasons = [f"{letter} is not ranked: {why}" for letter, why in zip("AB", both.reasons, strict=True) if why]
    groups = (
        ("", _score_rows(both)),
        ("goal", _goal_rows(both)),
        ("correct, by icon", _icon_rows(both.a, both.b) if both.a is not None and both.b is not None else []),
    )
    return fragment("versions", ("predicted", "A", "B", "B − A"), groups, reasons)


def _goal_rows(both: RankedVersions) -> list[Row]:
    """Whether each version meets the goal, then one row per part of it; none without a goal."""
    judged = both.goals
    known = judged[0] or judged[1]
    if known is None:
        return []

    def cell(goal: GoalResult | None, place: int) -> str:
        if goal is None:
            return "–"
        mark, _, value, distance, _ = goal_row(goal.parts[place])
        return f"{mark} {value}" + (f", {distance}" if goal.parts[place].part.quantity != SAFETY else "")

    words = ["–" if goal is None else "met" if goal.met else "not met" for goal in judged]
    parts = [(part.part.text, cell(judged[0], k), cell(judged[1], k), "") for k, part in enumerate(known.parts)]
    return [("all of it", words[0], words[1], ""), *parts]


def changes_html(rows: list[tuple[str, str]]) -> str:
    """The lines that only one version has."""
    return fragment("changes", rows) if rows else fragment("block", "A and B are the same", "th-soft")


def _score_rows(both: RankedVersions) -> list[Row]:
    a, b, gain = both.a, both.b, both.gain
    difference = "–"
    if gain is not None:
        mean, (low, high) = gain
        difference = f"{_points(mean)} (middle 95 % of people: {_points(low, '')} to {_points(high)})"

    def row(name: str, value: Callable[[Ranking], str], gap: Callable[[Ranking, Ranking], str]) -> Row:
        cells = [value(each) if each is not None else "–" for each in (a, b)]
        return name, cells[0], cells[1], gap(a, b) if a is not None and b is not None else "–"

    return [
        row("correct", lambda each: percent(each.proportion_correct), lambda *_: difference),
        row("information", lambda each: f"{each.information_bits:.2f} bits",
            lambda a, b: f"{_plus(b.information_bits - a.information_bits, 2)} bits"),
        row("confused most", lambda each: " and ".join(each.worst_pair or ("–",)), lambda *_: ""),
        row("icons", lambda each: str(len(each.icons)), lambda a, b: _plus(len(b.icons) - len(a.icons), 0)),
        row("time", lambda each: f"{number(each.total_s)} s", lambda a, b: f"{_plus(b.total_s - a.total_s, 1)} s"),
        row("energy", lambda each: f"{number(each.total_J)} J", lambda a, b: f"{_plus(b.total_J - a.total_J, 1)} J"),
        row("limits of this simulation", _limits, lambda *_: ""),
    ]  # fmt: skip


def _icon_rows(a: Ranking, b: Ranking) -> list[Row]:
    """One row per icon of either version, in the order of B; a dash where a version does not have it."""
    known = [{icon.name: icon for icon in ranking.icons} for ranking in (a, b)]
    names = list(dict.fromkeys([icon.name for icon in (*b.icons, *a.icons)]))
    rows = []
    for name in names:
        first, second = known[0].get(name), known[1].get(name)
        cells = [
            f"{percent(icon.proportion_correct)}, felt after {seconds(icon.onset_s)}" if icon else "–"
            for icon in (first, second)
        ]
        gap = _points(second.proportion_correct - first.proportion_correct) if first and second else ""
        rows.append((name, cells[0], cells[1], gap or ("only in A" if first else "only in B")))
    return rows


def _limits(ranking: Ranking) -> str:
    wrong = [icon.name for icon in ranking.icons if not icon.safe]
    amber = [icon.name for icon in ranking.icons if icon.safe and icon.cautions]
    if not wrong and not amber:
        return "kept"
    groups = (("hard limit passed", wrong), ("soft limit passed", amber))
    return "; ".join(f"{word}: {', '.join(names)}" for word, names in groups if names)


def _points(share: float, unit: str = " points") -> str:
    return f"{_plus(100.0 * share, 0)}{unit}"


def _plus(value: float, digits: int) -> str:
    """A difference with its sign.

    >>> _plus(1.25, 1), _plus(-0.04, 1), _plus(-3.0, 0)
    ('+1.2', '0', '−3')
    """
    text = number(value, digits)
    return text if text.startswith("−") or text == "0" else f"+{text}"
