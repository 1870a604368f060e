"""Corners of a rig's uncertainty, and rows at which a drive is watched."""

from __future__ import annotations

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig
from thermicon.circuit.safety.corners import corners_of, passes_most_cooling
from thermicon.circuit.safety.ensemble import Ensemble, row_of

THENAR = Rig.load("thenar")
WEAK = Rig.load("fingertip").with_(
    **{
        "heat_sink.temperature_C": 41.35, "heat_sink.resistance_K_per_W": 0.4163, "module.cold_plate_J_per_K": 7.397,
        "module.hot_plate_J_per_K": 2.077, "module.seebeck_V_per_K": 0.03122, "contact.area_cm2": 13.16,
        "contact.resistance_m2K_per_W": 0.00172, "driver.current_limit_A": 1.704, "skin.elements": [1, 1, 1, 1, 1],
    }
)  # fmt: skip


def test_a_shipped_driver_stays_below_the_current_of_most_cooling() -> None:
    assert not passes_most_cooling(THENAR)
    assert {corner.gain_relative for corner in corners_of(THENAR)} == {-0.1, 0.0, 0.1}
    assert len(corners_of(THENAR)) == 65


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
