"""Verdicts in words: scenarios, checks, cures, single faults, repetition and the table of a gate, from their records.

Nothing is decided here and nothing that decides imports this module: it is loaded when somebody reads.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import signed, significant

from ..rig.uncertainty import WORDS, stated, tightened
from .checks import Before, Check, Cure, Scenario, cures_of, hard_of
from .plant import ENDING_S, RECOVERED_K
from .repeated import PRACTICAL_S

if TYPE_CHECKING:
    from .checks import Harm, SingleFault
    from .gate import Gate
    from .repeated import Repeated

WHAT_IT_IS_NOT = (
    "This is a calculation, not a medical or ethical clearance. Hardware that touches people needs a temperature "
    "cut-off of its own that works without any software."
)

CURES: dict[Cure, str] = {
    "baseline": "a baseline nearer to resting skin, since it is beyond the limit from the start",
    "slower": "a slower change",
    "less current": "less current or a better heat sink",
    "shorter": "a shorter hold",
    "smaller": "a smaller or shorter change",
}

REPEATED = {"cycle": "", "warm": " (warm bound)", "cold": " (cold bound)"}
BEFORE = {
    "once": "second play after {pause}",
    "another": "after another play and {pause}",
    "others": "after repeated plays of another and {pause}",
    "any": "",
}

NO_LIMIT = "no limit is passed"


@lru_cache(maxsize=4096)
def corner_text(deviations: tuple[float, ...]) -> str:
    """Deviations of a rig, in the order of WORDS, as in contact −30 %, gain +10 %."""
    parts = zip(deviations, WORDS.values(), strict=True)
    moved = [f"{name} {signed(scale * value, '+g')} {unit}" for value, (_, name, scale, unit) in parts if value]
    return ", ".join(moved) or "the rig as given"


def scenario_text(run: Scenario, short: bool = False) -> str:
    """A scenario: the corner, the way in which it is played, what was played before, and what follows.

    `short` leaves the pause of repeated plays out.
    """
    corner = run.corner if isinstance(run.corner, str) else corner_text(run.corner)
    before = "" if run.before is None else _before(run.before, short)
    return ", ".join(part for part in (corner, run.way, before, run.ending and f"then {run.ending}") if part)


def _before(before: Before, short: bool) -> str:
    pause = f"{before.pause_s:.4g} s of pause"
    if before.plays in REPEATED:
        return f"repeated{'' if short else f' plays with {pause}'}{REPEATED[before.plays]}"
    return BEFORE[before.plays].format(pause=pause)


def figures(check: Check) -> tuple[str, str]:
    """Value and limit as people read them: in four digits, or in as many as show that the limit is exceeded."""
    value, limit = f"{check.value:.4g}", f"{check.limit:.4g}"
    if not check.passed:
        value, limit = significant(check.value, check.limit, least=4)
    return value.replace("-", "−"), limit.replace("-", "−")


def note_text(check: Check) -> str:
    """From where a relative limit counts; empty for one that is absolute."""
    return "" if check.from_start_K is None else f", {check.from_start_K:g} K from where it began,"


def check_text(check: Check) -> str:
    """A check in one sentence."""
    scenario = check.scenario
    where = f", with {scenario}" if scenario else ""
    value, limit = (f"{figure}{_unit(check)}" for figure in figures(check))
    reached = f"{check.quantity} reaches {value} at {check.time_s:.2f} s{where}"
    of_limit = f"{'above' if check.upper else 'below'} the {check.severity} limit of {limit}{note_text(check)}"
    if check.since_s is None:
        return f"{reached}, not {of_limit} ({check.source})"
    return f"{reached}, {of_limit} from {check.since_s:.2f} s on ({check.source})"


def hard_reason(findings: Sequence[Check]) -> str | None:
    """The first hard finding in one sentence; None where there is none."""
    return next(map(str, hard_of(findings)), None)


def more_and_cure(findings: Sequence[Check]) -> str:
    """What follows the reason of a refusal: every other hard limit exceeded, and what would cure all of them."""
    others = [
        f"{check.quantity} {value}{_unit(check)} (limit {limit})"
        for check in hard_of(findings)[1:]
        for value, limit in (figures(check),)
    ]
    more = f"; also beyond hard limits: {', '.join(others)}" if others else ""
    cures = [CURES[cure] for cure in cures_of(findings)]
    return f"{more}; use {', '.join(cures)}" if cures else more


def repeated_reason(repeated: Repeated) -> str | None:
    """The first hard limit that repetition passes, in one sentence with its cure; None where there is none."""
    reason = hard_reason(repeated.findings)
    if reason is None and repeated.too_soon:
        reason = (
            f"with {repeated.pause_s:g} s between plays a host that hangs or a driver stuck at its limit passes a hard "
            f"limit before a watchdog or a cut-off of {PRACTICAL_S:g} s acts"
        )
    if reason is None:
        return None
    shortest = repeated.shortest_pause_s
    if shortest is None:
        return f"{reason}; no pause up to 10 min makes that safe: use a smaller or shorter change"
    return f"{reason}; the shortest safe pause is {shortest:g} s (--pause {shortest:g})"


def repeated_text(repeated: Repeated) -> str:
    """Pause, plays, recovery and verdict in one line."""
    back = "later than 10 min" if repeated.recovery_s is None else f"{repeated.recovery_s:g} s"
    shortest = "none" if repeated.shortest_pause_s is None else f"{repeated.shortest_pause_s:g} s"
    return (
        f"{repeated.colour}, {repeated.plays} plays in {repeated.session_s / 60:g} min with {repeated.pause_s:g} s "
        f"between them (back within {RECOVERED_K:g} K of rest: {back}; shortest safe pause: {shortest})"
    )


def gate_lines(verdict: Gate) -> Iterator[str]:
    """The verdict as a table: every rule with its worst value, the limit, time, scenario and source."""
    unsure = verdict.uncertainty
    yield (
        f"safety {verdict.colour.upper()}: {verdict.duration_s:.4g} s on {verdict.rig_name} and {ENDING_S:g} s after, "
        f"in {verdict.scenarios} scenarios ({stated(unsure)}; {', '.join(verdict.after_C)})"
    )
    yield f"repeated plays: {repeated_text(verdict.repeated)}"
    table = [("", "rule", "worst", "limit", "at", "in", "source"), *(_row(verdict, check) for check in verdict.checks)]
    widths = [max(len(row[column]) for row in table) for column in range(len(table[0]) - 1)]
    for row in table:
        yield "  ".join([*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[-1]]).rstrip()
    after = ", ".join(f"{value:.1f} °C ({ending})" for ending, value in verdict.after_C.items())
    yield f"skin {ENDING_S:g} s after the last sample, on the rig as given: {after}"
    if verdict.drift_C is not None:
        yield f"zero current is not the baseline: in the end it takes the skin to {verdict.drift_C:.1f} °C"
    if verdict.limits.changed:
        yield f"limits changed by the rig: {'; '.join(verdict.limits.changed)}"
    if verdict.limits.loosened:
        yield f"limits LOOSENED: {'; '.join(verdict.limits.loosened)}. Reason given: {verdict.limits.reason}"
    if claims := tightened(unsure):
        yield f"uncertainty SMALLER than shipped: {'; '.join(claims)}. Reason given: {unsure.reason}"
    for fault in verdict.demands.faults:
        told = fault_table(fault)
        yield f"single fault, {told['fault']}: {told['text']}; prevented by {told['prevented_by']}"
    yield WHAT_IT_IS_NOT


def _row(verdict: Gate, check: Check) -> tuple[str, ...]:
    mark = "ok" if check.passed else ("RED" if check.severity == "hard" else "amber")
    late = check.time_s - verdict.duration_s
    when = f"{check.time_s:.2f} s" + (f" ({late:.1f} s after)" if late > 0 else "")
    value, limit = (f"{figure}{_unit(check)}" for figure in figures(check))
    of_limit = f"{'≤' if check.upper else '≥'} {limit} {check.severity}"
    return mark, check.quantity, value, of_limit, when, check.scenario, check.source


def _unit(check: Check) -> str:
    return "" if check.unit == "1" else f" {check.unit}"


FAULTS: dict[str, tuple[str, str, tuple[tuple[str, str, str], ...]]] = {
    "hang": ("host hangs in mid-play", "the current hangs for {lasts_s:.2g} s: {harm}", (
        ("watchdog_s", "a watchdog that cuts the current after {watchdog_s:g} s without a message from the host", ""),
        ("", "a cut-off on the measured temperature", "; no watchdog is quick enough"),
    )),
    "stuck": ("driver stuck at its limit", "{harms}", (
        ("react_s", "a cut-off at {ends} on the measured display, within {react_s:g} s", ""),
        ("limit_A", "a current limit of {limit_A:.2g} A in the driver's hardware",
         "; no cut-off is quick enough at {most_A:g} A"),
        ("", "a smaller or shorter drive",
         ": no cut-off is quick enough, and no current limit that still plays this one is low enough"),
    )),
    "unpowered": ("first play on a display that was without power", "{found}", (
        ("rest_s", "holding the rest for {rest_s:g} s before the first play, without contact or with", ""),
        ("at_once", "nothing need be", ""),
        ("", "no rest up to 10 min", "; bring the display to its baseline before it touches the skin"),
    )),
    "swapped": ("poles swapped", "skin {low} … {high} °C", (
        ("", "{test_A} A for {check.test_s:g} s before the first play",
         ": the display must cool by {check.display_change_at_least_K:g} K or more"),
    )),
    "set-point hang": ("set-point hangs in mid-play", "display held at {levels} for {ending_s:g} s", (
        ("", "a return to the baseline {watchdog_s:g} s after the last message from the host", ""),
    )),
    "loop stuck": (
        "loop stuck at the end of its range", "display at {levels}; a hard limit is passed after {passed_s:.2g} s", (
            ("react_s", "the device's own cut-off at {ends}, within {react_s:g} s", ""),
            ("", "the protection of the device's maker, which must keep the display within {cut_off.low:g} … "
             "{cut_off.high:g} °C", "; no cut-off that acts afterwards is quick enough"),
        ),
    ),
    "unpowered loop": (
        "first play on a display that was without power", "the display is between {low} and {high} °C", (
            ("", "holding the baseline for {rest} before the first play", ""),
        ),
    ),
    "loop lost": ("sensor lost or poles swapped: the loop runs to the driver's limit", "{harms}", (
        ("", "a cut-off at {ends} on a second sensor of its own, within {react_s:g} s", ""),
    )),
}  # fmt: skip
"""What fails, what it does, and what prevents harm, with the reason: the first whose value is there and not 0."""


def fault_table(fault: SingleFault) -> dict[str, object]:
    """A single fault as a sidecar holds it: what fails, the verdict, what it does, and what prevents harm."""
    name, text, _ = FAULTS[fault.kind]
    told, cure, why = _prevented(fault)
    prevented = f"{cure}{why}"
    return {"fault": name, "colour": fault.colour, "text": text.format(**told), "prevented_by": prevented}


def fault_cure(fault: SingleFault) -> str:
    """What prevents the harm of a single fault, without the reason."""
    return _prevented(fault)[1]


def _prevented(fault: SingleFault) -> tuple[dict[str, Any], str, str]:
    """The values of a fault as its words need them, what prevents its harm, and why nothing else does."""
    told: dict[str, Any] = {**fault.values, "ending_s": ENDING_S}
    span, rest_s = told.get("display_C"), told.get("rest_s")
    told["rest"] = "10 min or more" if rest_s is None else f"{rest_s:g} s"
    told["at_once"], told["found"] = rest_s == 0.0, NO_LIMIT if told.get("finding") is None else str(told["finding"])
    told["harm"] = NO_LIMIT if told.get("harm") is None else _harm(told["harm"])
    harms = [f"{_harm(harm)} at {signed(amperes, '.3g')} A" for harm, amperes in told.get("harms", ())]
    told["harms"] = " and ".join(harms) or NO_LIMIT
    told["levels"] = " or ".join(f"{signed(level, '.1f')} °C" for level in told.get("levels_C", ()))
    if (cut := told.get("cut_off")) is not None:
        told |= {"react_s": cut.react_within_s, "ends": f"{cut.low:g} and {cut.high:g} °C"}
    if (check := told.get("check")) is not None:
        span, told["test_A"] = check.swapped_skin_C, signed(check.test_current_A, ".3g")
    if span is not None:
        told["low"], told["high"] = (signed(level, ".1f") for level in span)
    cure, why = next((cure, why) for key, cure, why in FAULTS[fault.kind][2] if not key or told[key])
    return told, cure.format(**told), why.format(**told)


def _harm(harm: Harm) -> str:
    return f"{harm.quantity} reaches {signed(harm.value_C, '.1f')} °C"
