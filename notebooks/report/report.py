"""``rank --report``: one ranking as a single page that can be mailed, printed and read on a phone."""

from __future__ import annotations

import platform
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import number, percent, percent_span, seconds

from . import rank_notes, rank_text
from .blocks import Block, Bullets, Cards, Cell, Code, Facts, Heading, Text, as_html, grid
from .choices import choice_lines, goal_lines, laboratory
from .rank_notes import rules_caveat, rules_lines
from .report_views import icon_parts, view_parts

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Ranking

    from .set_report import SetReport

MOST_PAIRS = 60
OWN_UNITS = {"intensity": "1", "rate": "× per s", "duration": "s", "pause": "s"}
"""Units of what single icons have of a component, where 1 is a multiple of threshold; differences are in d′."""
LIMITS = (
    "Everything here follows from a model of the skin and of its receptors, calibrated on published thresholds. No "
    "experiment has confirmed it for these icons.",
    "The order of icons is less certain than the overall level: for the six icons of the only published experiment "
    "that it can be checked against, the model does not find the order.",
    "Predicted onsets are later than the usually quoted windows, those of warmth most.",
    "The skin is a stack of flat layers: no edges, no lateral heat flow, one patch at a time. Pain, adaptation over "
    "minutes, training, attention and several simultaneous elements are outside the model.",
    "Intervals over people cover differences between people, not errors of the model. The model uncertainty, where it "
    "is given, covers what the data leave open, for this structure of the model.",
)
SAFETY = (
    "Icons were checked against temperature limits for skin and display that are this project's own and stricter than "
    "published ones (ISO 13732, IEC 60601-1). This is a calculation, not a medical or ethical clearance. Hardware that "
    "touches people needs its own temperature cut-off that works without any software."
)


def report(
    made: SetReport,
    icons: IconSet,
    rig: Rig,
    command: str = "",
    cures: Mapping[str, str] | None = None,
    date: str = "",
) -> str:
    """Write the page as HTML text: the same bytes for the same arguments.

    ``icons`` and ``rig`` are those that were ranked, ``command`` reproduces the ranking, ``cures`` explain by name how
    an icon could be reached, and a ``date`` is printed only if it is given.
    """
    ranking, result = made.ranking, made.to_dict(mapped=False)  # the map is drawn, not printed
    title = icons.title or "Thermal icons"
    parts: list[Block] = [
        *_head(result, ranking, title),
        *_settings(result, icons, rig, command, date),
        *_goal(result),
        *_warnings(result, cures or {}),
        *_ranking(result, ranking),
        *_worst(result),
        *view_parts(ranking),
        *_pairs(result),
        *_rules(result),
        *icon_parts(result, icons, rig),
        *_rig(result),
        Heading("Limits of the prediction"),
        Bullets(LIMITS),
        Heading("Safety"),
        Text(SAFETY),
    ]
    return as_html(parts, f"{title}: predicted ranking")


def _head(result: dict[str, Any], ranking: Ranking, title: str) -> Iterator[Block]:
    whole, count = result["set"], len(result["icons"])
    yield Heading(title, 1)
    yield Text(f"Predicted ranking of {'1 icon' if count == 1 else f'{count} icons'} by thermicon", "lead")
    yield Text(rules_caveat(result) if ranking.by == "rules" else rank_text.caveat(result), "note")
    if ranking.by == "rules":
        apart = sum(pair["distinguishable_by_rules"] for pair in result["pairs"])
        if result["pairs"]:
            yield Cards(((f"{apart} of {len(result['pairs'])}", "pairs distinguishable by the rules"),))
        return
    spread = "" if ranking.people == 1 else "; middle 95 % of people: {}"
    low, high = whole["proportion_correct_interval"]
    shown = [(percent(whole["proportion_correct"]), "named correctly" + spread.format(percent_span(low, high)))]
    if whole["information_bits"] is not None:
        low, high = whole["information_bits_interval"]
        shown.append(
            (f"{whole['information_bits']:.2f} bits", "of information" + spread.format(f"{low:.2f}–{high:.2f}"))
        )
        shown.append((f"{whole['bits_per_s']:.2f} bits/s", "at the mean duration of the icons"))
    for pair in result["pairs"]:
        if whole["worst_pair"] == [pair["a"], pair["b"]]:
            confused = f"most often confused, in {percent(pair['confused_probability'])} of trials"
            shown.append(
                (
                    f"d′ {number(pair['d_prime'])}",
                    f"between {pair['a']} and {pair['b']}, {confused}",
                )
            )
    yield Cards(tuple(shown))


