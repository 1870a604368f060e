"""Swapped wires and drivers that are too strong: the test of the polarity, the limit of the current."""

import numpy as np
import pytest

from tests.circuit.safety.test_single_faults import COOL, LIMITS, MAY, REST, faulty
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Drive, Rig
from thermicon.circuit.safety.ensemble import Ensemble, between
from thermicon.circuit.safety.polarity import least_fall_K, polarity_check, where_tests_begin
from thermicon.circuit.safety.single_faults import Faulty
from thermicon.circuit.safety.stuck_rate import limited
from thermicon.circuit.safety.tally import WATCHED


def fall_K(one: Faulty) -> float:
    return least_fall_K(one.ensemble, where_tests_begin(one.ensemble, [one.start], [one.moments()]))


def test_swapped_poles_are_found_by_a_small_current() -> None:
    check, fault = polarity_check(faulty(), fall_K(faulty()))
    assert check.needed
    assert check.swapped_skin_C[1] > 42.0, "what cools heats"
    assert fault.colour == "red"
    check, fault = polarity_check(faulty(Drive([0, 1], [0.0, 0.0])), 0.3)
    assert not check.needed and fault.colour in ("green", "amber"), "a gentle cue needs none"


def test_right_wires_pass_the_test_from_every_start_in_every_corner_and_swapped_ones_never() -> None:
    """Of a module that is hardly known. Without the seconds off before it the same test would refuse right wires."""
    unsure = {"plates_relative": 0.6, "conductance_relative": 0.4, "gain_relative": 0.3}
    every = Ensemble.of(Rig.load("shani2021").with_(**{f"uncertainty.{key}": share for key, share in unsure.items()}))
    one = Faulty(every, COOL, REST, every.at_rest(REST), LIMITS, MAY)
    check, _ = polarity_check(one, fall_K(one))
    display, at_once, falls = WATCHED.index("display_C"), [], []
    begun = [every.at_rest(0.0), one.start]
    begun += [every.end_of(between(COOL, 0.0, instant), one.start) for instant in (0.3, 0.6, 2.9, 3.5)]
    for state in begun:
        for off_s in (0.0, check.off_before_s, 60.0):
            off = state if off_s == 0.0 else every.rest(0.0, state, off_s)
            right, wrong = (
                every.hold(current_A, off, np.array([0.0, check.test_s]))[0][display]
                for current_A in (check.test_current_A, -check.test_current_A)
            )
            if off_s == 0.0:
                at_once.append((right[:, 0] - right[:, 1]).min())
                continue
            falls.append(right[:, 0] - right[:, 1])
            assert (wrong[:, 0] - wrong[:, 1] < 0.0).all()
    assert len(falls[0]) == 65
    assert np.max(falls) > 3.0 * np.min(falls), "one corner is not like another"
    assert np.min(falls) > 1.5 * check.display_change_at_least_K > 0.2, "with room for a sensor that lags"
    assert min(at_once) < check.display_change_at_least_K, "the seconds off are needed"


@pytest.mark.parametrize(("low_A", "high_A"), [(-0.4, 0.6), (-0.9, 1.5), (-1.5, 0.6)])
def test_a_driver_is_limited_where_it_would_move_the_skin_too_fast_alike_for_both_signs_where_that_suffices(
    low_A: float, high_A: float
) -> None:
    """On a contact that was not measured, of which the better ones decide."""
    rig = sure_rig("thenar", "contact_resistance_relative", "gain_relative", "plates_relative")
    drive = Drive([0, 0.2, 0.4, 0.6, 5.0], [REST, low_A, high_A, REST, REST], held=True)
    every = Ensemble.of(rig)
    one = Faulty(every, drive, REST, every.at_rest(REST), LIMITS, MAY)
    slow = limited([one], [one.moments()])
    assert slow.limit_A is not None and slow.rate_K_per_s > 10.0
    low, high = slow.limit_A
    assert low <= low_A and high >= high_A
    assert not slow.kept or (low == -high) == (high_A < 1.2)
    assert slow.kept == (low_A > -1.4)
    skin = WATCHED.index("skin_C")

    def rate(current_A: float) -> float:
        values, _ = every.hold(current_A, every.end_of(between(drive, 0.0, 0.4), one.start), np.arange(300) * 0.01)
        return float(np.abs(np.diff(values[skin], axis=1)).max() / 0.01)

    assert (rate(low) < 10.0) == slow.kept and rate(high) < 10.0
    assert not slow.kept or rate(1.1 * low) > 10.0, "no narrower than it must be"
