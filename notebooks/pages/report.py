"""``rank --report``: everything about one ranking as a single page that can be mailed, printed and read on a phone."""

from __future__ import annotations

import platform
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from ..text import rank_notes as beside
from ..text import rank_text as told
from ..text.byrules import rules_caveat, rules_lines
from ..text.choices import choice_lines
from ..text.number_text import number, percent, seconds
from .report_page import Cell, bullets, cards, element, facts, grid, page
from .report_views import icon_parts, view_parts

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Ranking

MOST_PAIRS = 60
LIMITS = (
    "Everything here follows from a model of the skin and of its receptors, calibrated on published thresholds. No "
    "experiment has confirmed it for these icons.",
    "The order of icons is less sure than the overall level: for the six icons of the one published experiment that it "
    "can be held against, the model's best icon was the worst.",
    "Onsets come out later than the windows usually quoted, those of warmth most.",
    "The skin is a stack of flat layers: no edges, no spread sideways, one patch at a time. Pain, adaptation over "
    "minutes, training, attention and several elements at once are outside the model.",
    "Intervals over people hold what differs between people, not what is wrong with the model. The interval over the "
    "model's parameters, where there is one, holds what data leave open, for this structure of the model.",
)
SAFETY = (
    "Icons were held against limits of temperature for skin and display, which are this project's own, set inside "
    "published ones (ISO 13732, IEC 60601-1). That is a calculation and not a medical or ethical clearance. Hardware "
    "that touches people needs its own temperature cut-off that works without any software."
)


def report(
    ranking: Ranking,
    icons: IconSet,
    rig: Rig,
    command: str = "",
    cures: Mapping[str, str] | None = None,
    date: str = "",
) -> str:
    """The page as HTML text: the same bytes for the same arguments.

    ``icons`` and ``rig`` are those that were ranked; ``command`` is shown as what was asked, ``cures`` say by name how
    an icon that is not reached could be, and a ``date`` stands in the page only where it is given.
    """
    from thermicon.perception.ranking.rank_file import ranking_file

    result = ranking_file(ranking, mapped=False)  # the map is drawn, not told
    title = icons.title or "Thermal icons"
    parts = [
        *_head(result, ranking, title),
        *_asked(result, icons, rig, command, date),
        *_warnings(result, cures or {}),
        *_ranking(result, ranking),
        *_worst(result),
        *view_parts(ranking),
        *_pairs(result),
        *_rules(result),
        *icon_parts(result, icons, rig),
        element("h2", "Limits of the prediction"),
        bullets(LIMITS),
        element("h2", "Safety"),
        element("p", SAFETY),
    ]
    return page(f"{title}: predicted ranking", parts)


