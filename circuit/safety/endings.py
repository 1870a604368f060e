"""What follows a drive: its last value held, zero current, power off; and zero current without limit of time.

*Last value held*: the driver keeps its last current, or its last duty. *Zero current*: the driver gives none and the
heat sink keeps working; the skin drifts to where the hot plate takes it, not to its baseline. *Power off*: no current,
with open terminals (no current flows), and the supply of the heat sink is off too. A sink with a capacity and its own
controller keeps its heat, loses its power and drifts with the hot plate. An ideal sink has no capacity in the rig file:
it is taken as heavy enough not to move within a minute, which makes power off the same as zero current; later it drifts
towards the room, which is no hazard.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..rig.rules import Limits
from ..solver.batch_inputs import Bank, Intervals, State, run_on
from ..solver.network import unpowered
from ..solver.steady import state_under_current
from .checks import Scenario
from .ensemble import Ensemble
from .tally import HOTTEST_C, WATCHED, Tally

ENDING_S = 60.0
"""How long each ending is followed in full: until somebody has noticed."""

ENDINGS = ("last value held", "zero current", "power off")
IN_THE_END = "zero current in the end"

LATER_S = 600.0
"""Zero current adds to the dose for 10 min, where the classes of contact of IEC 60601-1 Table 24 end."""

ENDING_ROWS_S = np.concatenate([np.arange(200) * 0.01, 2.0 + np.arange(180) * 0.1, 20.0 + np.arange(41) * 1.0])
"""Times of the rows of an ending: fine after the jump of the current, coarse later."""

LATE_S = np.geomspace(ENDING_S, LATER_S, 60)
"""Rows of zero current from then on."""


def zero_current_C(ensemble: Ensemble) -> Array:
    """WATCHED (4, corners) that zero current leads to without limit of time."""
    steady_C = np.full((len(WATCHED), len(ensemble.corners)), HOTTEST_C)
    for lane, network in enumerate(ensemble.networks):
        state = state_under_current(network, 0.0, in_the_end=True)
        steady_C[:, lane] = [network.read(state, name) for name in WATCHED]
    return steady_C


def judge_the_end(ensemble: Ensemble, limits: Limits, end_s: float, begun_C: Array) -> Tally:
    """The steady state under zero current, checked against the limits of temperature."""
    tally = Tally(limits, ensemble.corners, Scenario(ending=IN_THE_END), begun_C=begun_C)
    levels = np.repeat(zero_current_C(ensemble)[:, :, np.newaxis], 2, axis=2)
    tally.add(np.array([end_s + LATER_S, end_s + 2 * LATER_S]), levels, rates=False, sums=False, drift=True)
    return tally


def dose_time_s(ensemble: Ensemble, limits: Limits, state: State, dose_before: Array, session_s: float) -> float:
    """For how long in s zero current may last before the dose of skin reaches its limit, at most a session.

    `dose_before` (corners,) in min CEM43 is what the drive has added.
    """
    from .exposure import cem43_min

    most = next(rule.limit for rule in limits.rules if rule.quantity == "thermal dose")
    times = np.concatenate([[0.0], np.geomspace(1.0, session_s, 120)])
    values, _ = ensemble.hold(0.0, state, times)
    skin = np.clip(np.nan_to_num(values[WATCHED.index("skin_C")], nan=HOTTEST_C), None, HOTTEST_C)
    dose = cem43_min(times, skin).max(axis=0) + float(dose_before.max())
    over = np.flatnonzero(dose > most)
    return session_s if not len(over) else float(times[max(0, over[0] - 1)])


def without_power(ensemble: Ensemble, state: State, times_s: Array) -> tuple[Array, State]:
    """WATCHED at times from now of rigs whose controlled heat sinks have lost their power, and the last states."""
    networks = [
        unpowered(network, float(sink)) for network, sink in zip(ensemble.networks, state.sink[:, 0], strict=True)
    ]
    none = np.zeros((len(times_s) - 1, len(networks)))
    intervals = Intervals(times_s, np.arange(len(times_s)), none, none)
    begun = State.settled(state.nodes_C)
    return run_on(Bank.of(networks), ensemble.lanes, ensemble.lanes, intervals, begun, WATCHED)
