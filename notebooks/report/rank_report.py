"""A ranking as blocks of a report."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import count_of, number, percent, percent_span, seconds

from .blocks import Block, Bullets, Cell, Facts, Grid, Heading, Text, grid, printed_unit
from .choices import choice_lines, goal_lines, laboratory
from .rank_details import (
    caveat,
    crowd_text,
    detail_blocks,
    edit_text,
    edits_blocks,
    intervals_text,
    outside_lines,
    trouble_lines,
)

if TYPE_CHECKING:
    from thermicon.perception import Ranking
    from thermicon.perception.ranking.scores import IconScore
    from thermicon.perception.ranking.sensitivity import Sensitivity

    from .set_report import SetReport

MOST_ROWS = 5
"""Icons in the table of a ranking without details, which then has about twenty lines at 80 columns."""
BARELY = 0.75
"""An icon that fewer trials than these report is named: a good score of the set does not help who does not feel it."""
MOST_CONSTANTS = 12
"""Constants in the table of what carries the doubt; a file has them all."""
ALERT, NAMED, WHERE = "felt+named", "named", "where"
RANKED = ("icon", "detected", "onset", "channel", ALERT, "most confused with")
RANKED_BOTH = ("icon", "detected", "onset", ALERT, NAMED, "most confused with")  # without channel a row has 80 columns
A_POINT = 0.01
"""Where felt and named is less than named by more for any icon, both are shown."""


def rank_report(
    made: SetReport,
    title: str,
    cures: Mapping[str, str] | None = None,
    following: str = "",
    details: bool = False,
    shown: bool = False,
) -> list[Block]:
    """Report a ranking with what was asked of it.

    ``cures`` explain by the name of an icon how it could be reached, ``following`` is the command to give next. Without
    ``details``, all but the first note, the reasons and what the numbers depend on are left out. Where the table is
    ``shown`` already, the rest follows, and the command comes last.
    """
    ranking = made.ranking
    advice = edit_text(made, ranking.worst) if ranking.worst and not made.ways else ""  # tried, and told so
    chosen = list(choice_lines(made.choice, made.goal)) if made.choice else []
    by = "" if ranking.observer == "shipped" else f", observer {ranking.observer}"
    table = f" The table is about all {len(ranking.icons)} icons together." * bool(chosen)
    short = f"Predicted, not measured: {crowd_text(ranking)}{by}. {intervals_text(ranking).strip()}{table}"
    told: list[Block] = [Heading(chosen[0], 3), Bullets(tuple(chosen[1:]))] if chosen else []
    lines = filter(None, [advice[:1].upper() + advice[1:], f"Next: {following}" if following else ""])
    next_step = [Text("\n".join(lines))]
    return [
        *([Heading(title, 1)] if title and not shown else []),
        *([Text("\n".join(goal_lines(made.goal, "", made.ways)))] if made.goal else []),
        Facts(cards(made), cards=True),
        *([] if shown else next_step),
        *told,
        *([] if details else edits_blocks(made)),
        *([] if shown else table_report(made, "", cures, details)),
        *([Text(ranking.place.text)] if ranking.place else []),
        *(detail_blocks(made) if details else []),
        Text(caveat(ranking) if details else f"{short} More: {'rank ' * (not following)}--details"),
        *(next_step if shown else []),
    ]


def table_report(
    made: SetReport, title: str, cures: Mapping[str, str] | None = None, details: bool = False
) -> list[Block]:
    """What of a ranking's report needs neither intervals nor edits: notes, and the table of icons."""
    icons = made.ranking.best_first
    notes = [Text(line, "warn") for line in trouble_lines(made.ranking.icons, cures or {})]
    outside = [Text(line, "note") for line in outside_lines(icons)]
    shown = max(1, min(len(cures or {}), 3))
    left = len(notes[shown:]) + len(outside[1:])
    if not details and left:
        # What no experiment varied stands on the first screen, beside the worst of what cannot be played.
        more = Text(f"{count_of(left, 'more note')}: thermicon rank --details", "warn")
        notes, outside = notes[:shown], [*outside[:1], more]
    heading = [Heading(title, 1)] if title else []
    return [*heading, *notes, *outside, icon_table(icons, made, None if details else MOST_ROWS)]


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


