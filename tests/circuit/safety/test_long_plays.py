"""Plays that are not exact maps of their nodes: with very many rows, or on a heat sink with a controller of its own."""

import numpy as np
import pytest

from tests.circuit.surerig import sure_rig
from thermicon.circuit import Drive, Limits, Rig, gate
from thermicon.circuit.safety import playmap
from thermicon.circuit.safety.current import CurrentPlant, CurrentPlay
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.safety.plant import Single
from thermicon.circuit.safety.playmap import PlayMap, UnjudgedError, least_bound, thinned
from thermicon.circuit.safety.repeated import Repeating, shortest_pause_s
from thermicon.circuit.safety.simulated import MOST_STEPS, check_length
from thermicon.circuit.safety.tally import HOTTEST_C
from thermicon.circuit.solver.batch_inputs import State

THENAR, REST = Rig.load("thenar"), 0.08
SINK = {"capacity_J_per_K": 60.0, "kp_W_per_K": 8.0, "ki_W_per_Ks": 1.0, "power_limit_W": 9.0}
WEAK = {"capacity_J_per_K": 20.0, "kp_W_per_K": 2.0, "ki_W_per_Ks": 0.1, "power_limit_W": 1.5}
"""A controller that keeps up with any play, and one that warmings without a pause take to its greatest power."""
COOL = CurrentPlay(Drive([0, 0.5, 2.5, 3.5], [REST, 0.7, REST, REST], held=True), REST)
WARM = CurrentPlay(Drive([0, 1.0, 3.0, 4.0], [REST, -0.4, -0.4, REST]), REST)


def on_sink(**keys: float) -> Rig:
    return THENAR.with_(**{f"heat_sink.{key}": value for key, value in keys.items()})


def few(**sink: float) -> CurrentPlant:
    """The rig as given and corners far apart, with keys of its heat sink."""
    return CurrentPlant.of(Ensemble.of(on_sink(**sink)).only([0, 1, 22, 43, 64]))


def course(update_Hz: float, peak_A: float) -> Drive:
    """One course of the current, by its means in each update: a warming that stays and returns."""
    fine_s, times_s = (np.linspace(0.0, 5.0, round(5.0 * per_s) + 1) for per_s in (1e4, update_Hz))
    charge = np.append(0.0, np.cumsum(np.interp(fine_s[1:], [0, 1, 4, 5], [REST, peak_A, peak_A, REST])) * fine_s[1])
    return Drive(times_s, np.append(np.diff(np.interp(times_s, fine_s, charge)) * update_Hz, REST), held=True)


def simulated(plant: CurrentPlant, play: CurrentPlay, pause_s: float, state: State) -> State:
    """States after a play and its pause, without the plant's map."""
    ended = plant.ensemble.end_of(play.drive, state)
    return ended if pause_s <= 0.0 else plant.ensemble.rest(play.rest_A, ended, pause_s)


@pytest.mark.parametrize(("peak_A", "colour"), [(-0.2, "green"), (-0.5, "red")])
def test_the_same_course_at_50_500_and_5000_updates_a_second_gets_the_same_verdict(peak_A: float, colour: str) -> None:
    limits = Limits.of({"skin_highest_C": 39.6, "skin_highest_soft_C": 39.5})
    drives = [course(update_Hz, peak_A) for update_Hz in (50.0, 500.0, 5000.0)]
    assert len(drives[1].time_s) <= playmap.MOST_ROWS < len(drives[2].time_s), "only the last one is thinned"
    verdicts = [gate(drive, sure_rig(), limits=limits) for drive in drives]
    assert [verdict.colour for verdict in verdicts] == [colour] * 3
    plays = [verdict.repeated for verdict in verdicts]
    assert (plays[0].shortest_pause_s is not None) == (colour == "green")
    pauses = [[one.recovery_s, one.shortest_pause_s or 0.0, one.faultless_pause_s or 0.0] for one in plays]
    assert pauses[1:] == [pytest.approx(pauses[0], rel=0.1)] * 2


