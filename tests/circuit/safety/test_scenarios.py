"""Corners of a rig or endings of a cue, against independent solvers or closed forms."""

import numpy as np
import pytest

from tests.circuit.safety.futures import play_out
from tests.circuit.solver.watching import watch
from tests.circuit.surerig import CERTAIN, sure_rig
from thermicon.circuit import Drive, Rig, gate, simulate_current
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.safety.corners import corners_of, passes_most_cooling
from thermicon.circuit.safety.current import ENDINGS
from thermicon.circuit.safety.ensemble import Ensemble, row_of, switching
from thermicon.circuit.safety.tally import WATCHED
from thermicon.circuit.solver.drive import DriveError, switched
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current, steady_of

THENAR = Rig.load("thenar")
WEAK = Rig.load("fingertip").with_(
    **{
        "heat_sink.temperature_C": 41.35, "heat_sink.resistance_K_per_W": 0.4163, "module.cold_plate_J_per_K": 7.397,
        "module.hot_plate_J_per_K": 2.077, "module.seebeck_V_per_K": 0.03122, "contact.area_cm2": 13.16,
        "contact.resistance_m2K_per_W": 0.00172, "driver.current_limit_A": 1.704, "skin.elements": [1, 1, 1, 1, 1],
    }
)  # fmt: skip


def test_where_more_current_cools_less_gains_in_between_are_corners() -> None:
    assert passes_most_cooling(WEAK)
    assert {round(corner.gain_relative, 3) for corner in corners_of(WEAK)} == {-0.1, -0.05, 0.0, 0.05, 0.1}
    ensemble = Ensemble.of(WEAK)
    lowest = {}
    for (_, values), _ in ensemble.play(Drive([0.0, 60.0], [1.45, 1.45]), ensemble.at_rest(0.15)):
        for corner, skin in zip(ensemble.corners, values[0], strict=True):
            lowest[round(corner.gain_relative, 3)] = min(lowest.get(round(corner.gain_relative, 3), 99.0), skin.min())
    assert min(lowest, key=lambda gain: lowest[gain]) not in (-0.1, 0.1), "neither end of the gain is the coldest"


@pytest.mark.parametrize(("update_s", "row_s"), [(0.01, 0.01), (0.010048, 0.005024), (0.001, 0.001), (0.035, 0.00875)])
def test_rows_are_in_step_with_the_updates(update_s: float, row_s: float) -> None:
    times = np.arange(20) * update_s
    assert row_of(Drive(times, np.zeros(20), held=True)) == pytest.approx(row_s)


CUE = Drive([0, 1, 1.5, 4, 5], [0.1, 0.5, 1.2, -0.4, 0.2], held=True)
WITHIN_K = 1e-3
"""A block of lanes may take shorter steps than one lane alone."""


def test_corners_are_those_of_the_box() -> None:
    corners = corners_of(THENAR)
    assert len(corners) == 65 and not passes_most_cooling(THENAR)
    assert {corner.gain_relative for corner in corners} == {-0.1, 0.0, 0.1}
    assert str(corners[-1]) == (
        "contact +30 %, ambient −3 K, gain +10 %, heat sink +1 K, Seebeck +5 %, conductance +10 %, plates +20 %"
    )
    last = corners[-1].rig
    assert last.contact.resistance_m2K_per_W == pytest.approx(1.3 * 5.4e-4)
    assert (last.ambient.temperature_C, last.heat_sink.temperature_C, last.skin.rest_C) == (21.0, 41.0, 32.0)
    assert last.deep_C == pytest.approx(THENAR.deep_C + 0.97, abs=0.01), "a cooler room takes warmer blood to rest"
    assert last.module.seebeck_V_per_K == pytest.approx(1.05 * 0.0521)
    assert last.module.thermal_resistance_K_per_W == pytest.approx(6.56 / 1.1)
    assert last.module.cold_plate_J_per_K == pytest.approx(1.2 * 2.6)
    assert [str(corner) for corner in corners_of(sure_rig())] == ["the rig as given"]
    one = THENAR.with_(**CERTAIN | {"uncertainty.gain_relative": 0.1})
    assert [str(corner) for corner in corners_of(one)] == ["the rig as given", "gain −10 %", "gain +10 %"]


