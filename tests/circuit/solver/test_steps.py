"""Steps are played as fast as the driver can: never too steep, judged from the moment they arrive."""

import numpy as np
import pytest

from thermicon.circuit import Rig, nearest_reachable, simulate
from thermicon.circuit.solver.static import check_static
from thermicon.circuit.solver.trace import judge
from thermicon.icons import Icon, parse

THENAR = Rig.load("thenar")


def cue(body: str, control: str = "display") -> Icon:
    return parse(f"cue 1; set {{ control {control}; baseline 32 °C }}; icon x {{ {body} }}")["x"]


def rising(times_s: np.ndarray, begin: float, rate: float) -> np.ndarray:
    """A response that leaves 0 at `begin` and climbs to 1 at `rate`."""
    return np.clip((times_s - begin) * rate, 0.0, 1.0)


def test_until_a_step_arrives_nothing_is_missed() -> None:
    ends = 0.01 * np.arange(1, 401)
    target = (ends > 1.0 + 1e-9).astype(float)
    found = judge(target, rising(ends, 1.0, 2.0), 0.01, (), steps_s=((1.0, 4.0),))
    assert found.reached
    assert found.slowest_step_s == pytest.approx(0.45, abs=0.011)  # 0.1 K before the end of half a second
    assert not judge(target, rising(ends, 1.0, 2.0), 0.01, ()).reached


def test_a_step_that_does_not_arrive_before_the_next_is_late() -> None:
    ends = 0.01 * np.arange(1, 401)
    target = ((ends > 1.0 + 1e-9) & (ends <= 1.3 + 1e-9)).astype(float)
    reached = rising(ends, 1.0, 1.0) * (ends <= 1.3)
    found = judge(target, reached, 0.01, (), steps_s=((1.0, 1.3), (1.3, 4.0)))
    assert not found.reached
    assert found.late_s == (1.0,)
    assert found.largest_miss_K == pytest.approx(-0.7)
    assert found.reason == "misses its target by 0.70 K at 1.30 s; its step at 1.00 s does not arrive in time"


def test_a_level_that_is_never_held_is_missed_behind_a_step_too() -> None:
    ends = 0.01 * np.arange(1, 801)
    found = judge(np.ones(800), np.full(800, 0.5), 0.01, (), steps_s=((0.0, float("inf")),))
    assert not found.reached
    assert found.late_s == (0.0,)
    assert ends[-1] == 8.0


def test_a_last_step_without_time_to_arrive_is_not_held_against_the_rig() -> None:
    ends = 0.01 * np.arange(1, 301)
    target = np.where(ends > 2.9 + 1e-9, 0.0, 1.0)
    assert judge(target, np.ones(300), 0.01, (), steps_s=((2.9, float("inf")),)).reached


def test_a_square_wave_is_reached_and_its_slowest_step_told() -> None:
    trace = simulate(cue("square by 3 °C every 4 s for 8 s"), THENAR)
    assert trace.reachable
    assert trace.outcome is not None
    assert 0.5 < (trace.outcome.slowest_step_s or 0.0) < 1.5
    # At the driver's limit on the way, at the level behind it.
    assert trace.current_A.min() == -1.5
    assert trace.display_C[390] == pytest.approx(29.0, abs=0.1)


def test_a_ramp_of_the_same_size_has_no_step() -> None:
    outcome = simulate(cue("cool by 3 °C at 3 °C/s; hold for 1 s"), THENAR).outcome
    assert outcome is not None
    assert outcome.slowest_step_s is None


def test_a_square_wave_too_fast_for_the_module_says_so() -> None:
    trace = simulate(cue("square by 3 °C every 500 ms for 2 s"), THENAR)
    assert not trace.reachable
    assert "does not arrive in time" in (trace.reason or "")


def test_a_step_is_never_too_steep_but_a_ramp_may_be() -> None:
    assert check_static(cue("step by -3 °C; hold for 2 s"), THENAR) == ()
    (told,) = check_static(cue("cool by 3 °C over 10 ms; hold for 2 s"), THENAR)
    assert "slow it down" in told
    weak = THENAR.with_(**{"driver.current_limit_A": 0.3})
    (told,) = check_static(cue("step to 0 °C; hold for 2 s"), weak)
    assert "can hold" in told


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
    assert near is not None
    assert simulate(near.icon, THENAR).reachable
    assert parse(str(near.icon))["x"] == near.icon


def test_an_icon_that_plays_another_has_a_nearest_one() -> None:
    text = "cue 1; set { control display; baseline 32 °C }; icon a { pulse by -4 °C for 300 ms; rest for 2 s }"
    icon = parse(text + "; icon b { play a; rest for 1 s; play a }")["b"]
    near = nearest_reachable(icon, THENAR)
    assert near is not None
    assert near.icon.corners().duration_s == pytest.approx(5.6)


def test_waves_of_current_are_played_as_written() -> None:
    icon = cue("square by 0.5 A every 2 s for 4 s starting up; step to 0.2 A; hold for 1 s", "current")
    trace = simulate(icon, THENAR)
    rest = float(icon.corners().value[0])
    assert rest == 0.0
    assert trace.reachable
    assert trace.current_A[50] - trace.current_A[150] == pytest.approx(1.0)
