"""Limits of safety: simulated temperatures held against sourced limits, from the skin and not from the command.

This is no medical or ethical clearance, and a hardware cut-off is required.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from thermicon.circuit.inputs import signed
from thermicon.circuit.rig.rules import Limits, Rule
from thermicon.circuit.rig.skin import Array
from thermicon.circuit.safety.exposure import cem43_min, henriques
from thermicon.circuit.solver.trace import Trace

WATCHED = ("skin_C", "display_C", "cold_receptor_C", "hot_plate_C")
"""Columns of a run that limits are about."""

LEVEL = 1e-6
"""What is as near as this to the extreme, in its unit, has reached it: a level that is held has no latest row."""

COLDEST_C, HOTTEST_C = -273.15, 1000.0
"""What runs away counts as this hot, so that it fails every limit and is not lost as NaN."""


@dataclass(frozen=True, slots=True)
class Check:
    """One rule held against one run or many: how near it gets or how far beyond, when and where, and who set the limit.

    `value` is the extreme on the side that the rule limits, first reached at `time_s`; `since_s` is when the limit is
    first passed, None where it never is. `scenario` tells in which of many runs.
    """

    quantity: str
    severity: str
    value: float
    limit: float
    unit: str
    time_s: float
    since_s: float | None
    source: str
    note: str = ""
    upper: bool = True
    scenario: str = ""

    @property
    def passed(self) -> bool:
        """Whether the run stays within the limit."""
        return self.since_s is None

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        where = f", with {self.scenario}" if self.scenario else ""
        reached = f"{self.quantity} reaches {signed(self.value, '.4g')}{unit} at {self.time_s:.2f} s{where}"
        side, limit = "above" if self.upper else "below", f"{signed(self.limit, '.4g')}{unit}"
        if self.since_s is None:
            return f"{reached}, not {side} the {self.severity} limit of {limit}{self.note} ({self.source})"
        return (
            f"{reached}, {side} the {self.severity} limit of {limit}{self.note} "
            f"from {self.since_s:.2f} s on ({self.source})"
        )


@dataclass(frozen=True, slots=True)
class SafetyVerdict:
    """All limits that a trace passes; `colour` is green, amber (soft limits only) or red."""

    findings: tuple[Check, ...]

    @property
    def colour(self) -> str:
        """Green, amber or red."""
        return colour_of(self.findings)

    @property
    def safe(self) -> bool:
        """Whether no hard limit is passed."""
        return self.colour != "red"

    @property
    def reason(self) -> str | None:
        """The first hard limit passed, in one sentence; None where there is none."""
        return next((str(finding) for finding in self.findings if finding.severity == "hard"), None)

    @property
    def cautions(self) -> tuple[str, ...]:
        """A sentence for each soft limit passed."""
        return tuple(str(finding) for finding in self.findings if finding.severity != "hard")

    def to_dict(self) -> dict[str, object]:
        """Colour and findings, as a sidecar holds them."""
        return {"colour": self.colour, "findings": [as_dict(each) for each in self.findings]}


def judge_safety(trace: Trace) -> SafetyVerdict:
    """Hold a trace against the limits of its rig, the shipped ones where it has none of its own.

    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> judge_safety(simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"))).colour
    'green'
    """
    columns = {name: getattr(trace, name)[np.newaxis] for name in WATCHED}
    if not trace.has_current:  # a thermode has no hot plate; its display stands in, so that no rule is lost
        columns["hot_plate_C"] = columns["display_C"]
    return SafetyVerdict(findings_of(checks_of(trace.limits or Limits.shipped(), trace.time_s, columns)))


def checks_of(
    limits: Limits, time_s: Array, columns: Mapping[str, Array], scenarios: Sequence[str] = ("",)
) -> tuple[Check, ...]:
    """Hold runs (lanes, rows) of the WATCHED columns against every rule: for each, the lane that goes farthest."""
    columns = {name: _finite(columns[name]) for name in WATCHED}
    measured: dict[str, Array] = {}
    extremes: dict[tuple[str, bool], Array] = {}
    found = []
    for rule in limits.rules:
        if rule.quantity not in measured:
            measured[rule.quantity] = _measured(rule, time_s, columns)
        values, which = measured[rule.quantity], (rule.quantity, rule.upper)
        if which not in extremes:
            extremes[which] = values.max(axis=1) if rule.upper else values.min(axis=1)
        found.append(_held(rule, time_s, values, extremes[which], scenarios))
    return tuple(found)


def findings_of(checks: Sequence[Check]) -> tuple[Check, ...]:
    """Of the rules that are passed, one for each quantity and side, the hard ones first.

    What passes a hard limit has passed the soft one.
    """
    worst: dict[tuple[str, bool], Check] = {}
    broken = [check for check in checks if not check.passed]
    for check in sorted(broken, key=lambda one: (one.severity != "hard", one.since_s)):
        worst.setdefault((check.quantity, check.upper), check)
    return tuple(worst.values())


def colour_of(findings: Sequence[Check]) -> str:
    """Green without findings, red with a hard one, otherwise amber."""
    if any(finding.severity == "hard" for finding in findings):
        return "red"
    return "amber" if findings else "green"


def as_dict(check: Check) -> dict[str, object]:
    """A check as a sidecar holds it."""
    return {**asdict(check), "passed": check.passed, "text": str(check)}


def _finite(values: Array) -> Array:
    known = np.nan_to_num(values, nan=HOTTEST_C, posinf=HOTTEST_C, neginf=COLDEST_C)
    return np.clip(known, COLDEST_C, HOTTEST_C)


_COLUMN_OF = {
    "display": "display_C",
    "hot plate": "hot_plate_C",
    "cold-receptor depth": "cold_receptor_C",
}
"""Where a temperature limit is not about the skin surface."""


def _measured(rule: Rule, time_s: Array, columns: Mapping[str, Array]) -> Array:
    """The quantity (lanes, rows) that a rule limits."""
    skin = columns["skin_C"]
    if rule.above_C is not None:
        warm = columns["display_C"]
        if warm.max() <= rule.above_C:
            return np.zeros_like(warm)
        over = 0.5 * (warm[:, 1:] + warm[:, :-1]) > rule.above_C
        return np.concatenate([np.zeros((len(warm), 1)), np.cumsum(over * np.diff(time_s), axis=1)], axis=1)
    if rule.quantity == "rate of skin temperature":
        rates = np.diff(skin, axis=1) / np.diff(time_s)
        return np.concatenate([rates[:, :1], rates], axis=1)
    if rule.quantity == "thermal dose":
        return cem43_min(time_s, skin)
    if rule.quantity == "Henriques integral":
        return henriques(time_s, skin)
    return columns[_COLUMN_OF.get(rule.quantity, "skin_C")]


def _held(rule: Rule, time_s: Array, values: Array, reached: Array, scenarios: Sequence[str]) -> Check:
    """One rule against a quantity (lanes, rows) and its extremes (lanes,) on the side that the rule limits."""
    side = 1.0 if rule.upper else -1.0
    limits = values[:, 0] + rule.limit if rule.relative else np.full(len(values), rule.limit)
    lane = int(np.argmax(side * (reached - limits)))
    most, limit, there = float(reached[lane]), float(limits[lane]), values[lane]
    first = int(np.argmax(there >= most - LEVEL if rule.upper else there <= most + LEVEL))
    since = None
    if side * (most - limit) > 0:
        since = float(time_s[int(np.argmax(there > limit if rule.upper else there < limit))])
    return Check(
        rule.quantity,
        rule.severity,
        most,
        limit,
        "°C" if rule.relative else rule.unit,
        float(time_s[first]),
        since,
        rule.source,
        f", {abs(rule.limit):g} K from where it began," if rule.relative else "",
        rule.upper,
        scenarios[lane],
    )
