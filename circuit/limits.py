"""Limits of safety: a simulated trace held against sourced limits, from the skin and not from the command.

This is no medical or ethical clearance, and a hardware cut-off is required.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np

from thermicon.circuit.records import Table, load_records
from thermicon.circuit.skin import Array
from thermicon.circuit.trace import Trace

FAR_FROM_BASELINE_K = 8.0
"""The soft limit of the skin surface also counts its distance from where it began."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One limit that a trace passes: how far it gets and when, when it first passes, and who set the limit."""

    quantity: str
    severity: str
    value: float
    limit: float
    unit: str
    time_s: float
    since_s: float
    source: str
    note: str = ""

    def __str__(self) -> str:
        side = "above" if self.value > self.limit else "below"
        return (
            f"{self.quantity} reaches {self.value:.4g} {self.unit} at {self.time_s:.2f} s, {side} the {self.severity} "
            f"limit of {self.limit:.4g} {self.unit}{self.note} from {self.since_s:.2f} s on ({self.source})"
        )


@dataclass(frozen=True, slots=True)
class SafetyVerdict:
    """All limits that a trace passes; `colour` is green, amber (soft limits only) or red."""

    findings: tuple[Finding, ...]

    @property
    def colour(self) -> str:
        """Green, amber or red."""
        if not self.findings:
            return "green"
        return "red" if any(finding.severity == "hard" for finding in self.findings) else "amber"

    @property
    def safe(self) -> bool:
        """Whether no hard limit is passed."""
        return self.colour != "red"

    @property
    def reason(self) -> str | None:
        """The first hard limit passed, in one sentence; None where there is none."""
        return next((str(finding) for finding in self.findings if finding.severity == "hard"), None)


@cache
def limit_table() -> Table:
    """The shipped limits, each with its source."""
    return load_records(resources.files("thermicon.circuit") / "data" / "limits.toml", extra=("severity",))


def judge_safety(trace: Trace) -> SafetyVerdict:
    """Hold a trace against the shipped limits.

    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> judge_safety(simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"))).colour
    'green'
    """
    columns: dict[str, Array] = {
        "skin surface": trace.skin_C,
        "display": trace.display_C,
        "rate of skin temperature": np.gradient(trace.skin_C, trace.time_s),
        "cold-receptor depth": trace.cold_receptor_C,
        "hot plate": trace.hot_plate_C,
    }
    found: list[Finding] = []
    for record in limit_table():
        values, severity = columns[record.quantity], str(record.get("severity"))
        low, high = record.low, record.high
        if record.quantity.startswith("rate"):
            low = None if high is None else -high
        ends = [(1.0, high, ""), (-1.0, low, "")]
        if record.quantity == "skin surface" and severity == "soft":
            start, far = float(trace.skin_C[0]), FAR_FROM_BASELINE_K
            ends += [(side, start + side * far, f", {far:g} K from where it began,") for side in (1.0, -1.0)]
        for side, limit, note in ends:
            over = np.zeros(1) if limit is None else side * (values - limit)
            if limit is not None and over.max() > 0:
                most, since = int(np.argmax(over)), float(trace.time_s[int(np.argmax(over > 0))])
                found.append(
                    Finding(
                        record.quantity,
                        severity,
                        float(values[most]),
                        limit,
                        record.unit,
                        float(trace.time_s[most]),
                        since,
                        record.source,
                        note,
                    )
                )
    return SafetyVerdict(_worst_of_each(found))


def _worst_of_each(found: list[Finding]) -> tuple[Finding, ...]:
    """One finding for each quantity and side, the hard ones first: what passes a hard limit has passed the soft one."""
    worst: dict[tuple[str, bool], Finding] = {}
    for finding in sorted(found, key=lambda one: (one.severity != "hard", one.since_s)):
        worst.setdefault((finding.quantity, finding.value > finding.limit), finding)
    return tuple(worst.values())
