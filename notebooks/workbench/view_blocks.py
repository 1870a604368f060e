"""Report blocks as HTML in the style of the workbench."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import cast

from thermicon.base.words.number_text import number, percent
from thermicon.circuit import Export
from thermicon.circuit.delivery.prepare import Prepared
from thermicon.circuit.safety.checks import Check
from thermicon.perception.identification.delivered import PerceivedChange
from thermicon.perception.ranking.scores import PairScore
from thermicon.perception.selection.edit import Edit, NoEdit

from ..report.blocks import Bullets, Cell, Facts, Heading, Text, fragment, grid, shown
from ..report.gate_words import CAUTION, gate_words, steps_of, warning_lines
from ..report.rank_details import caveat, edit_words, outside_lines, trouble_lines
from ..report.rank_report import cards, icon_table
from ..report.set_report import SetReport
from ..timeline.frames import WORDS, terms_of

ALONE = "The set has only one icon, so there are no distances to show."
COLOURS = {"green": "th-good", "amber": "th-caution", "red": "th-bad"}
ASKED = (
    "d′",
    "bits",
    "detected",
    "felt",
    "onset",
    "felt and named",
    "named",
    "middle 95 % of people",
    *WORDS["simulated"],
)
"""Words that are explained below a set."""


def set_html(made: SetReport) -> dict[str, str]:
    """The text about a ranking, by the names of its parts.

    Parts are: scores with the interval of the laboratory that is predicted; one row per icon, the best first; notes of
    what is unsafe, out of reach or out of the range of the data; and what the numbers rest on.
    """
    ranking, icons, observer = made.ranking, made.ranking.icons, made.ranking.observer
    past = sum(not icon.safe for icon in icons)
    limits = f"{past} past a hard limit" if past else "no icon past a hard limit"
    by = "" if observer == "shipped" else f" Predicted with the observer of {observer}."
    meaning = "Confusion: share of trials in which the icon of a row is answered with that of a column."
    simulated = f"Limits of this simulation: {limits}; export judges worst cases."
    return {
        "scores": shown(Text(ALONE, "note") if len(icons) == 1 else Facts(cards(made), cards=True)),
        "table": shown(icon_table(ranking.best_first, made)),
        "notes": shown(*(Text(line, "note") for line in (*trouble_lines(icons, {}), *outside_lines(icons)))),
        "caveat": shown(Text(f"{meaning} {caveat(ranking)}{by} {simulated}", "soft"))
        + fragment("terms", terms_of(*ASKED)),
    }


def pair_html(pair: PairScore) -> str:
    """Which two icons form a pair, and how often they are confused."""
    sentence = f"confused in {percent(pair.confused_probability)} of trials, d′ {number(pair.d_prime)}"
    return shown(Heading(f"{pair.a} and {pair.b}"), Text(sentence))


def edit_html(edit: Edit | NoEdit | None) -> str:
    """The cheapest edit of a pair, or why there is none."""
    if edit is None:
        return shown(Text("looking for the cheapest edit …", "status"))
    if isinstance(edit, NoEdit):
        return shown(Text(f"no edit: {edit.reason}", "soft"))
    return shown(Text(f"cheapest edit: {edit_words(edit)}"))


def delivered_html(ready: Export, remarks: Sequence[str] = ()) -> str:
    """One row per icon: duration, deviation from the design, detection and safety; then demands, refusals, warnings.

    ``remarks`` are what could not be compared.
    """
    felt = {change.icon: change for change in cast("tuple[PerceivedChange, ...]", ready.felt)}
    whose = ", ".join(dict.fromkeys(change.detected_by for change in felt.values()))
    detected = f"detected by {whose}" if whose else "detected"
    columns = ("icon", "duration", "rate", "receptors within", "rms", detected, "d′ changes by", "safety")
    return shown(
        grid(columns, [_delivered(icon, felt.get(icon.delivery.icon.name)) for icon in ready.prepared]),
        Facts(tuple(gate_words(ready.prepared))),
        *(Text(f"{name}: {refusal}", "note th-bad") for name, refusal in ready.refused),
        *(Text(line, "note") for line in dict.fromkeys((*remarks, *warning_lines(ready.prepared)))),
    )


def _delivered(icon: Prepared, felt: PerceivedChange | None) -> tuple[str | Cell, ...]:
    delivery, receptors = icon.delivery, [place for place in icon.deviation.places if "receptor" in place.place]
    largest = max((abs(place.largest_K), place.at_s) for place in receptors)
    moved = max(((abs(c.delivered - c.designed), other) for other, c in felt.d_prime), default=None) if felt else None
    return (
        delivery.icon.name,
        f"{number(delivery.file_s, 2)} s",
        steps_of(delivery)[1],
        f"{number(1e3 * largest[0])} mK at {largest[1]:.2f} s",
        f"{number(1e3 * max(place.rms_K for place in receptors))} mK",
        f"{percent(felt.detection.designed)} → {percent(felt.detection.delivered)}" if felt else "–",
        f"{number(moved[0], 2)} from {moved[1]}" if moved else "–",
        Cell(icon.verdict.colour, COLOURS[icon.verdict.colour]),
    )


def gate_html(icon: Prepared) -> str:
    """The gate's verdict on one icon: every rule with its worst value, the limit, time and scenario.

    Sources are numbered below the table.
    """
    verdict = icon.verdict
    checks: Sequence[Check] = getattr(verdict, "checks", ())
    exceeded = sum(not check.passed for check in checks)
    kept = f"{exceeded} of {len(checks)} limits exceeded" if exceeded else f"all {len(checks)} limits kept"
    sources = {source: place for place, source in enumerate(dict.fromkeys(check.source for check in checks), 1)}
    return fragment(
        "gate",
        icon.delivery.icon.name,
        verdict.colour,
        COLOURS[verdict.colour],
        f"{kept} in {verdict.scenarios} scenarios",
        ("", "quantity", "worst", "limit", "at", "scenario"),
        [_check(check, sources[check.source]) for check in sorted(checks, key=lambda check: check.passed)],
        list(sources),
    )


def _check(check: Check, source_number: int) -> dict[str, object]:
    """The template's fields for one rule."""
    unit, (worst, limit) = "" if check.unit == "1" else f" {check.unit}", check.figures
    kind, mark = ("", "ok") if check.passed else ("bad", "RED") if check.severity == "hard" else ("amber", "amber")
    return {
        "kind": kind,
        "mark": mark,
        "quantity": check.quantity,
        "worst": f"{worst}{unit}",
        "limit": f"{'≤' if check.upper else '≥'} {limit}{unit} {check.severity}",
        "source": check.source,
        "source_number": source_number,
        "time": f"{check.time_s:.2f} s",
        "scenario": check.scenario,
    }


def written_html(ready: Export, folder: Path, before: Path | None) -> str:
    """Which files were written, where the folder as it was before stands, and how to play the drives."""
    drives = "1 drive with its sidecar" if len(ready.prepared) == 1 else f"{len(ready.prepared)} drives with sidecars"
    older = "" if before is None else f"the folder as it was before is {before}"
    return shown(
        Text(f"wrote {drives} into {folder.resolve()}", "good"),
        Bullets(tuple(ready.files)),
        *(Text(line, "soft") for line in (older, f"to play: {ready.form.how}", CAUTION)),
    )
