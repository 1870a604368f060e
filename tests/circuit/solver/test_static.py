"""What `check --rig` can say without a run."""

import pytest

from thermicon.circuit import Rig, simulate
from thermicon.circuit.solver.static import check_static
from thermicon.icons import Icon, load_library, parse

THENAR = Rig.load("thenar")


def icon(body: str, control: str = "display", baseline: float = 32) -> Icon:
    return parse(f"cue 1\nset s {{\n control {control}\n baseline {baseline} °C\n}}\nicon x {{\n{body}\n}}").icons[0]


@pytest.mark.parametrize("name", ["six-icons", "cooling-step-skin"])
def test_shipped_sets_are_possible(name: str) -> None:
    for one in load_library(name):
        assert check_static(one, THENAR) == ()


def test_a_baseline_that_cannot_be_held() -> None:
    weak = THENAR.with_(**{"driver.current_limit_A": 0.05})
    (message,) = check_static(icon("cool by 1 °C at 1 °C/s"), weak)
    assert "icon x: rig thenar: a baseline of 32 °C on the display cannot be held" in message


def test_a_level_beyond_the_rig_and_one_within() -> None:
    hot_sink = THENAR.with_(**{"driver.current_limit_A": 0.3})
    (message,) = check_static(icon("cool to 4 °C at 0.2 °C/s"), hot_sink)
    assert "icon x: 4 °C on the display is outside the" in message
    assert "that rig thenar can hold; use a smaller change or a higher driver.current_limit_A" in message
    assert check_static(icon("cool to 20 °C at 0.2 °C/s"), hot_sink) == ()


def test_what_is_just_beyond_the_rig_reads_as_beyond() -> None:
    weak = THENAR.with_(**{"driver.current_limit_A": 0.3})
    (message,) = check_static(icon("cool to 15.88 °C at 0.2 °C/s"), weak)
    assert "15.88 °C on the display is outside the 15.90 … " in message
    (message,) = check_static(icon("cool by 6 °C at 5.927 °C/s"), THENAR)
    assert "5.927 °C/s of cooling at 0 s is more than the 5.926 °C/s that" in message
    (message,) = check_static(icon("cool to 0.08 °C at 3 °C/s"), Rig.load("tcs2"))
    assert "0.08 °C on the display needs a display of 0.08 °C, outside the 0.1 … 60 °C of thermode tcs2" in message


def test_a_rate_beyond_the_rig_is_one_that_the_run_misses() -> None:
    fast = icon("cool by 6 °C at 8 °C/s\nhold for 1 s")
    (message,) = check_static(fast, THENAR)
    assert message.startswith("icon x: 8 °C/s of cooling at 0 s is more than the 5.")
    outcome = simulate(fast, THENAR).outcome
    assert outcome is not None
    assert not outcome.reached


def test_warming_too_fast_and_voltage() -> None:
    (message,) = check_static(icon("warm by 4 °C at 15 °C/s"), THENAR)
    assert "15 °C/s of warming at 0 s is more than the" in message
    weak = THENAR.with_(**{"driver.voltage_limit_V": 2.0})
    assert "of cooling at 0 s is more than the" in check_static(icon("cool by 4 °C at 3 °C/s"), weak)[0]


def test_currents_beyond_the_driver() -> None:
    (message,) = check_static(icon("to 2 A at 1 A/s", "current"), THENAR)
    assert "icon x: 2 A is outside the driver's -1.5 … 1.5 A" in message
