"""The set view's tables as HTML: the ranking, the set's numbers, a pair and its cheapest edit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import number, percent, percent_span, seconds

from ..report.blocks import fragment
from ..report.choices import choice_lines, laboratory
from ..report.rank_notes import caveat, outside_lines, trouble_lines
from ..report.rank_report import rival
from ..timeline.terms import SIMULATED, terms_of

if TYPE_CHECKING:
    from thermicon.perception import Ranking
    from thermicon.perception.ranking.scores import PairScore
    from thermicon.perception.selection.edit_result import Edit, NoEdit

    from ..report.set_report import SetReport

TITLED = {"detected": "detected", "onset": "onset", "as": "felt", "correct": "proportion correct"}
"""Columns with a word of the glossary as their tooltip."""
ALONE = "The set has only one icon, so there are no distances to show."


def ranking_table(ranking: Ranking, result: dict[str, Any]) -> str:
    """One row per icon, the best first; those that are unsafe or out of reach in a group of their own below.

    ``result`` is the ranking as plain data.
    """
    icons = {icon["name"]: icon for icon in result["icons"]}
    labels = result["confusion"]["labels"]
    chosen = set(result["chosen"]["icons"]) if result["chosen"] else set()
    order = [icons[row["icon"]] for row in ranking.rows()]

    def row(icon: dict[str, Any]) -> tuple[tuple[str, ...], bool]:
        name = icon["name"]
        cells = (
            f"✓ {name}" if name in chosen else name,
            percent(icon["detected_probability"]),
            seconds(icon["onset_s"]),
            icon["channel"] or "–",
            percent(icon["proportion_correct"]),
            rival(result["confusion"], labels.index(name)),
        )
        return cells, name in chosen

    playable = [row(icon) for icon in order if icon["safe"] and icon["reachable"]]
    others = [row(icon) for icon in order if not (icon["safe"] and icon["reachable"])]
    heading = "past a limit of this simulation, or not reached:" if playable else "none of the icons can be played:"
    columns = ("icon", "detected", "onset", "as", "correct", "confused with")
    meanings = {column: meaning for column, (_, meaning) in zip(TITLED, terms_of(*TITLED.values()), strict=True)}
    return fragment("ranking", columns, (1, 2, 4), playable, others, heading, meanings)


def notes_html(result: dict[str, Any]) -> str:
    """Why icons are unsafe or out of reach, what is amber, and where the prediction leaves the range of the data."""
    icons = result["icons"]
    return fragment("notes", [*trouble_lines(icons, {}), *outside_lines(icons)])


def scores_html(made: SetReport) -> str:
    """Proportion correct and bits with both intervals, between people and for the laboratory that is predicted."""
    ranking = made.ranking
    if len(ranking.icons) == 1:
        return fragment("notes", [ALONE])
    draws, where = ranking.new_laboratory, _where(ranking)
    low, high = ranking.proportion_correct_interval
    correct = [f"middle 95 % of people: {percent_span(low, high)}"]
    least, most = ranking.information_bits_interval
    bits = [f"middle 95 % of people: {least:.2f}–{most:.2f}"]
    if draws is not None:
        correct.append(f"{where}: {percent_span(*draws.proportion_correct)}")
        bits.append(f"{where}: {draws.information_bits[0]:.2f}–{draws.information_bits[1]:.2f}")
    if made.choice is not None:
        correct.append(f"{where}: see the chosen icons")
    shown: tuple[tuple[str, list[str]], ...] = (
        (f"{percent(ranking.proportion_correct)} correct", correct),
        (f"{ranking.information_bits:.2f} bits", bits),
        (f"{ranking.bits_per_s:.2f} bits/s", []),
    )
    return fragment("scores", shown)


def caveat_html(result: dict[str, Any]) -> str:
    """What the numbers rest on, and that they are predictions."""
    meaning = "Confusion: share of trials in which the icon of a row is answered with that of a column."
    past = sum(not icon["safe"] for icon in result["icons"])
    limits = f"{past} past a hard limit" if past else "no icon past a hard limit"
    simulated = f"Limits of this simulation: {limits}; export judges worst cases."
    by = "" if result["observer"] == "shipped" else f" Predicted with the observer of {result['observer']}."
    known = ("d′", "bits", "detected", "felt", "onset", "proportion correct", "middle 95 % of people", SIMULATED)
    words = fragment("terms", terms_of(*known))
    return fragment("block", f"{meaning} {caveat(result)}{by} {simulated}", "th-soft") + words


def pair_html(pair: PairScore) -> str:
    """Which two icons form a pair, and how often they are confused."""
    sentence = f"confused in {percent(pair.confused_probability)} of trials, d′ {number(pair.d_prime)}"
    return fragment("pair", pair.a, pair.b, sentence)


def why_html(pair: PairScore) -> str:
    """Why a pair is confused, or is not."""
    return fragment("points", pair.why)


def edit_html(edit: Edit | NoEdit | None) -> str:
    """The cheapest edit of a pair, or why there is none."""
    from thermicon.perception.selection.edit_result import NoEdit

    if edit is None:
        return fragment("marked", "looking for the cheapest edit …", "th-status")
    if isinstance(edit, NoEdit):
        return fragment("marked", f"no edit: {edit.reason}", "th-soft")
    longer = f", {number(edit.added_s)} s longer" if edit.added_s >= 0.05 else ""
    return fragment("edit", edit.icon, longer, number(edit.d_prime), edit.old, edit.new)


def chosen_html(made: SetReport) -> str:
    """Which icons were chosen, and how certain that choice is."""
    if made.choice is None:
        return ""
    first, *rest = choice_lines(made.choice.to_dict(), _where(made.ranking))
    return fragment("chosen", first, rest)


def _where(ranking: Ranking) -> str:
    return laboratory(ranking.observer, ranking.own_laboratory)
