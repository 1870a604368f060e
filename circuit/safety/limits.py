"""Limits of safety: simulated temperatures, not commanded ones, checked against sourced limits.

This is not a medical or ethical clearance, and a hardware cut-off is required.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..rig.load import LOAD_SITES, without_skin
from ..rig.rigfile import RigError
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
    """Check a trace against the limits of its rig.

    Parameters
    ----------
    trace
        One run; without limits of its own it is checked against the shipped ones.

    Returns
    -------
    SafetyVerdict
        Colour, and the worst value of every rule.

    Raises
    ------
    RigError
        For a trace of a rig with a load in place of skin.

    Notes
    -----
    This is one run of the rig as given. `gate` also covers uncertainty, endings, repetition and single faults.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> judge_safety(simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"))).colour
    'green'
    """
    if trace.site in LOAD_SITES:
        raise RigError(f"rig {trace.rig_name}: {without_skin(trace.site, 'safety for people')}")
    columns = {name: getattr(trace, name)[np.newaxis] for name in WATCHED}
    if not trace.has_current:  # a thermode has no hot plate; its display stands in, so that no rule is lost
        columns["hot_plate_C"] = columns["display_C"]
    return SafetyVerdict(checks_of(trace.limits or Limits.shipped(), trace.time_s, columns))


def checks_of(limits: Limits, time_s: Array, columns: Mapping[str, Array]) -> tuple[Check, ...]:
    """Check a run (1, rows) of the WATCHED columns against every rule."""
    tally = Tally(limits, ("",))
    tally.add(time_s, np.stack([columns[name] for name in WATCHED]))
    return tally.checks()
