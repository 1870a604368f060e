"""Any depth at any instant, and the depth that a probe on insulated skin resembles."""

import numpy as np
import pytest

from thermicon.circuit import Rig, RigError
from thermicon.circuit.studies.depths import probe_depths, resembles
from thermicon.icons import load_library

STEP = load_library("six-icons")["cooling-step"]
THENAR, PAPER = Rig.load("thenar"), Rig.load("shani2021")


@pytest.mark.parametrize("rig", [THENAR, PAPER], ids=lambda rig: rig.name)
def test_a_trace_and_the_same_depths_agree(rig: Rig) -> None:
    seen = probe_depths(STEP, rig, [0.0, rig.skin.cold_receptor_m, rig.skin.warm_receptor_m, rig.skin.thickness_m])
    trace = seen.trace
    temperatures = (trace.skin_C, trace.cold_receptor_C, trace.warm_receptor_C, np.full(801, rig.deep_C))
    flows = (
        trace.heat_flow_skin_W_per_m2,
        trace.heat_flow_cold_receptor_W_per_m2,
        trace.heat_flow_warm_receptor_W_per_m2,
    )
    for k, expected in enumerate(temperatures):
        assert seen.temperature_C[k] == pytest.approx(expected, abs=1e-9)
    for k, expected in enumerate(flows):
        assert seen.heat_flow_W_per_m2[k] == pytest.approx(expected, abs=1e-6)
    assert repr(seen) == f"Depths(4 from 0 to {rig.skin.thickness_m * 1e3:g} mm, 801 rows)"


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


def test_a_depth_outside_the_skin_is_refused() -> None:
    with pytest.raises(RigError, match=r"a depth of 20 mm is not in the skin; it reaches from 0 to 19\.47 mm"):
        probe_depths(STEP, THENAR, [0.02])


def test_closely_joined_skin_resembles_its_own_depth() -> None:
    for depth_mm in (0.4, 1.1, 3.0):
        pad = {"name": "pad", "place": "insulated skin", "lateral_mm": 0.02, "depth_mm": depth_mm}
        like = resembles(STEP, THENAR.with_(probe=[pad]), tail_s=10)
        assert like.depth_m == pytest.approx(depth_mm * 1e-3, rel=0.02)
        assert like.residual_K < 0.02


def test_likeness_is_said_with_its_residual() -> None:
    probes = [{"name": "pad", "place": "insulated skin"}, {"name": "plate", "place": "display"}]
    rig = THENAR.with_(probe=probes)
    assert repr(resembles(STEP, rig)).startswith("Likeness(probe 'pad' is most like 2.")
    assert repr(resembles(STEP, rig)).endswith(" K)")
    assert resembles(STEP, rig, "plate").depth_m == 0.0
    with pytest.raises(RigError, match="rig thenar has no probe 'pat'; it has pad, plate"):
        resembles(STEP, rig, "pat")
    with pytest.raises(RigError, match="rig thenar has no probe on insulated skin; add a "):
        resembles(STEP, THENAR)
