"""The test of the wiring before a first play."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .checks import Scenario, colour_of, findings_of
from .demands import PolarityCheck, SingleFault
from .ensemble import Ensemble
from .single_faults import Faulty, Moments, side_by_side
from .tally import WATCHED, Tally

OFF_S = 10.0
"""So long the output is off before the test, so that what played before does not warm or cool the display any more."""
EACH = 3
"""Of the instants at which a current may get stuck, so many follow one at which a play is stopped before a test."""
TEST_A, TEST_S = 0.3, 2.0
"""A current small enough for any module and skin, for long enough to be seen by any thermistor."""


def testing_A(ensemble: Ensemble) -> float:
    """The current in A by which the polarity is checked: in whole milliamperes, within the driver's."""
    return math.floor(1e3 * min(TEST_A, ensemble.rig.driver.current_max_A) + 1e-9) / 1e3


def where_tests_begin(ensemble: Ensemble, rests: Sequence[State], plays: Sequence[Moments]) -> Moments:
    """Where the output may be put off before a test: in a rest, at instants of first plays, without power."""
    still, count = [*rests, ensemble.at_rest(0.0)], len(ensemble.corners)
    few = []
    for moments in plays:
        instant = np.arange(len(moments.rigs)) // count
        few.append(moments.take(np.flatnonzero(instant % EACH == 0)))
    states = side_by_side([*(moments.state for moments in few), *still])
    rigs = np.concatenate([*(moments.rigs for moments in few), *[ensemble.lanes] * len(still)])
    return Moments(states, np.zeros(len(rigs)), rigs, ())


def least_fall_K(ensemble: Ensemble, starts: Moments) -> float:
    """By how much the display falls at least in a test, in every corner, after the output was off."""
    _, off = ensemble.hold(0.0, starts.state, np.array([0.0, OFF_S]), starts.rigs)
    rows_s = np.array([0.0, TEST_S])
    display = ensemble.watch(testing_A(ensemble), off, rows_s, starts.rigs, ("display_C",))[0]
    return float((display[:, 0] - display[:, -1]).min())


def polarity_check(faulty: Faulty, fall_K: float) -> tuple[PolarityCheck, SingleFault]:
    """The effect of swapped poles, and the test that detects them where right ones make the display fall by so much."""
    swapped = Drive(faulty.drive.time_s, -faulty.drive.current_A, faulty.drive.held)
    tally = Tally(faulty.limits, faulty.ensemble.corners, Scenario(way="poles swapped"))
    low, high = np.inf, -np.inf
    for (rows, values), _ in faulty.ensemble.play(swapped, faulty.ensemble.at_rest(0.0)):
        tally.add(rows, values)
        skin = np.nan_to_num(values[WATCHED.index("skin_C")], nan=999.0)
        low, high = min(low, float(skin.min())), max(high, float(skin.max()))
    least_K = math.floor(50.0 * fall_K) / 100.0
    spans = round(low, 1), round(high, 1)
    check = PolarityCheck(not tally.passes(), OFF_S, testing_A(faulty.ensemble), TEST_S, least_K, spans)
    return check, SingleFault("swapped", colour_of(findings_of(tally.checks())), {"check": check})
