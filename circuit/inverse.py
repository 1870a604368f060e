"""From the temperature a cue asks for to the current that makes it, held over each driver period."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from thermicon.circuit.bank import Bank, Index, run_follow
from thermicon.circuit.drive import Drive
from thermicon.circuit.network import network_of
from thermicon.circuit.rig import Rig
from thermicon.circuit.skin import Array
from thermicon.circuit.steady import hold
from thermicon.circuit.trace import Outcome, judge
from thermicon.icons import Icon

LIMITS = ("", "current limit", "lower current limit", "compliance voltage", "current of greatest cooling")
"""What held a current back, by the code that the kernel writes."""


@dataclass(frozen=True, slots=True)
class Design:
    """The current designed for a cue on a rig; before it, `rest_A` has held the state `start_C` (°C) for ever."""

    drive: Drive
    rest_A: float
    start_C: Array
    outcome: Outcome | None


def periods(rig: Rig, end_s: float) -> Array:
    """Ends in s of the driver periods that cover a time."""
    count = max(1, math.ceil(end_s * rig.driver.update_Hz - 1e-9))
    return np.arange(1, count + 1) / rig.driver.update_Hz


def baseline_C(icon: Icon, rig: Rig) -> float:
    """Baseline of a cue in °C: its own, or the rig's rest."""
    return rig.skin.rest_C if icon.frame.baseline_C is None else icon.frame.baseline_C


def target_at(icon: Icon, start: float, times_s: Array) -> Array:
    """What the cue asks for at times in s: °C, or A under current control; the last level is kept."""
    corners = icon.lower(start)
    return np.asarray(np.interp(times_s, corners.time_s, corners.value), dtype=np.float64)


def design(icon: Icon, rig: Rig, end_s: float) -> Design:
    """Return the current that plays a cue on a rig until `end_s`; raises RigError for a baseline that cannot be held.

    Skin and display control give currents held over each driver period; current control gives the cue's own corners.
    """
    control = icon.frame.control
    current, state = hold(rig, "skin" if control == "skin" else "display", baseline_C(icon, rig))
    if control == "current":
        corners = icon.lower(current)
        times, values = list(corners.time_s), list(corners.value)
        if end_s > times[-1] + 1e-9:
            times.append(end_s)
            values.append(values[-1])
        return Design(Drive(times, values), current, state, None)
    ends = periods(rig, end_s)
    target = target_at(icon, baseline_C(icon, rig), ends)
    bank, one = Bank.of([network_of(rig)]), np.zeros(1, dtype=np.int64)
    period = 1.0 / rig.driver.update_Hz
    currents, reached, why = run_follow(
        bank, one, one, period, target[np.newaxis], control == "skin", bank.states([state])
    )
    outcome = judge(target, reached[0], period, _limits(why[0], period))
    return Design(Drive([0.0, *ends], [*currents[0], currents[0, -1]], held=True), current, state, outcome)


def _limits(why: Index, period: float) -> tuple[tuple[str, float], ...]:
    met = ((LIMITS[int(code)], float(np.argmax(why == code)) * period) for code in np.unique(why) if code)
    return tuple(sorted(met, key=lambda limit: limit[1]))
