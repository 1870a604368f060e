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
    """One limit that a trace passes: which, how far it got, when, and who set it."""

    quantity: str
    severity: str
    value: float
    limit: float
    unit: str
    time_s: float
    source: str

    def __str__(self) -> str:
        side = "above" if self.value > self.limit else "below"
        return (
            f"{self.quantity} reaches {self.value:.4g} {self.unit} at {self.time_s:.2f} s, {side} the {self.severity} "
            f"limit of {self.limit:g} {self.unit} ({self.source})"
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
        values = columns[record.quantity]
        severity = str(record.get("severity"))
        low, high = record.low, record.high
        if record.quantity.startswith("rate"):
            low = None if high is None else -high
        ends = [("above", high), ("below", low)]
        if record.quantity == "skin surface" and severity == "soft":
            start = float(trace.skin_C[0])
            ends += [("above", start + FAR_FROM_BASELINE_K), ("below", start - FAR_FROM_BASELINE_K)]
        for side, limit in ends:
            if limit is None:
                continue
            over = values - limit if side == "above" else limit - values
            if over.max() > 0:
                at = int(np.argmax(over))
                when = float(trace.time_s[int(np.argmax(over > 0))])
                found.append(
                    Finding(record.quantity, severity, float(values[at]), limit, record.unit, when, record.source)
                )
    return SafetyVerdict(tuple(found))