def _head(result: dict[str, Any], ranking: Ranking, title: str) -> Iterator[str]:
    whole, count = result["set"], len(result["icons"])
    yield element("h1", title)
    yield element("p", f"Predicted ranking of {'1 icon' if count == 1 else f'{count} icons'} by thermicon", "lead")
    yield element("p", rules_caveat(result) if ranking.by == "rules" else told.caveat(result), "note")
    if ranking.by == "rules":
        apart = sum(pair["told_apart_by_rules"] for pair in result["pairs"])
        yield cards(
            [(f"{apart} of {len(result['pairs'])}", "pairs distinguishable by rules")] if result["pairs"] else []
        )
        return
    spread = "" if ranking.people == 1 else "; for 95 % of people {} to {}"
    low, high = whole["proportion_correct_interval"]
    shown = [(percent(whole["proportion_correct"]), "named correctly" + spread.format(percent(low), percent(high)))]
    if whole["information_bits"] is not None:
        low, high = whole["information_bits_interval"]
        shown.append(
            (f"{whole['information_bits']:.2f} bits", "of information" + spread.format(f"{low:.2f}", f"{high:.2f}"))
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
    yield cards(shown)


def _asked(result: dict[str, Any], icons: IconSet, rig: Rig, command: str, date: str) -> Iterator[str]:
    changes = ", ".join(result["rig_changes"]) or "none"
    draws = result["set"]["parameter_draws"]
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    rows = [
        ("command", command),
        ("date", date),
        ("rig", f"{result['rig']}: {rig.site}, {rig.contact.area_m2 * 1e4:g} cm²; changes: {changes}"),
        ("people", f"{result['people']} virtual, seed {result['seed']}"),
        ("each person gets", f"{result['tracking']} tracking"),
        ("difference over time", f"{result['norm']} norm"),
        ("icons are asked for", beside.asked_so(result["task"]).removeprefix(", ")),
        ("draws of the parameters", str(draws) if draws else ""),
        ("experiment foretold", f"{result['set']['trials']} trials"),
        ("made with", f"thermicon {result['thermicon']}, Python {platform.python_version()}, {versions}"),
        ("content hash", result["content_hash"]),
    ]
    yield element("h2", "What was asked")
    yield facts([row for row in rows if row[1]])
    yield element("p", "The hash is of the icons' text, the rig and the observer's numbers: equal hashes, equal input.")


def _warnings(result: dict[str, Any], cures: Mapping[str, str]) -> Iterator[str]:
    lines = beside.trouble_lines(result["icons"], cures)
    outside = beside.outside_lines(result["icons"])
    if lines or outside:
        yield element("h2", "Warnings")
        yield from (element("p", line, "warn") for line in lines)
        yield from (element("p", line, "note") for line in outside)


def _ranking(result: dict[str, Any], ranking: Ranking) -> Iterator[str]:
    yield element("h2", "Ranking")
    rows = ranking.rows()
    if ranking.by == "rules":
        cells = [
            [
                *(str(place), row["icon"], percent(row["rules_score"])),
                *(f"{row['rules_passed']} of {row['rules']}", str(row["pairs_apart_by_rules"])),
            ]
            for place, row in enumerate(rows, 1)
        ]
        counts = ("place", "score", "rules passed", "pairs apart")
        yield grid(("place", "icon", *counts[1:]), cells, counts)
        lines = [line.strip().removeprefix("- ") for line in rules_lines(result) if line.strip()]
        worst = next((k for k, line in enumerate(lines) if line.startswith("Worst pair")), len(lines))
        yield bullets(lines[:worst])
        yield from (element("h3", line) for line in lines[worst : worst + 1])
        yield bullets(lines[worst + 1 :])
        return
    labels = result["confusion"]["labels"]
    made = []
    for place, row in enumerate(rows, 1):
        apart = not (row["safe"] and row["reachable"])
        trouble = ["not safe"] * (not row["safe"]) + ["not reached"] * (not row["reachable"])
        made.append(
            [
                *("*" if apart else str(place), row["icon"], Cell(percent(row["proportion_correct"]), strong=True)),
                *(percent(row["detected_probability"]), seconds(row["onset_s"]), row["channel"] or "–"),
                *(told.rival(result["confusion"], labels.index(row["icon"])), ", ".join(trouble) or "yes"),
            ]
        )
    columns = ("place", "icon", "correct", "detected", "onset", "felt as", "most confused with", "plays")
    yield grid(columns, made, ("place", "correct", "detected", "onset"))
    if result["chosen"]:
        best, *more = choice_lines(result["chosen"])
        yield element("h3", best)
        yield bullets([line.strip().removeprefix("- ") for line in more])
    yield element("h2", "The set")
    lines = [*told.number_lines(result), *beside.norm_lines(result), *beside.carried_lines(result["icons"])]
    yield bullets([line.removeprefix("Set: ").strip() for line in lines])


def _worst(result: dict[str, Any]) -> Iterator[str]:
    if result["by"] == "rules" or not result["set"]["worst_pair"]:
        return
    first, *reasons = told.worst_lines(result)
    yield element("h2", first)
    yield bullets([line.strip().removeprefix("- ") for line in reasons])
    (pair,) = (p for p in result["pairs"] if [p["a"], p["b"]] == result["set"]["worst_pair"])
    yield element("h3", "What the distance is made of")
    rows = []
    for part in pair["parts"]:
        own = "K/s" if part["part"] == "rate" else part["unit"]
        shown = [_sized(part[key], own if key in "ab" else part["unit"]) for key in ("a", "b", "value", "noticeable")]
        rows.append([part["part"], *shown, "–" if part["above"] is None else "yes" if part["above"] else "no"])
    yield grid(("part", pair["a"], pair["b"], "differs by", "just noticed", "above it"), rows)
    yield element(
        "p", "Just noticed is said of icons felt back to back; naming one from memory takes several times as much."
    )


def _sized(value: float | None, unit: str) -> str:
    """A number of a part with its unit; a factor has a sign of multiplication.

    >>> _sized(1.5, "s"), _sized(2.0, "1"), _sized(None, "s")
    ('1.50 s', '2.00 ×', '–')
    """
    if value is None:
        return "–"
    written = "×" if unit == "1" else unit
    return f"{value:.2f} {written}" if abs(value) < 10 else f"{value:.1f} {written}"


def _pairs(result: dict[str, Any]) -> Iterator[str]:
    if result["by"] == "rules" or not result["pairs"]:
        return
    yield element("h2", "Pairs, the most confused first")
    rows = sorted(result["pairs"], key=lambda pair: (-pair["confused_probability"], pair["a"], pair["b"]))
    names = [part["part"] for part in rows[0]["parts"]]
    cells = [
        [
            *(pair["a"], pair["b"], Cell(f"{pair['d_prime']:.1f}", strong=True)),
            f"{100 * pair['confused_probability']:.1f} %",
            *(Cell(_sized(part["value"], part["unit"]), strong=bool(part["above"])) for part in pair["parts"]),
        ]
        for pair in rows[:MOST_PAIRS]
    ]
    yield grid(("icon", "and", "d′", "confused", *names), cells, ("d′", "confused", *names))
    more = f" {len(rows) - MOST_PAIRS} more pairs are in the JSON." if len(rows) > MOST_PAIRS else ""
    yield element("p", f"Bold parts are above what is just noticed back to back.{more}")


def _rules(result: dict[str, Any]) -> Iterator[str]:
    yield element("h2", "Rules of thumb")
    rules = [(icon["name"], rule) for icon in result["icons"] for rule in icon["rules"]]
    rules += [("the rig", rule) for rule in result["set"]["rules"]]
    failed = [[name, rule["text"], rule["source"]] for name, rule in rules if not rule["pass"]]
    apart = sum(pair["told_apart_by_rules"] for pair in result["pairs"])
    pairs = f" Rules alone tell {apart} of {len(result['pairs'])} pairs apart." if result["pairs"] else ""
    yield element(
        "p", f"{len(rules) - len(failed)} of {len(rules)} rules on icons and rig pass.{pairs} Those that fail:"
    )
    yield grid(("icon", "rule", "source"), failed) if failed else element("p", "none.")
    if result["set"]["rules_disagree"]:
        first, *more = told.disagreement_lines(result["set"]["rules_disagree"])
        yield element("p", first)
        yield bullets([line.strip().removeprefix("- ") for line in more])