def _settings(result: dict[str, Any], icons: IconSet, rig: Rig, command: str, date: str) -> Iterator[Block]:
    changes = ", ".join(result["rig_changes"]) or "none"
    draws = result["set"]["posterior_draws"]
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    rows = [
        ("command", command),
        ("date", date),
        ("rig", f"{result['rig']}: {rig.site}, {rig.contact.area_m2 * 1e4:g} cm²; changes: {changes}"),
        ("people", f"{result['people']} virtual, seed {result['seed']}"),
        ("same for all people", f"{result['tracking']} tracking"),
        ("what is remembered", f"{result['norm']} norm"),
        ("task", rank_notes.task_note(result["task"]).removeprefix(", ")),
        ("draws of the posterior", str(draws) if draws else ""),
        ("predicted experiment", f"{result['set']['trials']} trials"),
        ("made with", f"thermicon {result['thermicon']}, Python {platform.python_version()}, {versions}"),
        ("content hash", result["content_hash"]),
    ]
    yield Heading("Settings")
    yield Facts(tuple(row for row in rows if row[1]))
    yield Text("The hash covers the icons' text, the rig and the observer's parameters: equal hashes mean equal input.")


def _goal(result: dict[str, Any]) -> Iterator[Block]:
    if result["goal"]:
        lines = list(goal_lines(result["goal"]))
        yield Heading("Goal")
        yield Text(lines[0])
        yield Bullets(tuple(line.strip() for line in lines[1:]))


def _rig(result: dict[str, Any]) -> Iterator[Block]:
    yield Heading("Rig file")
    yield Text("The whole rig as it was used, changes included.")
    yield Code(result["rig_text"])


def _warnings(result: dict[str, Any], cures: Mapping[str, str]) -> Iterator[Block]:
    lines = rank_notes.trouble_lines(result["icons"], cures)
    outside = rank_notes.outside_lines(result["icons"])
    said = [f"warning: {line}" for line in result["warnings"]]
    if lines or outside or said:
        yield Heading("Warnings")
        yield from (Text(line, "warn") for line in said)
        yield from (Text(line, "warn") for line in lines)
        yield from (Text(line, "note") for line in outside)


def _ranking(result: dict[str, Any], ranking: Ranking) -> Iterator[Block]:
    yield Heading("Ranking")
    rows = ranking.rows()
    if ranking.by == "rules":
        cells = [
            [
                *(str(place), row["icon"], percent(row["rules_score"])),
                *(f"{row['rules_passed']} of {row['rules']}", str(row["pairs_distinguishable_by_rules"])),
            ]
            for place, row in enumerate(rows, 1)
        ]
        counts = ("place", "score", "rules passed", "distinct pairs")
        yield grid(("place", "icon", *counts[1:]), cells, counts)
        lines = [line.strip().removeprefix("- ") for line in rules_lines(result) if line.strip()]
        worst = next((k for k, line in enumerate(lines) if line.startswith("Worst pair")), len(lines))
        yield Bullets(tuple(lines[:worst]))
        yield from (Heading(line, 3) for line in lines[worst : worst + 1])
        yield Bullets(tuple(lines[worst + 1 :]))
        return
    labels = result["confusion"]["labels"]
    made = []
    for place, row in enumerate(rows, 1):
        apart = not (row["safe"] and row["reachable"])
        trouble = ["not safe"] * (not row["safe"]) + ["not reached"] * (not row["reachable"])
        made.append(
            [
                *("*" if apart else str(place), row["icon"], Cell(percent(row["proportion_correct"]), "strong")),
                *(percent(row["detected_probability"]), seconds(row["onset_s"]), row["channel"] or "–"),
                *(rank_text.rival(result["confusion"], labels.index(row["icon"])), ", ".join(trouble) or "yes"),
            ]
        )
    columns = ("place", "icon", "correct", "detected", "onset", "felt as", "most confused with", "playable")
    yield grid(columns, made, ("place", "correct", "detected", "onset"))
    if result["chosen"]:
        best, *more = choice_lines(result["chosen"], laboratory(result["observer"], result["set"]["own_laboratory"]))
        yield Heading(best, 3)
        yield Bullets(tuple(line.strip().removeprefix("- ") for line in more))
    yield Heading("The set")
    lines = [
        *rank_text.number_lines(result),
        *rank_notes.norm_lines(result),
        *rank_notes.carried_lines(result["icons"]),
    ]
    yield Bullets(tuple(line.removeprefix("Set: ").strip() for line in lines))


