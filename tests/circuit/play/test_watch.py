"""Readings that a guard allows and those that it does not."""

import math
from collections.abc import Callable

import pytest

from thermicon.circuit.play.watch import Numbers, Stopped, Watch

LOOP = Numbers(20.0, 40.0, react_s=0.1, look_every_s=0.05, late_s=0.1, rest_s=30.0, pause_s=20.0, closed_loop=True)
OPEN = LOOP._replace(closed_loop=False)
HELD = LOOP._replace(held_low_C=26.0, held_high_C=36.0, held_s=8.0)
RAMP = [(0.0, 32.0), (5.0, 32.0), (7.0, 36.0), (60.0, 36.0)]
Sensor = Callable[[float], float]


def stops(
    first: Sensor | None,
    second: Sensor | None = None,
    numbers: Numbers = LOOP,
    points: list[tuple[float, float]] = RAMP,
    until_s: float = 20.0,
    on: Callable[[float], bool] = lambda now_s: True,
    begin_s: float = 1e5,
) -> tuple[float, str]:
    """When and why looks every 50 ms stop a play; (inf, "") where they do not."""
    watch = Watch(lambda: numbers)
    watch.expect(points, begin_s)
    sensors = {name: sensor for name, sensor in (("sensor", first), ("second sensor", second)) if sensor is not None}
    for k in range(round(until_s / 0.05)):
        now_s = 0.05 * k
        levels_C = {name: sensor(now_s) for name, sensor in sensors.items()}
        try:
            watch.see(levels_C, begin_s + now_s, begin_s + now_s, on(now_s))
        except Stopped as problem:
            return now_s, str(problem)
    return math.inf, ""


def display(now_s: float) -> float:
    """Where it is predicted to be."""
    return 32.0 + 2.0 * min(max(now_s - 5.0, 0.0), 2.0) + 1e-4 * math.sin(1e3 * now_s)


def stepped(step_K: float, lag_s: float = 0.0, offset_K: float = 0.0) -> Sensor:
    """A sensor with steps, which is late and off."""
    return lambda now_s: step_K * round((display(now_s - lag_s) + offset_K) / step_K)


def lies(by_K: float, from_s: float = 8.0, for_s: float = math.inf) -> Sensor:
    return lambda now_s: display(now_s) + (by_K if from_s <= now_s < from_s + for_s else 0.0)


@pytest.mark.parametrize("by_K", [1.5, -1.5, 3.0, -5.0])
@pytest.mark.parametrize("which", [0, 1])
def test_two_sensors_apart_stop_after_three_tenths_of_a_second(by_K: float, which: int) -> None:
    sensors = [display, lies(by_K)] if which else [lies(by_K), display]
    when_s, why = stops(*sensors, numbers=OPEN)
    assert "the sensors are" in why
    assert "one of them is wrong or has come off" in why
    assert 8.25 <= when_s <= 8.35 + (0.35 if abs(by_K) < 2.0 and not which else 0.2)


def test_two_sensors_may_differ_by_1_kelvin_and_by_more_for_a_moment() -> None:
    assert stops(display, lies(0.98), OPEN) == (math.inf, "")
    assert stops(display, lies(1.02), OPEN)[0] < 9.0
    assert stops(display, lies(3.0, for_s=0.25), OPEN) == (math.inf, "")
    assert stops(display, lies(3.0, for_s=0.5), OPEN)[0] < 9.0


def test_a_second_sensor_that_is_late_by_0_3_s_and_off_by_0_3_K_is_healthy() -> None:
    for step_K in (0.01, 0.0625, 0.1):
        assert stops(stepped(step_K), stepped(step_K, 0.3, -0.3)) == (math.inf, "")


@pytest.mark.parametrize("by_K", [1.6, -1.6, 3.5])
def test_a_loop_beside_its_prediction_stops_after_a_second(by_K: float) -> None:
    for sensors in ([lies(by_K)], [None, lies(by_K)], [lies(by_K), lies(by_K)]):
        when_s, why = stops(*sensors)
        assert "K from its prediction for 1 s, more than 1.5 K" in why
        assert 9.0 < when_s <= 9.15
        assert stops(*sensors, numbers=OPEN) == (math.inf, ""), "an open loop is not predicted so well"
        assert stops(*sensors, points=[]) == (math.inf, ""), "in a rest nothing is predicted"


def test_a_loop_may_be_1_5_kelvin_beside_and_farther_for_a_moment() -> None:
    assert stops(lies(1.48)) == (math.inf, "")
    assert stops(lies(1.52))[0] < 9.2
    assert stops(lies(2.0, for_s=0.9)) == (math.inf, "")
    assert stops(lies(2.0, for_s=1.2))[0] < 9.2


def test_a_slow_reading_is_judged_by_the_prediction_of_its_time() -> None:
    """A reading of 1.6 s on a ramp of 2 K/s: the display was where it is said to be at some time of it."""
    watch = Watch(lambda: LOOP)
    watch.expect(RAMP, 0.0)
    for asked_s in (5.2, 6.8, 8.4):
        watch.see({"sensor": display(asked_s)}, asked_s, asked_s + 1.6, True)
    watch.see({"sensor": 34.0}, 8.4, 10.0, True)
    with pytest.raises(Stopped, match=r"2\.00 K from its prediction"):
        watch.see({"sensor": 34.0}, 10.0, 11.6, True)


