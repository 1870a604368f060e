"""Single faults of a first play: a display that was without power, and swapped poles."""

from __future__ import annotations

import numpy as np

from ..solver.drive import Drive
from .checks import Scenario, colour_of, findings_of
from .demands import PolarityCheck, SingleFault
from .single_faults import Faulty
from .tally import WATCHED, Tally

LONGEST_REST_S = 600.0
TEST_A, TEST_S = 0.3, 2.0
"""A current small enough for any module and skin, for long enough to be seen by any thermistor."""


def rest_before(faulty: Faulty) -> tuple[float | None, SingleFault]:
    """For how long in s rest must be held on a display that was without power, before the first play."""
    cold = faulty.ensemble.at_rest(0.0)

    def tally_after(rest_s: float) -> Tally:
        state = cold
        if rest_s > 0:
            state = faulty.ensemble.rest(faulty.rest_A, cold, rest_s)
        tally = Tally(faulty.limits, faulty.ensemble.corners)
        for (rows, values), _ in faulty.ensemble.play(faulty.drive, state):
            tally.add(rows, values)
        return tally

    at_once = tally_after(0.0)
    findings = findings_of(at_once.checks())
    rest: float | None = 0.0
    if not at_once.passes():
        low, high = 0, int(LONGEST_REST_S)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if tally_after(float(middle)).passes() else (middle, high)
        rest = float(high) if tally_after(float(high)).passes() else None
    told = {"finding": next(iter(findings), None), "rest_s": rest}
    return rest, SingleFault("unpowered", colour_of(findings), told)


def polarity_check(faulty: Faulty) -> tuple[PolarityCheck, SingleFault]:
    """The effect of swapped poles, and the wiring check that detects them."""
    swapped = Drive(faulty.drive.time_s, -faulty.drive.current_A, faulty.drive.held)
    tally = Tally(faulty.limits, faulty.ensemble.corners, Scenario(way="poles swapped"))
    low, high = np.inf, -np.inf
    for (rows, values), _ in faulty.ensemble.play(swapped, faulty.ensemble.at_rest(0.0)):
        tally.add(rows, values)
        skin = np.nan_to_num(values[WATCHED.index("skin_C")], nan=999.0)
        low, high = min(low, float(skin.min())), max(high, float(skin.max()))
    test_A = min(TEST_A, faulty.ensemble.rig.driver.current_max_A)
    values, _ = faulty.ensemble.hold(test_A, faulty.ensemble.at_rest(0.0), np.array([0.0, TEST_S]))
    display = values[WATCHED.index("display_C")]
    fall = float((display[:, 0] - display[:, -1]).min())
    needed = not tally.passes()
    check = PolarityCheck(needed, round(test_A, 3), TEST_S, round(0.5 * fall, 2), (round(low, 1), round(high, 1)))
    return check, SingleFault("swapped", colour_of(findings_of(tally.checks())), {"check": check})
