"""The current of a cue and the target that it reaches."""

import numpy as np
import pytest

from thermicon.circuit import Rig, Trace, simulate
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons import Icon, load_library, parse

THENAR, SHANI = Rig.load("thenar"), Rig.load("shani2021")


def step(control: str, change: str = "cool by 6 °C at 3 °C/s") -> Icon:
    body = f"{change}\n hold for 4 s\n return at 3 °C/s"
    return parse(f"cue 1\nset s {{\n control {control}\n baseline 32 °C\n}}\nicon step {{\n {body}\n}}\n").icons[0]


def controlled(trace: Trace) -> np.ndarray:
    return trace.skin_C if trace.control == "skin" else trace.display_C


@pytest.mark.parametrize("rig", [THENAR, SHANI], ids=lambda rig: rig.name)
@pytest.mark.parametrize("control", ["skin", "display"])
def test_in_a_hold_the_current_does_not_ring_and_the_target_is_met(rig: Rig, control: str) -> None:
    trace = simulate(step(control), rig, tail_s=3.0)
    settled = (trace.time_s > 2.5) & (trace.time_s < 5.98)
    if rig is SHANI and control == "skin":
        settled &= trace.time_s > 4.0  # its standing flux keeps it at the limit for longer
    assert np.abs(np.diff(trace.current_A[settled], 2)).max() < 0.01
    assert np.abs(controlled(trace) - trace.target_C)[settled].max() < 1e-3
    after = trace.time_s > 9.5
    assert np.abs(np.diff(trace.current_A[after], 2)).max() < 0.01
    assert np.abs(controlled(trace) - 32.0)[after].max() < 1e-3


def test_a_sink_that_warms_neither_rings_nor_misses() -> None:
    rig = THENAR.with_(heat_sink={"temperature_C": 28.0, "capacity_J_per_K": 90.0, "air_resistance_K_per_W": 1.5})
    for icon in load_library("six-icons"):
        trace = simulate(icon, rig)
        assert trace.outcome.reached
        assert abs(trace.outcome.largest_miss_K) < 1e-3
        assert np.abs(np.diff(trace.current_A, 2))[-52:-2].max() < 1e-4


def test_the_skin_cue_needs_the_whole_driver_and_is_reached() -> None:
    trace = simulate(step("skin"), THENAR)
    assert trace.outcome.reached
    assert trace.outcome.reason is None
    assert (trace.current_A.min(), trace.current_A.max()) == (-1.5, 1.5)
    assert abs(trace.outcome.largest_miss_K) == pytest.approx(0.085, abs=0.01)
    assert (trace.display_C.min(), trace.display_C.max()) == pytest.approx((23.7, 33.5), abs=0.1)


def test_a_miss_says_how_much_when_and_why() -> None:
    trace = simulate(step("skin"), THENAR.with_(**{"driver.current_limit_A": 1.0}))
    assert not trace.outcome.reached
    assert trace.outcome.largest_miss_K == pytest.approx(1.31, abs=0.02)
    assert trace.outcome.largest_miss_s == pytest.approx(2.0, abs=0.02)
    assert trace.outcome.reason == (
        "misses its target by 1.31 K at 2.00 s, limited by the current limit from 0.00 s "
        "and lower current limit from 6.00 s"
    )
    for limit, miss in ((SHANI.driver.current_max_A, 2.12), (1.5, 0.73)):
        printed = simulate(step("skin"), SHANI.with_(**{"driver.current_limit_A": limit}))
        assert printed.outcome.largest_miss_K == pytest.approx(miss, abs=0.01)


def test_a_drive_that_only_cools_cannot_return_the_skin() -> None:
    trace = simulate(step("skin"), SHANI.with_(**{"driver.current_min_A": 0.0}), tail_s=2.0)
    assert trace.outcome.largest_miss_K == pytest.approx(-4, abs=0.5)
    assert trace.current_A.min() == 0.0


def test_compliance_voltage_binds() -> None:
    trace = simulate(step("skin"), THENAR.with_(**{"driver.voltage_limit_V": 4.0}))
    assert "compliance voltage" in str(trace.outcome.reason)
    # The limit binds at the start of a period; within one the plates drift by a few hundredths of a kelvin.
    assert np.abs(trace.voltage_V).max() < 4.0 + 1e-3


def test_more_current_than_cools_is_never_used() -> None:
    deep = parse("cue 1\nset s {\n control skin\n}\nicon deep {\n cool to -9 °C at 9 °C/s\n hold for 60 s\n}")
    rig = THENAR.with_(
        **{"driver.current_limit_A": 9.0, "driver.voltage_limit_V": 90.0, "heat_sink.temperature_C": 60.0}
    )
    trace = simulate(deep.icons[0], rig)
    assert "current of greatest cooling" in str(trace.outcome and trace.outcome.reason)
    best = THENAR.module.seebeck_V_per_K * (32 + 273.15) / THENAR.module.resistance_ohm
    assert trace.current_A.max() < best
    falling = np.diff(trace.display_C[trace.time_s > 5])
    assert falling.max() < 1e-9, "it goes on towards the coldest there is and does not run away"


def test_current_control_plays_its_own_corners_from_the_holding_current() -> None:
    text = "cue 1\nset s {\n control current\n}\nicon pump {\n to 0.5 A at 1 A/s\n hold for 2 s\n return at 1 A/s\n}"
    trace = simulate(parse(text).icons[0], THENAR)
    start, _ = steady_state(THENAR, "display", 32.0)
    assert trace.current_A[0] == pytest.approx(start)
    assert trace.current_A.max() == pytest.approx(0.5)
    assert trace.time_s[-1] == pytest.approx(2 * (0.5 - start) + 2)
    assert trace.display_C[0] == pytest.approx(32.0)
    assert trace.display_C.min() < 28.5
    assert np.isnan(trace.target_C).all()
    assert trace.outcome is None


def test_a_slower_driver_still_holds() -> None:
    trace = simulate(step("display"), THENAR.with_(**{"driver.update_Hz": 20.0}))
    changes = np.flatnonzero(np.diff(trace.current_A) != 0) + 1
    assert set(changes % 5) == {0}, "the current changes only at the driver's updates"
    assert np.abs(trace.display_C - trace.target_C)[(trace.time_s > 3) & (trace.time_s < 5.9)].max() < 5e-3