@pytest.mark.parametrize(("which", "name"), [(0, "the sensor"), (1, "the second sensor")])
def test_a_frozen_sensor_is_found_by_the_other_one(which: int, name: str) -> None:
    still: Sensor = lambda now_s: display(min(now_s, 5.0))  # noqa: E731
    near = LOOP._replace(sensor_step_K=0.1)
    slow = [(0.0, 32.0), (60.0, 32.0)]  # nothing is predicted to move

    def drifts(now_s: float) -> float:
        return 32.0 + 0.2 * max(0.0, now_s - 5.0) + 1e-4 * math.sin(1e3 * now_s)

    sensors = [drifts, still] if which else [still, drifts]
    when_s, why = stops(*sensors, numbers=near, points=slow)
    assert f"{name} is frozen: it has read 32.0" in why
    assert "while the other one moved by 0.5" in why
    assert 8.0 < when_s <= 8.2, "0.5 s later it has moved by three steps in 1.5 s, and 1 s after that"


def test_a_sensor_of_tenths_that_waits_for_its_next_step_is_not_frozen() -> None:
    """It has read the same for 5 s when the display moves, is late by 0.3 s, and moves when the other one stays."""
    assert stops(display, stepped(0.1, 0.3)) == (math.inf, "")
    assert stops(stepped(0.1), stepped(0.1, 0.3)) == (math.inf, "")
    assert stops(stepped(0.1)) == (math.inf, "")


def test_a_sensor_alone_is_frozen_where_the_prediction_moves() -> None:
    still: Sensor = lambda now_s: display(min(now_s, 5.0))  # noqa: E731
    when_s, why = stops(still, numbers=OPEN)
    assert "is frozen: it has read 32.000 degrees C while" in why
    assert "were predicted" in why
    assert 6.65 < when_s <= 6.8, "0.5 s later three steps are predicted in 0.15 s, and 1 s after that"
    assert stops(still, numbers=OPEN._replace(frozen_s=16.0)) == (math.inf, ""), "a slow sensor may say so"
    assert stops(still, numbers=OPEN._replace(sensor_step_K=1.01)) == (math.inf, "")
    assert stops(still, numbers=OPEN._replace(sensor_step_K=0.95))[0] < 9.0


def test_two_sensors_that_froze_together_are_found_by_the_prediction() -> None:
    still: Sensor = lambda now_s: display(min(now_s, 5.0))  # noqa: E731
    when_s, why = stops(still, still, numbers=OPEN)
    assert "were predicted" in why
    assert when_s <= 6.8


@pytest.mark.parametrize(("level_C", "side"), [(36.5, "high"), (25.5, "low")])
def test_the_second_cut_off_counts_the_time_beyond_with_power(level_C: float, side: str) -> None:
    there: Sensor = lambda now_s: level_C + 1e-3 * math.sin(1e3 * now_s)  # noqa: E731
    for sensors in ([there], [None, there], [there, there]):
        when_s, why = stops(*sensors, numbers=HELD, points=[])
        assert "outside 26 to 36 degrees C for 8." in why
        assert 8.0 < when_s <= 8.1
    assert stops(there, numbers=HELD._replace(held_s=None), points=[]) == (math.inf, "")
    assert stops(there, numbers=HELD, points=[], on=lambda now_s: now_s > 5.0)[0] > 13.0, "only with power"
    back: Sensor = lambda now_s: 32.0 if 4.0 < now_s < 4.2 else there(now_s)  # noqa: E731
    assert stops(back, numbers=HELD, points=[])[0] > 12.0, "it begins anew"
    edge: Sensor = lambda now_s: (36.0 if side == "high" else 26.0) + 0 * now_s  # noqa: E731
    assert stops(edge, numbers=HELD, points=[]) == (math.inf, "")


def test_a_display_that_stays_beyond_does_so_across_plays() -> None:
    watch = Watch(lambda: HELD)
    for play in range(3):
        watch.expect([], 100.0 * play)
        watch.see({"sensor": 36.5 + 0.01 * play}, 3.0 * play, 3.0 * play, True)
    watch.expect()
    with pytest.raises(Stopped, match=r"for 8\.1 s"):
        watch.see({"sensor": 36.6}, 8.1, 8.1, True)


@pytest.mark.parametrize(
    ("level_C", "words"),
    [
        (19.99, r"the display is at 19\.99 degrees C, outside 20 to 40"), (40.01, "outside 20 to 40"),
        (math.nan, "the sensor is lost: it reads nan"), (math.inf, "lost"), (120.0, "lost"), (-20.0, "lost"),
    ],
)  # fmt: skip
def test_a_display_outside_the_cut_off_or_no_thermistor(level_C: float, words: str) -> None:
    watch = Watch(lambda: LOOP)
    watch.see({"sensor": 20.0, "second sensor": 20.1}, 0.0, 0.0, True)
    watch.see({"sensor": 40.0}, 0.0, 0.0, True)
    with pytest.raises(Stopped, match=words):
        watch.see({"sensor": level_C}, 0.0, 0.0, True)
    with pytest.raises(Stopped, match=words.replace("the sensor", "the second sensor")):
        watch.see({"sensor": 30.0, "second sensor": level_C}, 0.0, 0.0, True)
