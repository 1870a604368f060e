"""Skin as a sum of modes against the circuit's own stepping, and against what must hold of any skin."""

import numpy as np
import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import parse
from thermicon.perception.experiments.skin_modes import skin_modes

TEXT = """cue 1
set s { control display; baseline 32 °C }
icon a { cool by 5 °C at 5 °C/s; hold for 2 s; return at 4 °C/s }
"""


@pytest.fixture(scope="module")
def played() -> tuple[Rig, object]:
    rig = Rig.load("tcs2")
    (icon,) = parse(TEXT)
    return rig, simulate(icon, rig, rate_Hz=100, tail_s=2.0)


@pytest.mark.parametrize("channel", ["cold", "warm"])
def test_same_display_gives_the_circuits_temperatures(played, channel) -> None:
    rig, trace = played
    modes = skin_modes("tcs2", rig.contact.resistance_m2K_per_W)
    depth = rig.skin.cold_receptor_m if channel == "cold" else rig.skin.warm_receptor_m
    corners = list(zip(trace.time_s[1:].tolist(), (trace.display_C[1:] - trace.display_C[0]).tolist(), strict=True))
    course = modes.course(depth, float(trace.display_C[0]), corners, 0.01, trace.time_s.size)
    np.testing.assert_allclose(course, getattr(trace, f"{channel}_receptor_C"), atol=1e-8)
    flow = modes.course(depth, float(trace.display_C[0]), corners, 0.01, trace.time_s.size, "heat flow")
    # The circuit weighs the two cells around a receptor a little differently.
    circuit = getattr(trace, f"heat_flow_{channel}_receptor_W_per_m2")
    np.testing.assert_allclose(flow, circuit, atol=0.02 * np.ptp(circuit))


def test_steady_state_is_reached() -> None:
    modes = skin_modes("forearm", 2.5e-4)
    late = modes.course(0.15e-3, 32.0, [(1.0, 3.0)], 60.0, 61)
    assert late[-1] == pytest.approx(modes.baseline(35.0, 0.15e-3), abs=1e-6)
    assert late[0] == pytest.approx(modes.baseline(32.0, 0.15e-3), abs=1e-12)


def test_contact_and_effusivity_blunt_a_ramp() -> None:
    reference = float(skin_modes("forearm", 1e-4).ramp_response(0.15e-3, 1.0, 2)[1])
    lighter = float(skin_modes("forearm", 6e-4).ramp_response(0.15e-3, 1.0, 2)[1])
    heavier = float(skin_modes("forearm", 1e-4, effusivity=1.4).ramp_response(0.15e-3, 1.0, 2)[1])
    assert lighter < 0.8 * reference
    assert heavier < 0.98 * reference