def _worst(result: dict[str, Any]) -> Iterator[Block]:
    if result["by"] == "rules" or not result["set"]["worst_pair"]:
        return
    first, *reasons = rank_text.worst_lines(result)
    yield Heading(first)
    yield Bullets(tuple(line.strip().removeprefix("- ") for line in reasons))
    (pair,) = (p for p in result["pairs"] if [p["a"], p["b"]] == result["set"]["worst_pair"])
    yield Heading("Components of the distance", 3)
    rows = []
    for part in pair["parts"]:
        own = OWN_UNITS.get(part["part"], part["unit"])
        shown = [_sized(part[key], own if key in "ab" else part["unit"]) for key in ("a", "b", "value", "noticeable")]
        rows.append([part["part"], *shown, "–" if part["above"] is None else "yes" if part["above"] else "no"])
    yield grid(("component", pair["a"], pair["b"], "difference", "just noticeable", "noticeable"), rows)
    yield Text(
        "Intensity and rate are in multiples of threshold. Just noticeable holds for icons played back to back; naming "
        "one from memory needs several times as much."
    )


def _sized(value: float | None, unit: str) -> str:
    """Write a component with its unit; a factor has a multiplication sign.

    >>> _sized(1.5, "s"), _sized(2.0, "1"), _sized(None, "s")
    ('1.50 s', '2.00 ×', '–')
    """
    if value is None:
        return "–"
    written = "×" if unit == "1" else unit
    return f"{value:.2f} {written}" if abs(value) < 10 else f"{value:.1f} {written}"


def _pairs(result: dict[str, Any]) -> Iterator[Block]:
    if result["by"] == "rules" or not result["pairs"]:
        return
    yield Heading("Pairs, the most confused first")
    rows = sorted(result["pairs"], key=lambda pair: (-pair["confused_probability"], pair["a"], pair["b"]))
    names = [part["part"] for part in rows[0]["parts"]]
    cells = [
        [
            *(pair["a"], pair["b"], Cell(f"{pair['d_prime']:.1f}", "strong")),
            f"{100 * pair['confused_probability']:.1f} %",
            *(Cell(_sized(part["value"], part["unit"]), "strong" if part["above"] else "") for part in pair["parts"]),
        ]
        for pair in rows[:MOST_PAIRS]
    ]
    yield grid(("icon", "and", "d′", "confused", *names), cells, ("d′", "confused", *names))
    more = f" {len(rows) - MOST_PAIRS} more pairs are in the JSON." if len(rows) > MOST_PAIRS else ""
    yield Text(f"Components in bold are above the just noticeable difference of icons played back to back.{more}")


def _rules(result: dict[str, Any]) -> Iterator[Block]:
    yield Heading("Rules of thumb")
    rules = [(icon["name"], rule) for icon in result["icons"] for rule in icon["rules"]]
    rules += [("the rig", rule) for rule in result["set"]["rules"]]
    failed = [[name, rule["text"], rule["source"]] for name, rule in rules if not rule["pass"]]
    apart = sum(pair["distinguishable_by_rules"] for pair in result["pairs"])
    pairs = f" The rules alone distinguish {apart} of {len(result['pairs'])} pairs." if result["pairs"] else ""
    yield Text(f"{len(rules) - len(failed)} of {len(rules)} rules on icons and rig pass.{pairs} The following fail:")
    yield grid(("icon", "rule", "source"), failed) if failed else Text("none.")
    if result["set"]["rules_disagree"]:
        first, *more = rank_text.disagreement_lines(result["set"]["rules_disagree"])
        yield Text(first)
        yield Bullets(tuple(line.strip().removeprefix("- ") for line in more))
