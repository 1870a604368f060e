"""Steps or waves on a rig: time of arrival, the nearest reachable shape."""

import math

import numpy as np
import pytest

from thermicon.circuit import Rig, nearest_reachable, simulate
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.inverse import steps_at
from thermicon.circuit.solver.trace import judge
from thermicon.icons import Icon, parse

THENAR = Rig.load("thenar")


def cue(body: str, control: str = "display") -> Icon:
    return parse(f"cue 1; set {{ control {control}; baseline 32 °C }}; icon x {{ {body} }}")["x"]


ENDS = 0.01 * np.arange(1, 801)


def after(begin: float) -> np.ndarray:
    return (begin + 1e-9 < ENDS).astype(float)


@pytest.mark.parametrize(
    ("count", "target", "reached", "steps_s", "late_s"),
    [
        (400, after(1.0), np.clip(2.0 * (ENDS - 1.0), 0.0, 1.0), [(1.0, 4.0)], ()),
        (400, after(1.0) - after(1.3), np.clip(ENDS - 1.0, 0.0, 1.0) * (ENDS <= 1.3), [(1.0, 1.3), (1.3, 4.0)], (1.0,)),
        (800, np.ones(800), np.full(800, 0.5), [(0.0, math.inf)], (0.0,)),  # a level that is never held
        (300, 1.0 - after(2.9), np.ones(800), [(2.9, math.inf)], ()),  # no time is left to arrive
        (300, after(1.02), np.zeros(800), [(1.02, math.inf)], ()),  # less than 2 s are
        (300, after(0.99), np.zeros(800), [(0.99, math.inf)], (0.99,)),
    ],
    ids=["arrives", "too late for the next", "never held", "at the end", "in 1.98 s", "in 2.01 s"],
)
def test_until_a_step_arrives_nothing_is_missed(
    count: int, target: np.ndarray, reached: np.ndarray, steps_s: list[tuple[float, float]], late_s: tuple[float, ...]
) -> None:
    found = judge(target[:count], reached[:count], 0.01, (), tuple(steps_s))
    assert (found.reached, found.late_s) == (not late_s, late_s)
    if steps_s == [(1.0, 4.0)]:
        assert found.slowest_step_s == pytest.approx(0.45, abs=0.011)  # 0.1 K before the end of half a second
        assert not judge(target[:count], reached[:count], 0.01, ()).reached
    if late_s == (1.0,):
        assert found.largest_miss_K == pytest.approx(-0.7)
        assert found.reason == "misses its target by 0.70 K at 1.30 s; its step at 1.00 s does not arrive in time"


def test_a_step_must_arrive_by_the_end_of_its_hold_or_before_the_next() -> None:
    body = "step by -3 °C; hold for 2 s; cool by 1 °C at 1 °C/s; step by 2 °C; cool by 1 °C at 1 °C/s; %s"
    for end, until_s in (("step by 1 °C", math.inf), ("step by 1 °C; hold for 1 s", 5.0)):
        first, second, last = steps_at(cue(body % end), 32.0)
        assert (*first, *second, *last) == pytest.approx((0.0, 2.0, 3.0, 4.0, 4.0, until_s), abs=1e-6)


def test_a_square_wave_is_reached_and_its_slowest_step_told() -> None:
    trace = simulate(cue("square by 3 °C every 4 s for 8 s"), THENAR)
    assert trace.reachable
    assert 0.5 < (trace.outcome.slowest_step_s or 0.0) < 1.5
    # At the driver's limit on the way, at the level behind it.
    assert trace.current_A.min() == -1.5
    assert trace.display_C[390] == pytest.approx(29.0, abs=0.1)
    ramp = simulate(cue("cool by 3 °C at 3 °C/s; hold for 1 s"), THENAR).outcome
    assert ramp is not None and ramp.slowest_step_s is None


def test_a_square_wave_too_fast_for_the_module_says_so() -> None:
    trace = simulate(cue("square by 3 °C every 500 ms for 2 s"), THENAR)
    assert not trace.reachable
    assert "does not arrive in time" in (trace.reason or "")


@pytest.mark.parametrize(
    "body",
    [
        "pulse by -4 °C for 300 ms; rest for 2 s; total 2.3 s",
        "sine by 4 °C every 1 s for 4 s starting cool",
        "step to 20 °C; hold for 400 ms; return at 3 °C/s",
        "repeat 2 { square by 4 °C every 1 s for 2 s; rest for 1 s }",
    ],
)
def test_a_shape_out_of_reach_has_a_nearest_one(body: str) -> None:
    icon = cue(body)
    near = nearest_reachable(icon, THENAR)
    assert simulate(near.icon, THENAR).reachable
    assert parse(str(near.icon))["x"] == near.icon


def test_waves_of_current_are_played_as_written() -> None:
    icon = cue("square by 0.5 A every 2 s for 4 s starting up; step to 0.2 A; hold for 1 s", "current")
    trace = simulate(icon, THENAR)
    assert float(icon.corners().value[0]) == 0.0
    assert trace.reachable
    assert trace.current_A[50] - trace.current_A[150] == pytest.approx(1.0)


def test_what_a_rig_cannot_hold_or_reach_is_said() -> None:
    with pytest.raises(RigError, match="a baseline of 32 °C on the display cannot be held"):
        simulate(cue("cool by 1 °C at 1 °C/s"), THENAR.with_(**{"driver.current_limit_A": 0.05}))
    for body in ("cool by 6 °C at 8 °C/s; hold for 1 s", "step to 0 °C; hold for 2 s"):
        outcome = simulate(cue(body), THENAR.with_(**{"driver.current_limit_A": 0.3})).outcome
        assert outcome is not None and not outcome.reached
