"""The gate of thermodes, against hand calculation or brute force."""

import numpy as np
import pytest

from tests.circuit.delivery.one_drive import worst_case
from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Device, Limits, Rig
from thermicon.circuit.delivery.setpoints import Setpoints, display_of, lag_of
from thermicon.circuit.delivery.ways import deliver, worst_cases
from thermicon.circuit.delivery.worstcase import ways_of
from thermicon.circuit.safety.display import DisplayCourse, DisplayPlant
from thermicon.circuit.safety.gate import Gate, gate_shown
from thermicon.circuit.safety.plant import left_s, recovery_s
from thermicon.circuit.safety.tally import WATCHED
from thermicon.circuit.solver.modes import shown
from thermicon.icons import parse

THENAR, TCS = Rig.load("thenar"), Device.load("qst-tcs2")
STEP_S = 0.01
STUCK = (0.1, 60.0)
UNDER = DisplayPlant.of(THENAR, STUCK)


SHOWN: dict[str, tuple[Setpoints, float | None, list[float]]] = {
    "pulses of one tick": (Setpoints(0.01, 0.1, 320, ((1, 300), (1, 320), (3, 320))), None, [32.0, 30.0, *[32.0] * 4]),
    "no faster than 300 K/s": (Setpoints(0.01, 0.1, 320, ((1, 220),)), 0.05, [32.0, 29.0, 26.0, 23.0, 22.0, 22.0]),
    "held until the end": (Setpoints(0.01, 0.1, 320, ((1, 310),)), 1.0, [32.0, *[31.0] * 100]),
    "a long tick in equal parts": (Setpoints(0.25, 0.1, 320, ((1, 310),)), None, np.linspace(32.0, 31.0, 26).tolist()),
}


@pytest.mark.parametrize(("points", "end_s", "display_C"), SHOWN.values(), ids=SHOWN)
def test_a_device_shows_its_set_points(points: Setpoints, end_s: float | None, display_C: list[float]) -> None:
    step, display = display_of(points, TCS, lagged=False, end_s=end_s)
    assert step == pytest.approx(0.01)
    assert display == pytest.approx(np.array(display_C))


def test_a_steady_ramp_runs_behind_its_set_points_by_the_lag() -> None:
    points = Setpoints(0.01, 0.1, 320, ((300, 170),))  # 5 K/s for 3 s
    _, display = display_of(points, TCS, lagged=True)
    assert display[-1] - 17.0 == pytest.approx(5.0 * lag_of(TCS), rel=1e-5)


def test_a_lag_answers_a_ramp_as_the_closed_form_does_on_any_grid() -> None:
    tau, rate = 0.21, 4.0
    for step in (0.01, 0.1):
        times = np.arange(0.0, 1.0 + step / 2, step)
        answer = 32.0 - rate * (times - tau * (1.0 - np.exp(-times / tau)))
        assert shown(32.0 - rate * times, step, tau) == pytest.approx(answer, abs=1e-9)


def course(levels: list[float], times: list[float], way: str = "as told", settling_s: float = 0.0) -> DisplayCourse:
    rows = np.arange(round(times[-1] / STEP_S) + 1) * STEP_S
    return DisplayCourse(way, STEP_S, np.interp(rows, times, levels), settling_s)


COOL = course([32, 26, 26, 32], [0, 1, 3, 4])
WARM = course([32, 38, 38, 32], [0, 2, 3, 5])
QUICK = course([32, 29, 32], [0, 0.5, 1])


def lumps_of(states: list[Array]) -> Array:
    return np.array([modes.lumps @ state for modes, state in zip(UNDER.modes, states, strict=True)])


@pytest.mark.parametrize("pause_s", [60.0, 120.0])
def test_a_steady_cycle_is_what_sixty_plays_come_to(pause_s: float) -> None:
    states = UNDER.steady(32.0)
    for _ in range(60):
        states = UNDER.after(COOL, pause_s, states)
    found = lumps_of(UNDER.cycle(COOL, pause_s))
    assert np.abs(found - lumps_of(states)).max() < 1e-3
    assert np.abs(found - lumps_of(UNDER.steady(32.0))).max() > 0.005, "it is not the rest"


