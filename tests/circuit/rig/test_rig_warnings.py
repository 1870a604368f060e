"""What a rig warns of, with the cure."""

from __future__ import annotations

from thermicon.circuit import Rig


def test_a_limit_that_ten_volts_do_not_command_is_named_with_its_cure() -> None:
    (said,) = Rig.load("fingertip").with_(**{"driver.current_limit_A": 2.0}).warnings
    assert "driver.current_limit_A = 2 A takes 13.3 V of command" in said and "reach 1.5 A" in said
    assert "set driver.transconductance_A_per_V to that of your driver (0.2 or more for 2 A)" in said
    more_gain = {"driver.current_limit_A": 2.0, "driver.transconductance_A_per_V": 0.2}
    assert Rig.load("fingertip").with_(**more_gain).warnings == ()
