"""A ranking as blocks: what a user asks first in twenty lines, and the rest on demand."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import count_of, number, percent, percent_span, seconds

from .blocks import Block, Bullets, Cell, Facts, Grid, Heading, Text, grid, printed_unit
from .choices import choice_lines, goal_lines, laboratory
from .rank_details import (
    caveat,
    crowd_text,
    detail_blocks,
    edit_text,
    edits_blocks,
    outside_lines,
    playable,
    trouble_lines,
    worst_pair,
)

if TYPE_CHECKING:
    from thermicon.perception import Ranking
    from thermicon.perception.ranking.sensitivity import Sensitivity

    from .set_report import SetReport

MOST_ROWS = 5
"""Icons in the table of a ranking without details, which then has about twenty lines at 80 columns."""
BARELY = 0.75
"""An icon that fewer trials than these report is named: a good score of the set does not help who does not feel it."""
MOST_CONSTANTS = 12
"""Constants in the table of what carries the doubt; a file has them all."""
RANKED = ("icon", "detected", "onset", "channel", "correct", "most confused with")


def rank_report(
    made: SetReport, title: str, cures: Mapping[str, str] | None = None, following: str = "", details: bool = False
) -> list[Block]:
    """Report a ranking with what was asked of it.

    ``cures`` explain by the name of an icon how it could be reached, ``following`` is the command to give next. Without
    ``details``, all but the first note, the reasons and what the numbers depend on are left out.
    """
    result = made.to_dict(mapped=False)  # the map is drawn, not printed
    place = {row["icon"]: k for k, row in enumerate(made.ranking.rows())}
    icons = sorted(result["icons"], key=lambda icon: place[icon["name"]])
    notes = [*trouble_lines(result["icons"], cures or {}), *outside_lines(icons)]
    if not details and len(notes) > 1:
        notes = [notes[0], f"{count_of(len(notes) - 1, 'more note')}: thermicon rank --details"]
    advice = edit_text(worst_pair(result)) if result["set"]["worst_pair"] else ""
    where = laboratory(result["observer"], result["set"]["own_laboratory"])
    chosen = list(choice_lines(result["chosen"], where)) if result["chosen"] else []
    said = [advice[:1].upper() + advice[1:], f"Next: {following}" if following else ""]
    by = "" if result["observer"] == "shipped" else f", observer {result['observer']}"
    short = f"Predicted, not measured: {crowd_text(result)}{by}."
    told: list[Block] = [Heading(chosen[0], 3), Bullets(tuple(chosen[1:]))] if chosen else []
    return [
        *([Heading(title, 1)] if title else []),
        *([Text("\n".join(goal_lines(result["goal"])))] if result["goal"] else []),
        Facts(cards(result, where), cards=True),
        Text("\n".join(filter(None, said))),
        *told,
        *([] if details else edits_blocks(result)),
        *(Text(note, "note" if note.startswith("Outside") else "warn") for note in notes),
        icon_table(icons, result, None if details else MOST_ROWS),
        *(detail_blocks(result) if details else []),
        Text(caveat(result) if details else f"{short} More: {'rank ' * (not following)}--details"),
    ]


def rules_report(ranking: Ranking, title: str) -> list[Block]:
    """Report a set by rules of thumb alone: one row per icon, the best first, and what each rule found."""

    def margin(value: float | None) -> float:
        return math.inf if value is None else value

    numbers = ("score", "rules passed", "distinct pairs", "margin")
    rows = [
        (
            row["icon"],
            percent(row["rules_score"]),
            f"{row['rules_passed']} of {row['rules']}",
            f"{row['pairs_distinguishable_by_rules']} of {len(ranking.icons) - 1}",
            "–" if row["rules_margin"] is None else f"{1.0 + row['rules_margin']:.3g} ×",
        )
        for row in sorted(
            ranking.rows(), key=lambda row: (-row["rules_score"], -margin(row["rules_margin"]), row["icon"])
        )
    ]
    points = [f"{icon.name}: {rule.text}" for icon in ranking.icons for rule in icon.rules if not rule.from_model]
    points += [rule.text for rule in ranking.rules]
    worst = sorted(ranking.pairs, key=lambda pair: (pair.rules_pass, margin(pair.rules_margin), pair.a, pair.b))[:1]
    points += [f"worst pair, {pair.a} and {pair.b}: {rule.text}" for pair in worst for rule in pair.rules]
    apart = sum(pair.rules_pass for pair in ranking.pairs)
    return [
        *([Heading(title, 1)] if title else []),
        grid(("icon", *numbers), rows, numbers),
        Text(f"{apart} of {count_of(len(ranking.pairs), 'pair')} distinguishable by the rules:"),
        Bullets(tuple(points)),
        Text(
            "Scored by rules of thumb alone: the share of rules passed, equally weighted, then the smallest margin as "
            "a multiple of its threshold. Rules on latency and felt peak need the model and are not counted."
        ),
    ]


def cards(result: Mapping[str, Any], where: str) -> tuple[tuple[str, str], ...]:
    """The numbers that are asked first: named, bits, detected, and the worst pair; each with its interval."""
    whole, icons = result["set"], result["icons"]
    least = min(icons, key=lambda icon: float(icon["detected_probability"]))
    mean = sum(icon["detected_probability"] for icon in icons) / len(icons)
    felt = "of trials detected"
    if len(icons) > 1:
        felt += f"; least: {least['name']}, {percent(least['detected_probability'])}"
    if whole["information_bits"] is None:
        return ((percent(mean), felt),)
    correct, bits = "named correctly", "of information"
    if whole["proportion_correct_interval_new_laboratory"]:
        correct += f"; in {where} (95 %): {percent_span(*whole['proportion_correct_interval_new_laboratory'])}"
        low, high = whole["information_bits_interval_new_laboratory"]
        bits += f"; in {where} (95 %): {low:.2f}–{high:.2f}"
    elif result["people"] > 1:
        correct += f"; middle 95 % of people: {percent_span(*whole['proportion_correct_interval'])}"
        low, high = whole["information_bits_interval"]
        bits += f"; middle 95 % of people: {low:.2f}–{high:.2f}"
    worst = worst_pair(result)
    pair = f"worst pair: {worst['a']} and {worst['b']}, confused in {percent(worst['confused_probability'])}"
    return (
        (percent(whole["proportion_correct"]), correct),
        (f"{whole['information_bits']:.2f} bits", bits),
        (percent(mean), felt),
        (f"d′ {number(worst['d_prime'])}", pair),
    )


def icon_table(icons: Sequence[dict[str, Any]], result: Mapping[str, Any], most: int | None = None) -> Grid:
    """One row per icon in this order; those that are unsafe or not reached have a star and stand apart.

    Of more than `most`, the last row says how many were left out.
    """
    apart = len(playable(icons))
    labels, chosen = result["confusion"]["labels"], (result["chosen"] or {"icons": ()})["icons"]
    rows: list[tuple[str | Cell, ...]] = [
        (
            f"{'✓ ' * (icon['name'] in chosen)}{icon['name']}{' *' * (place >= apart)}",
            percent(icon["detected_probability"]),
            seconds(icon["onset_s"]),
            icon["channel"] or "–",
            Cell(percent(icon["proportion_correct"]), "strong"),
            rival(result["confusion"], labels.index(icon["name"])),
        )
        for place, icon in enumerate(icons)
    ]
    if most is not None and len(rows) > most + 1:
        rows = [*rows[:most], (f"and {len(rows) - most} more", *[""] * (len(RANKED) - 1))]
    return grid(RANKED, rows, ("detected", "onset", "correct"), RANKED, apart)


def rival(confusion: Mapping[str, Any], place: int) -> str:
    """Return the icon that the one at this place is confused with most often, and how often: the mean of both ways."""
    matrix, labels = confusion["probability"], confusion["labels"]
    others = [(0.5 * (matrix[place][k] + matrix[k][place]), label) for k, label in enumerate(labels) if k != place]
    if not others:
        return "–"
    share, label = max(others)
    return f"{label} {percent(share)}"


def doubt_report(found: Sensitivity, title: str) -> list[Block]:
    """Report one row per constant that counts, the most important first, and what to measure first."""
    numbers = ("correct", "bits", "correct low–high")
    rows = [
        (
            effect.constant,
            f"{effect.low:.3g} to {effect.high:.3g} {printed_unit(effect.unit)}".rstrip(),
            percent(effect.proportion_correct),
            percent(effect.information_bits),
            f"{percent(effect.at_low)} – {percent(effect.at_high)}",
        )
        for effect in found.effects[:MOST_CONSTANTS]
    ]
    what_if = f" with {', '.join(found.rig_changes)}" if found.rig_changes else ""
    crowd = count_of(found.people, "virtual person", "virtual people")
    lead = "Measure first, by the share of the variance of the proportion correct that would go:"
    return [
        *([Heading(title, 1)] if title else []),
        grid(("constant", "95 % of draws", *numbers), rows, numbers),
        Text(lead if found.first else "No measurement would narrow the prediction noticeably."),
        Bullets(tuple(f"{percent(each.proportion_correct)}: {each.measurement}" for each in found.first)),
        Text(
            "Shares of the variance between draws of the posterior; constants that trade off share theirs, so that "
            "shares need not add up to 100 %. Beside them the proportion correct expected at both ends of the "
            f"interval. {found.draws} draws for {crowd} on the {found.rig} rig{what_if} (seed {found.seed}, memory: "
            f"{found.memory}): contact and outermost layer of the skin vary too, unlike in the intervals of rank."
        ),
    ]
