"""What the set view says in words: the ranking as a table, the set's numbers, a pair and its edit, as small HTML."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from ..text.choices import choice_lines
from ..text.number_text import number, percent, seconds
from ..text.rank_notes import outside_lines, trouble_lines
from ..text.rank_text import caveat, rival

if TYPE_CHECKING:
    from thermicon.perception import Edit, NoEdit, PairScore, Ranking

ALONE = "a set of one icon: with nothing to confuse it with, it is never confused, so there is no distance to show"


def ranking_table(ranking: Ranking, result: dict[str, Any]) -> str:
    """The icons, the best first; those that are not safe or not reached apart below. ``result`` is its plain data."""
    icons = {icon["name"]: icon for icon in result["icons"]}
    labels = result["confusion"]["labels"]
    chosen = set(result["chosen"]["icons"]) if result["chosen"] else set()
    order = [icons[row["icon"]] for row in ranking.rows()]
    head = ("icon", "detected", "onset", "as", "correct", "confused with")
    numeric = {1, 2, 4}

    def row(icon: dict[str, Any]) -> str:
        name = f"✓ {icon['name']}" if icon["name"] in chosen else icon["name"]
        cells = (
            name,
            percent(icon["detected_probability"]),
            seconds(icon["onset_s"]),
            icon["channel"] or "–",
            percent(icon["proportion_correct"]),
            rival(result["confusion"], labels.index(icon["name"])),
        )
        return _row(cells, numeric, "chosen" if icon["name"] in chosen else "")

    good = [icon for icon in order if icon["safe"] and icon["reachable"]]
    bad = [icon for icon in order if not (icon["safe"] and icon["reachable"])]
    body = "".join(map(row, good))
    if bad:
        said = "not safe, or not reached by this rig:" if good else "none of the icons can be played:"
        body += f'<tr class="bad"><td colspan="{len(head)}">{said}</td></tr>' + "".join(map(row, bad))
    cells = "".join(f"<th{_n(k, numeric)}>{name}</th>" for k, name in enumerate(head))
    return f'<table class="th"><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>'


def notes_html(result: dict[str, Any]) -> str:
    """Why icons are not safe or not reached, what is amber, and where no data stand behind the prediction."""
    icons = result["icons"]
    return _notes([*trouble_lines(icons, {}), *outside_lines(icons)])


def scores_html(ranking: Ranking) -> str:
    """Per cent correct and bits with both intervals, over people and over the model's parameters."""
    if len(ranking.icons) == 1:
        return f'<div class="th-note">{ALONE}</div>'
    draws = ranking.parameter_intervals
    low, high = ranking.proportion_correct_interval
    correct = [f"people {percent(low)} to {percent(high)}"]
    least, most = ranking.information_bits_interval
    bits = [f"people {least:.2f} to {most:.2f}"]
    if draws is not None:
        correct.append(f"parameters {percent(draws.proportion_correct[0])} to {percent(draws.proportion_correct[1])}")
        bits.append(f"parameters {draws.information_bits[0]:.2f} to {draws.information_bits[1]:.2f}")
    if ranking.chosen is not None:
        correct.append("parameters: see the chosen")
    shown: tuple[tuple[str, list[str]], ...] = (
        (f"{percent(ranking.proportion_correct)} correct", correct),
        (f"{ranking.information_bits:.2f} bits", bits),
        (f"{ranking.bits_per_s:.2f} bits/s", []),
    )
    made = "".join(
        f'<span><span class="th-big">{head}</span> <span class="th-soft">{" · ".join(more)}</span></span>'
        for head, more in shown
    )
    return f'<div class="th-scores">{made}</div>'


def caveat_html(result: dict[str, Any]) -> str:
    """On what the numbers rest, and that they are predictions."""
    told = escape(caveat(result))
    said = f"Confusion: share of trials in which the icon of a row is answered with that of a column. {told}"
    return f'<div class="th-soft">{said}</div>'


def pair_html(pair: PairScore) -> str:
    """A pair: which icons, and how often they are confused."""
    head = f"{escape(pair.a)} and {escape(pair.b)}"
    said = f"confused in {percent(pair.confused_probability)} of trials, d′ {number(pair.d_prime)}"
    return f'<div class="th-head">{head}</div><div>{said}</div>'


def why_html(pair: PairScore) -> str:
    """Why a pair is confused, or is not."""
    return _list(pair.why)


def edit_html(edit: Edit | NoEdit | None) -> str:
    """The cheapest edit of a pair, or why there is none."""
    from thermicon.perception import NoEdit

    if edit is None:
        return '<span class="th-status">looking for the cheapest edit …</span>'
    if isinstance(edit, NoEdit):
        return f'<span class="th-soft">no edit: {escape(edit.reason)}</span>'
    longer = f", {number(edit.added_s)} s longer" if edit.added_s >= 0.05 else ""
    return (
        f"<b>cheapest edit</b> in {escape(edit.icon)}{longer}, for d′ {number(edit.d_prime)}:<br>"
        f'<span class="th-code">{escape(edit.old)}<br>→ {escape(edit.new)}</span>'
    )


def chosen_html(ranking: Ranking) -> str:
    """Which icons were chosen, and how sure that is."""
    if ranking.chosen is None:
        return ""
    first, *rest = choice_lines(ranking.chosen.to_dict())
    return f'<div class="th-head">{escape(first)}</div>' + _list([line.removeprefix("  - ") for line in rest])


def _notes(lines: Sequence[str]) -> str:
    return "".join(f'<div class="th-note">{escape(line)}</div>' for line in lines)


def _list(lines: Sequence[str]) -> str:
    return '<ul class="th">' + "".join(f"<li>{escape(line)}</li>" for line in lines) + "</ul>" if lines else ""


def _row(cells: Sequence[str], numeric: set[int], kind: str) -> str:
    made = "".join(f"<td{_n(k, numeric)}>{escape(cell)}</td>" for k, cell in enumerate(cells))
    return f'<tr class="{kind}">{made}</tr>' if kind else f"<tr>{made}</tr>"


def _n(k: int, numeric: set[int]) -> str:
    return ' class="n"' if k in numeric else ""
