"""The verdict on one run.

This is not a medical or ethical clearance, and a hardware cut-off is required.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import isnan
from typing import Any

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.rules import Limits
from ..solver.trace import Trace
from .checks import Check, Judged
from .tally import WATCHED, Tally


@dataclass(frozen=True, slots=True)
class SafetyVerdict(Judged):
    """A trace against every rule: `findings` are the limits that it exceeds."""

    checks: tuple[Check, ...]

    def __repr__(self) -> str:
        exceeded = ", ".join(f"{check.quantity} {check.figures[0]} {check.unit}" for check in self.findings)
        return f"SafetyVerdict({self.colour}{f': {exceeded}' if exceeded else ''})"

    def to_dict(self) -> dict[str, object]:
        """Colour and findings in the form of a sidecar."""
        return {"colour": self.colour, "findings": [each.to_dict() for each in self.findings]}


def judge_safety(trace: Trace) -> SafetyVerdict:
    """Check a trace against the limits of its rig, or the shipped ones.

    This is one run of the rig as given. `gate` also covers uncertainty, endings, repetition and single faults.

    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> judge_safety(simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"))).colour
    'green'
    """
    columns = {name: getattr(trace, name)[np.newaxis] for name in WATCHED}
    if not trace.has_current:  # a thermode has no hot plate; its display stands in, so that no rule is lost
        columns["hot_plate_C"] = columns["display_C"]
    return SafetyVerdict(checks_of(trace.limits or Limits.shipped(), trace.time_s, columns))


def checks_of(limits: Limits, time_s: Array, columns: Mapping[str, Array]) -> tuple[Check, ...]:
    """Check a run (1, rows) of the WATCHED columns against every rule."""
    tally = Tally(limits, ("",))
    tally.add(time_s, np.stack([columns[name] for name in WATCHED]))
    return tally.checks()


HELD = ("skin", "display")
"""Controls whose current is held from row to row; others are taken as linear between rows."""


@dataclass(frozen=True, slots=True)
class Summary:
    """One trace; units are in the names, times count from its start, heat flow is positive into the skin.

    `reached` and the misses are None for a run without a target temperature; the miss is signed (above: positive).
    Current, voltage, energy and hot plate are None for a run on a thermode, which has none.
    `energy_J` is what the driver puts into the module, ∫V·I dt. `reason` says why it was missed or is not safe.
    """

    duration_s: float
    reached: bool | None
    largest_miss_K: float | None
    largest_miss_s: float | None
    rms_miss_K: float | None
    current_min_A: float | None
    current_max_A: float | None
    voltage_min_V: float | None
    voltage_max_V: float | None
    energy_J: float | None
    hot_plate_min_C: float | None
    hot_plate_max_C: float | None
    display_min_C: float
    display_max_C: float
    skin_min_C: float
    skin_max_C: float
    cold_receptor_min_C: float
    cold_receptor_max_C: float
    warm_receptor_min_C: float
    warm_receptor_max_C: float
    heat_flow_skin_min_W_per_m2: float
    heat_flow_skin_max_W_per_m2: float
    heat_flow_cold_receptor_min_W_per_m2: float
    heat_flow_cold_receptor_max_W_per_m2: float
    heat_flow_warm_receptor_min_W_per_m2: float
    heat_flow_warm_receptor_max_W_per_m2: float
    safe: bool
    safety: str
    reason: str | None

    def __repr__(self) -> str:
        target = {None: "", True: "reached, ", False: "NOT reached, "}[self.reached]
        drive = "a thermode"
        if self.energy_J is not None:
            drive = f"{self.current_min_A:.2f} … {self.current_max_A:.2f} A, {self.energy_J:.1f} J"
        return (
            f"Summary({target}{self.duration_s:g} s, skin {self.skin_min_C:.2f} … {self.skin_max_C:.2f} °C, {drive}, "
            f"safety {self.safety})"
        )

    def to_dict(self) -> dict[str, float | bool | str | None]:
        """Return the numbers by name, in the order of the fields."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def summarise(trace: Trace) -> Summary:
    """The numbers of a trace by which rigs and icons are compared: misses, extremes, energy and the safety of this run.

    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> summarise(simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar")))
    Summary(reached, 8 s, skin 26.92 … 32.04 °C, -0.48 … 1.11 A, 16.3 J, safety green)
    """
    outcome, verdict = trace.outcome, judge_safety(trace)
    reasons = [reason for reason in (None if outcome is None else outcome.reason, verdict.reason) if reason]
    misses = ("reached", "largest_miss_K", "largest_miss_s", "rms_miss_K")
    extremes: dict[str, Any] = {name: outcome and getattr(outcome, name) for name in misses}
    for field in fields(Summary):
        for side, extreme in (("_min_", np.min), ("_max_", np.max)):
            if side in field.name:
                value = float(extreme(getattr(trace, field.name.replace(side, "_"))))
                extremes[field.name] = None if isnan(value) else value
    return Summary(
        duration_s=float(trace.time_s[-1]),
        energy_J=energy_J(trace) if trace.has_current else None,
        safe=verdict.safe,
        safety=verdict.colour,
        reason="; ".join(reasons) or None,
        **extremes,
    )


def energy_J(trace: Trace) -> float:
    """Electrical energy into the module in J: a held current's power counts until the next row, others linearly."""
    power, steps = trace.voltage_V * trace.current_A, np.diff(trace.time_s)
    mean = power[:-1] if trace.control in HELD else 0.5 * (power[:-1] + power[1:])
    return float(mean @ steps)