def cards(made: SetReport) -> tuple[tuple[str, str], ...]:
    """The numbers that are asked first: named, bits, detected, and the worst pair; each with its interval.

    Where icons were chosen, they are those of the chosen as a set of their own.
    """
    ranking, choice = made.ranking, made.choice
    icons, worst = [each for each in ranking.icons if choice is None or each.name in choice.icons], ranking.worst
    elsewhere = ranking.new_laboratory if choice is None else choice.new_laboratory
    least = min(icons, key=lambda icon: icon.detected_probability)
    mean = sum(icon.detected_probability for icon in icons) / len(icons)
    if worst is None:
        return ((percent(mean), "of trials detected"),)
    alert, correct, bits = "felt and named", "named correctly where announced", "of information by names"
    if choice is not None:
        own = choice.at_own_range
        both, information, d_prime = (own.felt_and_named, own.proportion_correct), own.information_bits, own.d_prime
        pair = f"nearest pair: {' and '.join(own.worst_pair)}"
    else:
        both = ranking.felt_and_named, ranking.proportion_correct
        information, d_prime = ranking.information_bits, worst.d_prime
        fine = {icon.name for icon in icons if icon.playable}
        those = " that can be played" if {worst.a, worst.b} <= fine < {*ranking.labels} else ""
        pair = f"worst pair{those}: {worst.a} and {worst.b}, confused in {percent(worst.confused_probability)}"
    if elsewhere is not None:
        within, ends = f"in {laboratory(ranking)} (95 %)", (elsewhere.felt_and_named, elsewhere.proportion_correct)
        low, high = elsewhere.information_bits
    else:
        within, (low, high) = "middle 95 % of people", ranking.information_bits_interval
        ends = ranking.felt_and_named_interval, ranking.proportion_correct_interval
    if elsewhere is not None or (choice is None and ranking.people > 1):
        alert += f"; {within}: {percent_span(*ends[0])}"
        correct += f"; {within}: {percent_span(*ends[1])}"
        bits += f"; {within}: {low:.2f}–{high:.2f}"
    return (
        (percent(both[0]), alert),
        *([(percent(both[1]), correct)] if differs(icons) else []),
        (f"{information:.2f} bits", bits),
        (percent(mean), f"of trials detected; least: {least.name}, {percent(least.detected_probability)}"),
        (f"d′ {number(d_prime)}", pair),
    )


def differs(icons: Sequence[IconScore]) -> bool:
    """Whether any icon is named much more often, where it is announced, than it is both felt and named."""
    return any(icon.proportion_correct - icon.felt_and_named > A_POINT for icon in icons)


def icon_table(icons: Sequence[IconScore], made: SetReport, most: int | None = None) -> Grid:
    """One row per icon, the chosen first, else in this order; those unsafe or not reached have a star and stand apart.

    Of more than `most`, or than are chosen, one row says how many were left out; the last icon stays.
    """
    apart, labels = sum(icon.playable for icon in icons), made.ranking.labels
    chosen = () if made.choice is None else made.choice.icons
    icons = sorted(icons, key=lambda icon: icon.name not in chosen)
    both, elements = differs(icons), made.ranking.elements
    heads: tuple[str, ...] = RANKED_BOTH if both else RANKED
    if elements:
        heads = (heads[0], WHERE, *(head for head in heads[1:] if head != "channel"))  # as wide as a terminal, too
    rows: list[tuple[str | Cell, ...]] = [
        (
            f"{'✓ ' * (icon.name in chosen)}{icon.name}{' *' * (place >= apart)}",
            *([where_text(icon, elements)] if elements else []),
            percent(icon.detected_probability),
            seconds(icon.onset_s),
            *([icon.channel or "–"] if "channel" in heads else []),
            Cell(percent(icon.felt_and_named), "strong"),
            *([percent(icon.proportion_correct)] if both else []),
            rival(made.ranking, labels.index(icon.name)),
        )
        for place, icon in enumerate(icons)
    ]
    if most is not None and len(rows) > (most := max(most, len(chosen))) + 1:
        rest = (f"and {len(rows) - most} more", *[""] * (len(heads) - 1))
        rows = [*rows[:most], rest] if chosen else [*rows[: most - 1], rest, rows[-1]]
        apart = min(apart, len(rows) - (apart < len(icons)))
    return grid(heads, rows, ("detected", "onset", ALERT, NAMED), heads, apart)


def where_text(icon: IconScore, elements: Sequence[str]) -> str:
    """The elements that play an icon, or that all of many do."""
    return "all" if len(icon.where) == len(elements) > 2 else ", ".join(icon.where)


def rival(ranking: Ranking, place: int) -> str:
    """Return the icon that the one at this place is confused with most often, and how often: the mean of both ways."""
    shares = 0.5 * (ranking.confusion[place] + ranking.confusion[:, place])
    others = [(share, name) for k, (share, name) in enumerate(zip(shares, ranking.labels, strict=True)) if k != place]
    if not others:
        return "–"
    share, name = max(others)
    return f"{name} {percent(share)}"


def doubt_report(found: Sensitivity, title: str) -> list[Block]:
    """Report one row per constant that counts, the most important first, and what to measure first."""
    numbers = ("named", "bits", "named low–high")
    rows = [
        (
            effect.constant,
            "episodes or naming"
            if effect.constant == "form of memory"
            else f"{effect.low:.3g} to {effect.high:.3g} {printed_unit(effect.unit)}".rstrip(),
            percent(effect.proportion_correct),
            percent(effect.information_bits),
            f"{percent(effect.at_low)} – {percent(effect.at_high)}",
        )
        for effect in found.effects[:MOST_CONSTANTS]
    ]
    lead = "What to measure first, with the share of the variance of what is named that it would remove:"
    return [
        *([Heading(title, 1)] if title else []),
        grid(("constant", "95 % of draws", *numbers), rows, numbers),
        Text(lead if found.first else "No measurement would narrow the prediction noticeably."),
        Bullets(tuple(f"{percent(each.proportion_correct)}: {each.measurement}" for each in found.first)),
        Text(
            "Shares of the variance between draws of the posterior; constants that trade off share theirs, so that "
            "shares need not add up to 100 %. Beside them the proportion named that is expected at both ends of the "
            f"interval. {found.draws} draws for {crowd_text(found)} (seed {found.seed}, memory: "
            f"{found.memory}): contact and outermost layer of the skin vary too, unlike in the intervals of rank."
        ),
    ]