@pytest.mark.parametrize("pause_s", [0.0, 2.5])
def test_a_steady_cycle_comes_back_to_itself_however_short_the_pause(pause_s: float) -> None:
    found = UNDER.cycle(QUICK, pause_s)
    assert lumps_of(UNDER.after(QUICK, pause_s, found)) == pytest.approx(lumps_of(found), abs=1e-9)


@pytest.mark.parametrize("pause_s", [2.0, 20.0])
def test_bounds_enclose_thirty_plays_in_any_order(pause_s: float) -> None:
    shows, begun = [COOL, WARM, QUICK], UNDER.steady(32.0)
    steady = [UNDER.cycle(show, pause_s) for show in shows]
    warm = lumps_of(UNDER.bound(shows, pause_s, steady, warm=True))
    cold = lumps_of(UNDER.bound(shows, pause_s, steady, warm=False))
    rng = np.random.default_rng(3)
    for order in (*rng.integers(0, 3, (3, 30)), [1] * 30, [0] * 30):
        states = begun
        for k in order:
            states = UNDER.after(shows[k], pause_s, states)
            now = lumps_of(states)
            assert (now <= warm + 1e-6).all()
            assert (now >= cold - 1e-6).all()


def test_what_is_left_of_a_pause_begins_after_the_display_has_settled() -> None:
    late = course([32, 26, 26, 32], [0, 1, 3, 4], "late", settling_s=1.5)
    assert (left_s(late, 5.0), left_s(late, 1.0)) == (3.5, 0.0)
    held = UNDER.after(late, 5.0, UNDER.steady(32.0))
    assert lumps_of(held) == pytest.approx(lumps_of(UNDER.after(COOL, 3.5, UNDER.steady(32.0))))


@pytest.mark.parametrize("settling_s", [0.0, 1.5])
def test_recovery_is_when_the_skin_is_back_in_every_corner(settling_s: float) -> None:
    one = course([32, 26, 26, 32], [0, 1, 3, 4], settling_s=settling_s)
    ((_, ended),) = UNDER.play(one, UNDER.steady(32.0))
    found = recovery_s(UNDER, one, UNDER.rest(one), ended)
    times = np.arange(0.0, 120.0, 0.01)
    skin = UNDER.held(32.0, ended, times)[WATCHED.index("skin_C")]
    began = UNDER.held(32.0, UNDER.steady(32.0), np.array([0.0]))[WATCHED.index("skin_C")]
    last = times[np.flatnonzero((np.abs(skin - began) > 0.1).any(axis=0))[-1]]
    assert last <= found - settling_s <= last + 0.12


def test_a_display_that_does_not_return_never_recovers() -> None:
    one = course([32, 28], [0, 1])
    ((_, ended),) = UNDER.play(one, UNDER.steady(32.0))
    assert recovery_s(UNDER, one, UNDER.rest(one), ended) is None


def test_the_shortest_pause_is_safe_and_a_tenth_less_is_not() -> None:
    hot = course([32, 40.5, 40.5, 32], [0, 1, 5, 6])
    (alone,) = gate_shown([[hot]], THENAR, stuck_C=STUCK, pause_s=600.0)
    seldom = next(one.value for one in alone.checks if one.quantity == "thermal dose")
    limits = Limits.of({"thermal_dose_min_CEM43": 5.0 * seldom})

    def judged(pause_s: float) -> Gate:
        return gate_shown([[hot]], THENAR, stuck_C=STUCK, limits=limits, pause_s=pause_s)[0]

    first = judged(600.0)
    shortest = first.repeated.shortest_pause_s
    assert first.safe
    assert shortest > 1.0
    assert judged(shortest).safe
    shorter = judged(round(0.9 * shortest, 2))
    assert shorter.colour == "red"
    assert f"the shortest safe pause is {shortest:g} s" in str(shorter.reason)