def drives_of_many_rows() -> list[Drive]:
    """Sines, square waves of 13 ms and of a bridge at 100 Hz, noise held or linear, and rows of 0.1 to 50 ms."""
    rng, time_s = np.random.default_rng(1), np.arange(0.0, 1.0, 1 / 8300)
    uneven_s = np.append(0.0, np.cumsum(rng.choice([1e-4, 1e-3, 0.05], 200)))
    sine, square = np.sin(2 * np.pi * time_s), np.sign(np.sin(2 * np.pi * time_s / 0.013))
    bridge, noise = np.where(time_s % 0.01 < 0.005, 1.4, 0.0), rng.uniform(-1.2, 1.2, len(time_s))
    held = [Drive(time_s, amperes, held=True) for amperes in (REST + 0.9 * sine, REST + 0.9 * square, bridge, noise)]
    return [*held, Drive(time_s, noise), Drive(uneven_s, rng.uniform(-1.0, 1.2, 201), held=True)]


@pytest.mark.parametrize("drive", drives_of_many_rows())
def test_a_thinned_drive_leads_where_all_its_rows_do(drive: Drive, monkeypatch: pytest.MonkeyPatch) -> None:
    """Within a ten-thousandth of what differs from rest, where steps of 0.1 K count."""
    ensemble = few().ensemble
    start = ensemble.at_rest(REST)
    monkeypatch.setattr(playmap, "MOST_ROWS", 10**6)
    exact = PlayMap.of(ensemble, drive, start)
    monkeypatch.setattr(playmap, "MOST_ROWS", 100)
    thin = PlayMap.of(ensemble, drive, start)
    assert len(thinned(drive).time_s) < len(drive.time_s)
    assert np.abs(thin.matrix - exact.matrix).sum(axis=2).max() < 1e-4
    assert thin.after(start.nodes_C) == pytest.approx(exact.after(start.nodes_C), abs=1e-6), "by every row"
    for side in (1.0, -1.0):
        bounds_C = [least_bound([one], [start.nodes_C[:, :-1]], side) for one in (exact, thin)]
        assert bounds_C[1] == pytest.approx(bounds_C[0], abs=2e-3)


def charge(drive: Drive) -> float:
    return float((np.diff(drive.time_s) * drive.current_A[:-1]).sum())