@pytest.mark.parametrize("held", [True, False])
def test_every_lane_is_the_run_of_its_rig(held: bool) -> None:
    drive = Drive(CUE.time_s, CUE.current_A, held)
    rig = sure_rig("thenar", "contact_resistance_relative", "ambient_K", "gain_relative", "plates_relative")
    found = play_out(drive, rig, rest_A=0.05)
    assert found.values.shape == (4, 3, 17, len(found.time_s))
    for c, corner in enumerate(found.corners):
        gain = 1.0 + corner.gain_relative
        start = state_under_current(network_of(corner.rig), 0.05 * gain)
        for e, last in enumerate((drive.current_A[-1], 0.0)):
            times = np.concatenate([drive.time_s, [drive.time_s[-1] + 1e-6, drive.time_s[-1] + 60]])
            whole = Drive(times, gain * np.concatenate([drive.current_A, [last, last]]), held)
            alone = simulate_current(whole, corner.rig, start_C=start)
            for w, name in enumerate(WATCHED):
                theirs = np.interp(found.time_s, alone.time_s, getattr(alone, name))
                assert np.abs(found.values[w, e, c] - theirs).max() < 3e-3, (name, str(corner), ENDINGS[e])


def run_to_the_end(rig: Rig, start: np.ndarray) -> np.ndarray:
    """State at the end of CUE, read through all states one by one."""
    starts = np.minimum(np.arange(len(start)), len(start) - 3)  # three weights a reading: near the end they look back
    weights = np.zeros((len(start), 3))
    weights[np.arange(len(start)), np.arange(len(start)) - starts] = 1.0
    return watch(CUE, rig, (starts, weights))[1][:, -1]


@pytest.mark.slow
def test_a_bridge_goes_on_switching_where_its_last_value_is_held() -> None:
    peak, duty, rate = 1.5, 0.3, 100.0
    short, long_ = (switched(np.full(round(s * rate) + 1, duty), rate, 500.0, peak) for s in (1, 61))
    found = play_out(short, THENAR, rest_A=duty * peak, bridge_A=peak)
    alone = simulate_current(long_, THENAR, start_C=steady_of(THENAR, duty, peak))
    ours = found.values[:, 0, 0]
    for place, name in enumerate(WATCHED):
        theirs = np.interp(found.time_s, alone.time_s, getattr(alone, name))
        assert np.abs(ours[place] - theirs).max() < 0.06, name
        assert ours[place, -1] == pytest.approx(theirs[-1], abs=0.02), name
    smooth = play_out(short, THENAR, rest_A=duty * peak).values[:, 0, 0, -1]
    assert np.abs(smooth - ours[:, -1]).max() > 1.0, "without its heat a bridge would be misjudged by kelvins"


def test_a_rest_that_cannot_be_is_refused() -> None:
    with pytest.raises(DriveError, match="a rest of nan A is not possible; it must be a finite current"):
        gate(CUE, THENAR, rest_A=float("nan"))
    with pytest.raises(DriveError, match=r"a rest of 2 A is not possible; .* of at most 1\.5 A"):
        gate(CUE, THENAR, rest_A=2.0, bridge_A=1.5)
    with pytest.raises(DriveError, match="the mean current of rest is needed where a bridge switches; give rest_A"):
        gate(CUE, THENAR, bridge_A=1.5)
    with pytest.raises(DriveError, match=r"a bridge of 0 A is not possible"):
        gate(CUE, THENAR, rest_A=0.0, bridge_A=0.0)
    with pytest.raises(RigError, match=r"rig thenar: -9 A has no steady state on this rig"):
        gate(CUE, THENAR, rest_A=-9.0)


def test_what_stands_for_a_bridge_has_its_mean_and_its_heat() -> None:
    """A bridge that is on for a share s of the time with a peak p has the mean s·p and heats with s·p²."""
    shares, peak = np.array([[-0.4], [0.0], [0.1], [1.0]]), np.array([1.5])
    begin, end = switching(shares * peak, peak)
    assert 0.5 * (begin + end) == pytest.approx(shares * peak)
    assert (begin**2 + begin * end + end**2) / 3.0 == pytest.approx(np.abs(shares) * peak**2)
    begin, end = switching(np.full((4, 1), 0.3), peak)
    assert begin[1:] == pytest.approx(end[:-1]), "no jump where the mean stays"
