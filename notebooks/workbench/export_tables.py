"""What the export view says in words: how icons are delivered, the gate's verdict, and what speaks against writing."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

from thermicon.circuit.inputs import signed

from ..cli.export import CAUTION, steps_of
from ..text.gate_words import gate_words, short_scenario
from ..text.number_text import number, percent

if TYPE_CHECKING:
    from thermicon.circuit import Prepared
    from thermicon.circuit.safety.checks import Check
    from thermicon.perception import PerceivedChange

    from ..files.exporting import Ready, Written

COLOURS = {"green": "th-good", "amber": "th-caution", "red": "th-bad"}


def delivered_html(ready: Ready) -> str:
    """A row for every icon: how long, how near to the design, detection and safety; then warnings and refusals."""
    head = ("icon", "lasts", "rate", "receptors within", "rms", "detected", "d′ changes by", "safety")
    felt = {change.icon: change for change in ready.felt}
    rows = "".join(_delivered(one, felt.get(one.delivery.icon.name)) for one in ready.prepared)
    cells = "".join(f"<th>{name}</th>" for name in head)
    table = f'<table class="th"><thead><tr>{cells}</tr></thead><tbody>{rows}</tbody></table>'
    told: dict[str, list[str]] = {}  # what holds for many icons is said once
    for one in ready.prepared:
        name = one.delivery.icon.name
        for line in one.warnings:
            told.setdefault(line, []).append(name)
    warned = [f"{', '.join(names)}: {said}" for said, names in told.items()]
    notes = [line.removeprefix("warning: ") for line in (*ready.warnings, *warned)]
    against = "".join(
        f'<div class="th-note th-bad">{escape(name)}: {escape(str(refusal))}</div>' for name, refusal in ready.against
    )
    noted = "".join(f'<div class="th-note">{escape(line)}</div>' for line in dict.fromkeys(notes))
    return table + asked_html(ready.prepared) + against + noted


def asked_html(prepared: Sequence[Prepared]) -> str:
    """How icons may be repeated and what the hardware must provide, in two columns; empty if none is safe."""
    rows = "".join(f"<tr><th>{escape(about)}</th><td>{escape(text)}</td></tr>" for about, text in gate_words(prepared))
    return f'<table class="th asked"><tbody>{rows}</tbody></table>' if rows else ""


def _delivered(one: Prepared, felt: PerceivedChange | None) -> str:
    delivery, receptors = one.delivery, [each for each in one.deviation.places if "receptor" in each.place]
    largest = max((abs(each.largest_K), each.at_s) for each in receptors)
    moved = max(((abs(c.delivered - c.designed), other) for other, c in felt.d_prime), default=None) if felt else None
    cells = (
        escape(delivery.icon.name),
        f"{number(delivery.file_s, 2)} s",
        steps_of(delivery).removeprefix("at ").removeprefix("in "),
        f"{number(1e3 * largest[0])} mK at {largest[1]:.2f} s",
        f"{number(1e3 * max(each.rms_K for each in receptors))} mK",
        f"{percent(felt.detection.designed)} → {percent(felt.detection.delivered)}" if felt else "–",
        f"{number(moved[0], 2)} to {escape(moved[1])}" if moved else "–",
        f'<span class="{COLOURS[one.verdict.colour]}">{one.verdict.colour}</span>',
    )
    return '<tr class="tight">' + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def gate_html(one: Prepared) -> str:
    """The gate's verdict on one icon: every rule with its worst value, the limit, when and in which scenario.

    Scenarios are shortened, in full when pointed at; sources stand beneath the table.
    """
    verdict = one.verdict
    checks: Sequence[Check] = getattr(verdict, "checks", ())
    name, beyond = escape(one.delivery.icon.name), sum(not check.passed for check in checks)
    summary = f'{name}: <span class="{COLOURS[verdict.colour]}">safety {verdict.colour}</span>'
    kept = f"{beyond} of {len(checks)} limits exceeded" if beyond else f"{len(checks)} limits kept"
    sources = {source: place for place, source in enumerate(dict.fromkeys(check.source for check in checks), 1)}
    body = "".join(_check(check, sources) for check in sorted(checks, key=lambda check: check.passed))
    head = "".join(f"<th>{word}</th>" for word in ("", "rule", "worst", "limit", "at", "in"))
    table = f'<table class="th gate"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
    listed = "<br>".join(f"{place} {escape(source)}" for source, place in sources.items())
    sourced = f'<div class="th-soft">{listed}</div>' if listed else ""
    return f"<details><summary>{summary}, {kept} in {verdict.scenarios} scenarios</summary>{table}{sourced}</details>"


def _check(check: Check, sources: dict[str, int]) -> str:
    unit = "" if check.unit == "1" else f" {check.unit}"
    kind = "" if check.passed else "bad" if check.severity == "hard" else "amber"
    cells = (
        {"": "ok", "bad": "RED", "amber": "amber"}[kind],
        check.quantity,
        f"{signed(check.value, '.4g')}{unit}",
        f"{'≤' if check.upper else '≥'} {signed(check.limit, '.4g')}{unit} {check.severity}",
        f"{check.time_s:.2f} s",
    )
    where = f'<td title="{escape(check.scenario)}">{escape(short_scenario(check.scenario))}</td>'
    marked = [escape(cell) for cell in cells]
    marked[3] += f'<sup title="{escape(check.source)}"> {sources[check.source]}</sup>'
    return f'<tr class="{kind}">' + "".join(f"<td>{cell}</td>" for cell in marked) + where + "</tr>"


def written_html(ready: Ready, written: Written) -> str:
    """Which files were written, which older ones had to go, and how the drives are played."""
    drives = len(ready.prepared)
    head = f"wrote {drives} {'drive' if drives == 1 else 'drives'} with sidecars into {written.folder.resolve()}"
    names = "".join(f"<li>{escape(name)}</li>" for name in written.names)
    names += "".join(f"<li>removed, its sidecar describes another drive: {escape(name)}</li>" for name in written.gone)
    played = f"to play: {escape(ready.form.how)}"
    return (
        f'<div class="th-good">{escape(head)}</div><ul class="th th-code">{names}</ul>'
        f'<div class="th-soft">{played}<br>{escape(CAUTION)}</div>'
    )
