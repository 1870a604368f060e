"""What a rig warns of, with the cure."""

from __future__ import annotations

import numpy as np

from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.rig.rig_warnings import STEP_S
from thermicon.circuit.solver.kernel import LONGEST_STEP_S


def test_a_limit_that_ten_volts_do_not_command_is_named_with_its_cure() -> None:
    (said,) = Rig.load("fingertip").with_(**{"driver.current_limit_A": 2.0}).warnings
    assert "driver.current_limit_A = 2 A takes 13.3 V of command" in said and "reach 1.5 A" in said
    assert "set driver.transconductance_A_per_V to that of your driver (0.2 or more for 2 A)" in said
    more_gain = {"driver.current_limit_A": 2.0, "driver.transconductance_A_per_V": 0.2}
    assert Rig.load("fingertip").with_(**more_gain).warnings == ()


def test_a_plate_faster_than_two_steps_of_the_solver() -> None:
    """Time constants of 5 ms against steps of 10; with updates every 2.5 ms the steps are short enough."""
    thenar = Rig.load("thenar")
    assert STEP_S == LONGEST_STEP_S
    (said,) = thenar.with_(**{"module.cold_plate_J_per_K": 0.01}).warnings
    assert said.startswith("module.cold_plate_J_per_K = 0.01 J/K follows what it touches within 5.5 ms, under the 20 ")
    assert said.endswith("give it 0.038 J/K or more, with what is fixed to it, or set driver.update_Hz to 382 or more")
    assert thenar.with_(**{"module.cold_plate_J_per_K": 0.038}).warnings == ()
    assert thenar.with_(**{"module.cold_plate_J_per_K": 0.01, "driver.update_Hz": 382}).warnings == ()
    assert thenar.with_(**{"module.cold_plate_J_per_K": 0.01, "contact.area_cm2": 0.5}).warnings == ()


def test_such_a_plate_is_off_in_a_drive_and_not_with_short_steps() -> None:
    def display_C(rig: Rig, rows_Hz: float) -> np.ndarray:
        times = np.arange(0.0, 2.0 + 1e-9, 1.0 / rows_Hz)
        coarse = np.arange(0.0, 2.0 + 1e-9, 0.01)
        amperes = np.interp(times, coarse, 0.5 * np.sin(2.0 * np.pi * coarse) + 0.3 * (coarse > 0.5))
        return simulate_current(Drive(times, amperes), rig, rate_Hz=100.0).display_C

    thenar = Rig.load("thenar")
    for stored, least, most in ((0.01, 0.1, 0.3), (0.037, 0.0, 0.03)):
        rig = thenar.with_(**{"module.cold_plate_J_per_K": stored})
        assert least < np.abs(display_C(rig, 100.0) - display_C(rig, 5000.0)).max() < most
