"""Plays of very many rows, whose maps are thinned, and plays without a cycle or a bound."""

import numpy as np
import pytest

from tests.circuit.surerig import sure_rig
from thermicon.circuit import Drive, Limits, Rig, gate
from thermicon.circuit.safety import playmap
from thermicon.circuit.safety.current import CurrentPlant, CurrentPlay
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.safety.playmap import PlayMap, UnjudgedError, least_bound, thinned
from thermicon.circuit.safety.tally import HOTTEST_C

THENAR, REST = Rig.load("thenar"), 0.08


def few() -> CurrentPlant:
    """The rig as given and corners far apart."""
    return CurrentPlant.of(Ensemble.of(THENAR).only([0, 1, 22, 43, 64]))


def course(update_Hz: float, peak_A: float) -> Drive:
    """One course of the current, by its means in each update: a warming that stays and returns."""
    fine_s, times_s = (np.linspace(0.0, 5.0, round(5.0 * per_s) + 1) for per_s in (1e4, update_Hz))
    charge = np.append(0.0, np.cumsum(np.interp(fine_s[1:], [0, 1, 4, 5], [REST, peak_A, peak_A, REST])) * fine_s[1])
    return Drive(times_s, np.append(np.diff(np.interp(times_s, fine_s, charge)) * update_Hz, REST), held=True)


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


def test_what_heats_without_limit_is_as_hot_as_can_be_and_never_beyond_the_coldest() -> None:
    plant, play = few(), CurrentPlay(Drive([0, 1], [-6.0, -6.0]), REST)
    cycle = plant.cycle(play, 0.0)
    warm, cold = (plant.bound([play], 0.0, [cycle], side) for side in (True, False))
    for state in (cycle, warm):
        assert (state.nodes_C[:, :-1] == HOTTEST_C).all()
    assert (cold.nodes_C > 0.0).all()
