"""Verdicts in words: scenarios, checks, cures, single faults, repetition and the table of a gate, from their records.

Nothing is decided here and nothing that decides imports this module: it is loaded when somebody reads.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

from thermicon.icons.number_text import signed, significant

from ..rig.uncertainty import WORDS, stated, tightened
from .checks import Before, Check, Cure, Scenario, cures_of, hard_of
from .plant import ENDING_S, RECOVERED_K
from .repeated import PRACTICAL_S

if TYPE_CHECKING:
    from .checks import CutOff, Harm, PolarityCheck, SingleFault
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

Told = tuple[str, str, str]
"""What a single fault does, what prevents harm, and why nothing else does, with its mark before it."""


@lru_cache(maxsize=4096)
def corner_text(deviations: tuple[float, ...]) -> str:
    """Deviations of a rig, in the order of WORDS.

    >>> corner_text((-0.3, 0, 0.1, 0, 0, 0, 0)), corner_text((0,) * 7)
    ('contact −30 %, gain +10 %', 'the rig as given')
    """
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
    """What follows the reason of a refusal: every other hard limit that is exceeded, and what would cure all of them.

    >>> more_and_cure([])
    ''
    """
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


def fault_table(fault: SingleFault) -> dict[str, object]:
    """A single fault as a sidecar holds it: what fails, the verdict, what it does, and what prevents harm."""
    name, tell = FAULTS[fault.kind]
    text, cure, why = tell(**fault.values)
    return {"fault": name, "colour": fault.colour, "text": text, "prevented_by": cure + why}


def fault_cure(fault: SingleFault) -> str:
    """What prevents the harm of a single fault, without the reason."""
    return FAULTS[fault.kind][1](**fault.values)[1]


def _hang(lasts_s: float, harm: Harm | None, watchdog_s: float) -> Told:
    text = f"the current hangs for {lasts_s:.2g} s: {_harm(harm)}"
    if watchdog_s == 0.0:
        return text, "a cut-off on the measured temperature", "; no watchdog is quick enough"
    return text, f"a watchdog that cuts the current after {watchdog_s:g} s without a message from the host", ""


def _stuck(harms: Sequence[tuple[Harm, float]], cut_off: CutOff, most_A: float, limit_A: float | None) -> Told:
    if cut_off.react_within_s:
        return _harms(harms), f"{_cut_off(cut_off)} on the measured display, within {cut_off.react_within_s:g} s", ""
    if limit_A is None:
        why = "no cut-off is quick enough, and no current limit that still plays this one is low enough"
        return _harms(harms), "a smaller or shorter drive", f": {why}"
    cure = f"a current limit of {limit_A:.2g} A in the driver's hardware"
    return _harms(harms), cure, f"; no cut-off is quick enough at {most_A:g} A"


def _unpowered(finding: Check | None, rest_s: float | None) -> Told:
    text = NO_LIMIT if finding is None else str(finding)
    if rest_s is None:
        return text, "no rest up to 10 min", "; bring the display to its baseline before it touches the skin"
    if not rest_s:
        return text, "nothing need be", ""
    return text, f"holding the rest for {rest_s:g} s before the first play, without contact or with", ""


def _swapped(check: PolarityCheck) -> Told:
    low, high = (signed(value, ".1f") for value in check.swapped_skin_C)
    test = f"{signed(check.test_current_A, '.3g')} A for {check.test_s:g} s before the first play"
    fall = f": the display must cool by {check.display_change_at_least_K:g} K or more"
    return f"skin {low} … {high} °C", test, fall


def _set_point_hang(levels_C: Sequence[float], watchdog_s: float) -> Told:
    text = f"display held at {_levels(levels_C)} for {ENDING_S:g} s"
    return text, f"a return to the baseline {watchdog_s:g} s after the last message from the host", ""


def _loop_stuck(levels_C: Sequence[float], passed_s: float, cut_off: CutOff) -> Told:
    text = f"display at {_levels(levels_C)}; a hard limit is passed after {passed_s:.2g} s"
    if cut_off.react_within_s:
        own = f"the device's own cut-off at {cut_off.low:g} and {cut_off.high:g} °C"
        return text, f"{own}, within {cut_off.react_within_s:g} s", ""
    within = f"which must keep the display within {cut_off.low:g} … {cut_off.high:g} °C"
    why = "; no cut-off that acts afterwards is quick enough"
    return text, f"the protection of the device's maker, {within}", why


def _unpowered_loop(display_C: tuple[float, float], rest_s: float | None) -> Told:
    low, high = (signed(level, ".1f") for level in display_C)
    duration = "10 min or more" if rest_s is None else f"{rest_s:g} s"
    text = f"the display is between {low} and {high} °C"
    return text, f"holding the baseline for {duration} before the first play", ""


def _loop_lost(harms: Sequence[tuple[Harm, float]], cut_off: CutOff) -> Told:
    second = f"{_cut_off(cut_off)} on a second sensor of its own, within {cut_off.react_within_s:g} s"
    return _harms(harms), second, ""


FAULTS: dict[str, tuple[str, Callable[..., Told]]] = {
    "hang": ("host hangs in mid-play", _hang),
    "stuck": ("driver stuck at its limit", _stuck),
    "unpowered": ("first play on a display that was without power", _unpowered),
    "swapped": ("poles swapped", _swapped),
    "set-point hang": ("set-point hangs in mid-play", _set_point_hang),
    "loop stuck": ("loop stuck at the end of its range", _loop_stuck),
    "unpowered loop": ("first play on a display that was without power", _unpowered_loop),
    "loop lost": ("sensor lost or poles swapped: the loop runs to the driver's limit", _loop_lost),
}
"""What fails, and how its values are told."""


def _harm(harm: Harm | None) -> str:
    return NO_LIMIT if harm is None else f"{harm.quantity} reaches {signed(harm.value_C, '.1f')} °C"


def _harms(harms: Sequence[tuple[Harm, float]]) -> str:
    return " and ".join(f"{_harm(harm)} at {signed(amperes, '.3g')} A" for harm, amperes in harms) or NO_LIMIT


def _cut_off(cut: CutOff) -> str:
    return f"a cut-off at {cut.low:g} and {cut.high:g} °C"


def _levels(levels_C: Sequence[float]) -> str:
    return " or ".join(f"{signed(level, '.1f')} °C" for level in levels_C)
