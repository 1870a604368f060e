"""Verdicts in words.

Nothing is decided here, and records load this module when somebody reads them: it knows them by their types only.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from typing import TYPE_CHECKING, Any

from thermicon.base.files.inputs import shipped_table
from thermicon.base.words.number_text import signed, significant, unit_text

from ..rig.uncertainty import WORDS
from .spans import ENDING_S, PRACTICAL_S

if TYPE_CHECKING:
    from .checks import Check, Cure, Scenario
    from .demands import Harm, SingleFault
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

BEFORE = {
    "cycle": "repeated plays with {pause}",
    "warm": "repeated plays with {pause} (warm bound)",
    "cold": "repeated plays with {pause} (cold bound)",
    "once": "second play after {pause}",
    "another": "after another play and {pause}",
    "others": "after repeated plays of another and {pause}",
    "any": "",
}

NO_LIMIT = "no limit is passed"
MOST_TOLD = 1000.0
"""Of a harm: a dose doubles with every half kelvin, and its figures mean nothing beyond this."""


def corner_text(deviations: tuple[float, ...]) -> str:
    """Deviations of a rig, in the order of WORDS, as in contact −30 %, gain +10 %."""
    parts = zip(deviations, WORDS.values(), strict=True)
    moved = [f"{name} {signed(scale * value, '+g')} {unit}" for value, (_, name, scale, unit) in parts if value]
    return ", ".join(moved) or "the rig as given"


def scenario_text(run: Scenario) -> str:
    """A scenario: the corner, the way in which it is played, what was played before, and what follows."""
    corner, before, told = run.corner if isinstance(run.corner, str) else corner_text(run.corner), run.before, ""
    if before is not None:
        told = BEFORE[before.plays].format(pause=f"{before.pause_s:.4g} s of pause")
    return ", ".join(part for part in (corner, run.way, told, run.ending and f"then {run.ending}") if part)


def figures(check: Check) -> tuple[str, str]:
    """Value and limit as people read them: in four digits, or in as many as show that the limit is exceeded."""
    value, limit = f"{check.value:.4g}", f"{check.limit:.4g}"
    if not check.passed:
        value, limit = significant(check.value, check.limit, least=4)
    return value.replace("-", "−"), limit.replace("-", "−")


def check_text(check: Check) -> str:
    """A check in one sentence."""
    scenario = check.scenario
    where = f", with {scenario}" if scenario else ""
    value, limit = (f"{figure}{unit_text(check.unit)}" for figure in figures(check))
    at = "" if isnan(check.time_s) else f" at {check.time_s:.2f} s"
    reached = f"{check.quantity} reaches {value}{at}{where}"
    of_limit = f"{'above' if check.upper else 'below'} the {check.severity} limit of {limit}{check.note}"
    if check.since_s is None:
        return f"{reached}, not {of_limit} ({check.source})"
    since = "" if isnan(check.since_s) else f" from {check.since_s:.2f} s on"
    return f"{reached}, {of_limit}{since} ({check.source})"


def more_and_cure(hard: Sequence[Check], cures: Sequence[Cure]) -> str:
    """The end of a refusal's text: every exceeded hard limit but the first, and what would cure all of them."""
    others = []
    for check in hard[1:]:
        value, limit = figures(check)
        others.append(f"{check.quantity} {value}{unit_text(check.unit)} (limit {limit})")
    more = f"; also beyond hard limits: {', '.join(others)}" if others else ""
    return f"{more}; use {', '.join(CURES[cure] for cure in cures)}" if cures else more


def repeated_reason(repeated: Repeated, reason: str | None) -> str | None:
    """The first hard limit that repetition passes, its `reason`, with its cure; None where there is none."""
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
    return f"{reason}; the shortest safe pause is {shortest:g} s"


FAULT_WORDS = "fault-words.toml"
"""The name of each kind of fault, its effect, and what prevents its harm."""


def fault_table(fault: SingleFault) -> dict[str, object]:
    """A single fault as a sidecar holds it: what fails, the verdict, what it does, and what prevents harm."""
    words = shipped_table(FAULT_WORDS)[fault.kind]
    told, cure, why = _prevented(fault)
    text = words["does"].format(**told)
    return {"fault": words["name"], "colour": fault.colour, "text": text, "prevented_by": f"{cure}{why}"}


def fault_cure(fault: SingleFault) -> str:
    """The prevention of a single fault's harm, without the reason."""
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
    if fault.kind in {"stuck fast", "swapped fast"}:
        told["limits"] = " … ".join(signed(end_A, "g") for end_A in told["limit_A"])
    if (cut := told.get("cut_off")) is not None:
        told |= {"react_s": cut.react_within_s, "ends": f"{cut.low:g} and {cut.high:g} °C"}
    if (check := told.get("check")) is not None:
        span, told["test_A"] = check.swapped_skin_C, signed(check.test_current_A, ".3g")
    if span is not None:
        told["low"], told["high"] = (signed(level, ".1f") for level in span)
    ways = shipped_table(FAULT_WORDS)[fault.kind]["prevented"]
    cure, why = next((cure, why) for key, cure, why in ways if not key or told[key])
    return told, cure.format(**told), why.format(**told)


def _harm(harm: Harm) -> str:
    reached = "more than 1000" if harm.value > MOST_TOLD else signed(harm.value, ".1f")
    return f"{harm.quantity} reaches {reached} {harm.unit}"
