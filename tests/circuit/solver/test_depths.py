"""Temperature and heat flow at any depth at any instant."""

from dataclasses import dataclass

import numpy as np
import pytest

from tests.circuit.solver.watching import watch
from thermicon.circuit import Rig, Trace
from thermicon.circuit.arrays import Array
from thermicon.circuit.solver.inverse import design
from thermicon.circuit.solver.network import flow_weights, places_of, stacked, temperature_weights
from thermicon.icons import Icon, load_library

STEP = load_library("six-icons")["cooling-step"]
THENAR, PAPER = Rig.load("thenar"), Rig.load("shani2021")


@dataclass
class Depths:
    """A run at k depths: temperature in °C and heat flow in W/m² into the skin (k, rows)."""

    temperature_C: Array
    heat_flow_W_per_m2: Array
    trace: Trace


def probe_depths(cue: Icon, rig: Rig, depths_m: list[float], rate_Hz: float = 100.0) -> Depths:
    place, contact = places_of(rig), rig.contact.resistance_m2K_per_W
    at = [contact + rig.skin.resistance_to_m2K_per_W(float(depth)) for depth in depths_m]
    rows = [temperature_weights(here, place) for here in at]
    rows += [
        flow_weights(here if depth > 0 else 0.5 * contact, place) for here, depth in zip(at, depths_m, strict=True)
    ]
    plan = design(cue, rig, 8.0)
    trace, values = watch(plan.drive, rig, stacked(rows), rate_Hz=rate_Hz, start_C=plan.start_C)
    return Depths(values[: len(at)], values[len(at) :], trace)


def test_heat_flow_at_a_lump_is_the_mean_of_its_faces_and_between_lumps_the_faces() -> None:
    k = 20
    lumps = THENAR.column.depth_m
    above, below = (lumps[k - 1] + lumps[k]) / 2, (lumps[k] + lumps[k + 1]) / 2
    flow = probe_depths(STEP, THENAR, [above, lumps[k], below]).heat_flow_W_per_m2
    assert flow[1] == pytest.approx((flow[0] + flow[2]) / 2, abs=1e-9)
    conductivity = 0.45  # the lump lies in the dermis
    temperature = probe_depths(STEP, THENAR, [lumps[k - 1], lumps[k]]).temperature_C
    expected = conductivity * (temperature[0] - temperature[1]) / (lumps[k] - lumps[k - 1])
    assert flow[0] == pytest.approx(expected, abs=1e-6)


def test_heat_is_kept_between_two_depths() -> None:
    # What enters at the surface less what leaves at 1 mm is what the lumps between have stored (and blood has brought).
    rig = THENAR.with_(**{"skin.layer.dermis.perfusion_per_s": 0.0})
    lumps = rig.column.depth_m
    last = int(np.searchsorted(lumps, 1e-3))
    bottom = (lumps[last] + lumps[last + 1]) / 2
    seen = probe_depths(STEP, rig, [0.0, bottom, *lumps[: last + 1]], rate_Hz=2000)
    steps = np.diff(seen.trace.time_s)
    net = seen.heat_flow_W_per_m2[0] - seen.heat_flow_W_per_m2[1]
    kept = float(np.sum(steps * (net[1:] + net[:-1]) / 2))
    change = seen.temperature_C[2:, -1] - seen.temperature_C[2:, 0]
    assert kept == pytest.approx(float(rig.column.capacity_J_per_m2K[: last + 1] @ change), rel=2e-3)
