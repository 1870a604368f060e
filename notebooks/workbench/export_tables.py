"""The export view's tables as HTML: what the device delivers, the gate's verdict, and why writing is refused."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

from thermicon.icons.number_text import number, percent

from ..cli.export import CAUTION, steps_of
from ..report.blocks import fragment
from ..report.gate_words import gate_words, short_scenario

if TYPE_CHECKING:
    from thermicon.circuit import Export
    from thermicon.circuit.delivery.prepare import Prepared
    from thermicon.circuit.safety.checks import Check
    from thermicon.perception.identification.delivered import PerceivedChange

COLOURS = {"green": "th-good", "amber": "th-caution", "red": "th-bad"}


def delivered_html(ready: Export, remarks: Sequence[str] = ()) -> str:
    """One row per icon: duration, deviation from the design, detection and safety; then demands, refusals, warnings.

    ``remarks`` are what could not be compared.
    """
    felt = {change.icon: change for change in cast("tuple[PerceivedChange, ...]", ready.felt)}
    whose = ", ".join(dict.fromkeys(change.detected_by for change in felt.values()))
    detected = f"detected by {whose}" if whose else "detected"
    columns = ("icon", "duration", "rate", "receptors within", "rms", detected, "d′ changes by", "safety")
    rows = [_delivered(icon, felt.get(icon.delivery.icon.name)) for icon in ready.prepared]
    names: dict[str, list[str]] = {}  # one line for all icons that share a warning
    for icon in ready.prepared:
        for warning in icon.warnings:
            names.setdefault(warning, []).append(icon.delivery.icon.name)
    warnings = [f"{', '.join(icons)}: {warning}" for warning, icons in names.items()]
    told = dict.fromkeys(line.removeprefix("warning: ") for line in (*remarks, *warnings))
    refusals = [f"{name}: {refusal}" for name, refusal in ready.refused]
    return fragment("delivered", columns, rows, gate_words(ready.prepared), refusals, list(told))


def _delivered(icon: Prepared, felt: PerceivedChange | None) -> tuple[tuple[str, ...], str, str]:
    """Cells of an icon but the last, and the gate's colour with its style."""
    delivery, receptors = icon.delivery, [place for place in icon.deviation.places if "receptor" in place.place]
    largest = max((abs(place.largest_K), place.at_s) for place in receptors)
    moved = max(((abs(c.delivered - c.designed), other) for other, c in felt.d_prime), default=None) if felt else None
    cells = (
        delivery.icon.name,
        f"{number(delivery.file_s, 2)} s",
        steps_of(delivery).removeprefix("at ").removeprefix("in "),
        f"{number(1e3 * largest[0])} mK at {largest[1]:.2f} s",
        f"{number(1e3 * max(place.rms_K for place in receptors))} mK",
        f"{percent(felt.detection.designed)} → {percent(felt.detection.delivered)}" if felt else "–",
        f"{number(moved[0], 2)} from {moved[1]}" if moved else "–",
    )
    return cells, icon.verdict.colour, COLOURS[icon.verdict.colour]


def gate_html(icon: Prepared) -> str:
    """The gate's verdict on one icon: every rule with its worst value, the limit, time and scenario.

    Scenarios are shortened, in full as tooltips; sources are numbered below the table.
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
    """What the template prints for one rule."""
    unit, (worst, limit) = "" if check.unit == "1" else f" {check.unit}", check.figures
    kind = "" if check.passed else "bad" if check.severity == "hard" else "amber"
    return {
        "kind": kind,
        "mark": {"": "ok", "bad": "RED", "amber": "amber"}[kind],
        "quantity": check.quantity,
        "worst": f"{worst}{unit}",
        "limit": f"{'≤' if check.upper else '≥'} {limit}{unit} {check.severity}",
        "source": check.source,
        "source_number": source_number,
        "time": f"{check.time_s:.2f} s",
        "scenario": check.scenario,
        "short_scenario": short_scenario(check.scenario),
    }


def written_html(ready: Export, folder: Path, before: Path | None) -> str:
    """Which files were written, where the folder as it was before stands, and how to play the drives."""
    drives = "1 drive with its sidecar" if len(ready.prepared) == 1 else f"{len(ready.prepared)} drives with sidecars"
    sentence = f"wrote {drives} into {folder.resolve()}"
    return fragment("written", sentence, list(ready.files), before, f"to play: {ready.form.how}", CAUTION)