def test_only_a_drive_of_too_many_rows_is_thinned_and_keeps_its_charge_and_its_long_rows() -> None:
    rows = playmap.MOST_ROWS
    time_s = np.arange(rows + 2) * 1e-3
    exact = Drive(time_s[:-1], np.ones(rows + 1), held=True)
    assert thinned(exact) is exact
    assert len(thinned(Drive(time_s, np.ones(rows + 2), held=True)).time_s) < rows / 9
    uneven_s = np.append(0.0, np.cumsum(np.tile([1e-3] * 30 + [10.0], rows // 30)))
    uneven = Drive(uneven_s, (-1.0) ** np.arange(len(uneven_s)), held=True)
    thin = thinned(uneven)
    long = np.diff(thin.time_s) > 0.02
    assert np.abs(thin.current_A[:-1][long]) == pytest.approx(np.ones(rows // 30)), "what is held for 10 s stays"
    assert charge(thin) == pytest.approx(charge(uneven), abs=1e-6)
    ramp = thinned(Drive(time_s, 0.01 * np.arange(rows + 2)))
    assert charge(ramp) == pytest.approx(0.005e-3 * (rows + 1) ** 2)


def test_a_set_without_a_bound_is_not_judged_and_one_that_heats_is_as_hot_as_can_be() -> None:
    def played(*rows: list[float]) -> PlayMap:
        return PlayMap(np.array([rows]), np.ones((1, 2)))

    start = [np.zeros((1, 2))]
    there, back, less = played([0.0, 2.0], [0.0, 0.0]), played([0.0, 0.0], [2.0, 0.0]), played([0.0, 0.0], [0.4, 0.0])
    assert least_bound([there, less], start, 1.0).max() < 20.0
    with pytest.raises(UnjudgedError, match=r"not judged: no bound was found .* use a longer pause"):
        least_bound([there, back], start, 1.0)
    assert np.isnan(least_bound([played([1.1, 0.0], [0.0, 0.0]), there], start, 1.0)).all()


@pytest.mark.parametrize("pause_s", [0.0, 20.0])
def test_plays_on_a_controlled_heat_sink_have_the_cycle_and_stay_within_the_bounds(pause_s: float) -> None:
    plant, plays = few(**SINK), (COOL, WARM)
    steady = [plant.cycle(play, pause_s) for play in plays]
    state = plant.rest(COOL)
    for _ in range(1200 if pause_s == 0.0 else 300):
        state = simulated(plant, COOL, pause_s, state)
    assert np.abs(steady[0].nodes_C - state.nodes_C).max() < 1e-3
    assert np.abs(steady[0].sink[:, 0] - state.sink[:, 0]).max() < 1e-3
    warm, cold = (plant.bound(plays, pause_s, steady, side).nodes_C for side in (True, False))
    assert 0.0 < cold.min() < warm.max() < 80.0
    for order in ([0] * 19 + [1], [1] * 19 + [0], np.random.default_rng(4).integers(0, 2, 20)):
        state = plant.rest(COOL)
        for k in order:
            state = simulated(plant, plays[k], pause_s, state)
            assert ((cold - 1e-5 <= state.nodes_C) & (state.nodes_C <= warm + 1e-5))[:, 1:].all()
    for play in plays:  # what no order can pass, since no play leads out
        assert (simulated(plant, play, pause_s, State(warm, plant.rest(play).sink)).nodes_C <= warm + 1e-5).all()
        assert (simulated(plant, play, pause_s, State(cold, plant.rest(play).sink)).nodes_C >= cold - 1e-5).all()


@pytest.mark.parametrize("sink", [{}, SINK], ids=["ideal", "controlled"])
def test_what_heats_without_limit_is_as_hot_as_can_be_and_never_beyond_the_coldest(sink: dict[str, float]) -> None:
    plant, play = few(**sink), CurrentPlay(Drive([0, 1], [-6.0, -6.0]), REST)
    cycle = plant.cycle(play, 0.0)
    warm, cold = (plant.bound([play], 0.0, [cycle], side) for side in (True, False))
    for state in (cycle, warm):
        assert (state.nodes_C[:, :-1] == HOTTEST_C).all()
    assert (cold.nodes_C > 0.0).all()


def test_a_cycle_that_plays_do_not_lead_to_is_none() -> None:
    """At −2 A a heat sink of 9 W freezes and the display burns, though a state of −100 °C would return to itself."""
    play = CurrentPlay(Drive([0, 1], [-2.0, -2.0]), REST)
    with pytest.raises(UnjudgedError, match="not judged: no bound was found"):
        few(**SINK).cycle(play, 0.0)
    strong, ideal = (one.cycle(play, 0.0).nodes_C for one in (few(**{**SINK, "power_limit_W": 200.0}), few()))
    assert strong.max(axis=1) == pytest.approx(ideal.max(axis=1), rel=0.01)


def test_plays_that_overcome_their_heat_sink_are_not_judged_and_safe_only_with_a_pause() -> None:
    plant = few(**WEAK)
    with pytest.raises(UnjudgedError, match="not judged: no bound was found"):
        plant.cycle(WARM, 0.0)
    repeating = Repeating(plant, [[WARM]], THENAR.limits)
    assert not repeating.safe(0.0)
    shortest = shortest_pause_s(repeating)
    assert shortest is not None and shortest > 3.0
    assert repeating.safe(shortest)


def test_a_drive_too_long_for_its_controlled_heat_sink_is_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object, **__: object) -> None:
        raise AssertionError("it was simulated")

    monkeypatch.setattr(Single, "of", never)
    rows = np.arange(MOST_STEPS + 2)
    long = Drive(rows * 1e-3, np.full(len(rows), REST), held=True)
    with pytest.raises(
        UnjudgedError, match=r"too long: drive 1 of 1 is 20 s in 20,001 steps; at most 20,000 .* thenar"
    ):
        gate(long, on_sink(**SINK))
    check_length(Ensemble.of(on_sink(**SINK)), [Drive(long.time_s[:-1], long.current_A[:-1], held=True)])
    check_length(Ensemble.of(THENAR), [long])
    passive = THENAR.with_(heat_sink={"temperature_C": 28.0, "capacity_J_per_K": 40.0, "air_resistance_K_per_W": 0.5})
    check_length(Ensemble.of(passive), [long])
