"""The set view's blocks as HTML: the ranking, the set's numbers, a pair and its cheapest edit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import number, percent

from ..report.blocks import Bullets, Cards, Heading, Text, fragment, shown
from ..report.choices import choice_lines, laboratory
from ..report.rank_details import edit_text
from ..report.rank_notes import caveat, outside_lines, trouble_lines
from ..report.rank_report import cards, icon_table
from ..timeline.terms import SIMULATED, terms_of

if TYPE_CHECKING:
    from thermicon.perception import Ranking
    from thermicon.perception.ranking.scores import PairScore
    from thermicon.perception.selection.edit_result import Edit, NoEdit

    from ..report.set_report import SetReport

ALONE = "The set has only one icon, so there are no distances to show."


def ranking_table(ranking: Ranking, result: dict[str, Any]) -> str:
    """One row per icon, the best first; those that are unsafe or out of reach below.

    ``result`` is the ranking as plain data.
    """
    icons = {icon["name"]: icon for icon in result["icons"]}
    return shown(icon_table([icons[row["icon"]] for row in ranking.rows()], result))


def notes_html(result: dict[str, Any]) -> str:
    """Why icons are unsafe or out of reach, what is amber, and where the prediction leaves the range of the data."""
    icons = result["icons"]
    return shown(*(Text(line, "note") for line in (*trouble_lines(icons, {}), *outside_lines(icons))))


def scores_html(result: dict[str, Any]) -> str:
    """The numbers that are asked first, with the interval of the laboratory that is predicted."""
    if len(result["icons"]) == 1:
        return shown(Text(ALONE, "note"))
    return shown(Cards(cards(result, laboratory(result["observer"], result["set"]["own_laboratory"]))))


def caveat_html(result: dict[str, Any]) -> str:
    """What the numbers rest on, and that they are predictions."""
    meaning = "Confusion: share of trials in which the icon of a row is answered with that of a column."
    past = sum(not icon["safe"] for icon in result["icons"])
    limits = f"{past} past a hard limit" if past else "no icon past a hard limit"
    simulated = f"Limits of this simulation: {limits}; export judges worst cases."
    by = "" if result["observer"] == "shipped" else f" Predicted with the observer of {result['observer']}."
    known = ("d′", "bits", "detected", "felt", "onset", "proportion correct", "middle 95 % of people", SIMULATED)
    said = Text(f"{meaning} {caveat(result)}{by} {simulated}", "soft")
    return shown(said) + fragment("terms", terms_of(*known))


def pair_html(pair: PairScore) -> str:
    """Which two icons form a pair, and how often they are confused."""
    sentence = f"confused in {percent(pair.confused_probability)} of trials, d′ {number(pair.d_prime)}"
    return shown(Heading(f"{pair.a} and {pair.b}"), Text(sentence))


def why_html(pair: PairScore) -> str:
    """Why a pair is confused, or is not."""
    return shown(Bullets(pair.why))


def edit_html(edit: Edit | NoEdit | None) -> str:
    """The cheapest edit of a pair, or why there is none."""
    from thermicon.perception.selection.edit_result import NoEdit

    if edit is None:
        return shown(Text("looking for the cheapest edit …", "status"))
    if isinstance(edit, NoEdit):
        return shown(Text(f"no edit: {edit.reason}", "soft"))
    return shown(Text(edit_text({"edit": edit.to_dict()})))


def chosen_html(made: SetReport) -> str:
    """Which icons were chosen, and how certain that choice is."""
    if made.choice is None:
        return ""
    where = laboratory(made.ranking.observer, made.ranking.own_laboratory)
    first, *rest = choice_lines(made.choice.to_dict(), where)
    return shown(Heading(first), Bullets(tuple(rest)))