def test_what_it_demands_holds_when_simulated() -> None:
    hot = course([32, 41.5, 32], [0, 5, 10])
    (found,) = gate_shown([[hot]], THENAR, stuck_C=STUCK, pause_s=60.0)
    demands, skin = found.demands, WATCHED.index("skin_C")
    hang, begins, stuck = demands.faults
    assert (hang.colour, stuck.colour, demands.watchdog_s) == ("green", "red", 60.0), "where it may go it may stay"
    assert begins.kind == "unpowered" and demands.rest_before_first_play_s is not None
    react, cut = demands.cut_off_display_C.react_within_s, demands.cut_off_display_C
    for begun in (UNDER.steady(32.0), UNDER.rested(hot, UNDER.unpowered(), demands.rest_before_first_play_s)):
        for level in STUCK:
            values = UNDER.held(level, begun, np.linspace(0.0, react, 200))
            assert values[skin].min() >= 15.0
            assert values[skin].max() <= 42.0
    for level in (cut.low, cut.high):
        assert UNDER.held(level, UNDER.steady(level), np.zeros(1))[skin].min() >= 15.0
        assert UNDER.held(level, UNDER.steady(level), np.zeros(1))[skin].max() <= 42.0
    assert (demands.polarity_check, demands.zero_current_at_most_s, found.drift_C) == (None, None, None)
    (gentle,) = gate_shown([[course([32, 36, 32], [0, 5, 10])]], THENAR, stuck_C=(20.0, 43.0), pause_s=60.0)
    passed_s = gentle.demands.faults[2].values["passed_s"]
    assert 0.1 < passed_s < 60.0
    assert 0.79 * passed_s < gentle.demands.cut_off_display_C.react_within_s <= 0.8 * passed_s


def test_a_thermode_that_goes_where_it_may_not_stay_is_refused() -> None:
    (found,) = gate_shown([[course([32, 42.2, 32], [0, 1.6, 3.2])]], THENAR, stuck_C=STUCK, pause_s=300.0)
    assert found.colour == "red" and "no cut-off both lets this play pass" in str(found.reason)


@pytest.mark.parametrize(("sink_C", "resistance"), [(48.0, 2.0), (60.0, 0.2)])
def test_a_thermode_is_never_refused_for_the_heat_sink_of_a_rig(sink_C: float, resistance: float) -> None:
    text = "cue 1\nset s { control display\n baseline 32 °C }\nicon a { cool by 4 °C at 2 °C/s\n return at 2 °C/s }\n"
    hot = THENAR.with_(**{"heat_sink.temperature_C": sink_C, "heat_sink.resistance_K_per_W": resistance})
    icon = parse(text)["a"]
    found, plain = (worst_case(deliver(icon, rig, TCS), 60.0) for rig in (hot, THENAR))
    assert (found.colour, found.checks) == ("green", plain.checks)
    assert not any("hot plate" in one.quantity for one in found.checks)


def test_a_lagging_thermode_is_followed_in_both_ways_until_it_has_arrived() -> None:
    text = "cue 1\nset s { control display\n baseline 32 °C }\nicon a { cool by 6 °C at 20 °C/s\n return at 20 °C/s }\n"
    delivery = deliver(parse(text)["a"], THENAR, TCS)
    once, late = ways_of(delivery)
    assert (once.way, late.way) == ("followed at once", "followed with its lag")
    assert late.display_C[-1] == once.display_C[-1]
    assert late.display_C.min() > once.display_C.min() + 0.3
    assert late.end_s == pytest.approx(once.end_s + late.settling_s)
    (found,) = worst_cases([delivery], 30.0)
    assert found.scenarios == 2 * 2 * 5
    rate = next(one for one in found.checks if one.quantity == "rate of skin temperature" and not one.upper)
    assert "followed at once" in rate.scenario
