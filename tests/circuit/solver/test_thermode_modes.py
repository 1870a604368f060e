"""Skin under a thermode by modes against the circuit's own stepping."""

import numpy as np
import pytest

from thermicon.circuit import Rig, simulate
from thermicon.circuit.solver.modes import thermode_modes
from thermicon.icons import parse

TEXT = """cue 1
set s { control display; baseline 32 °C }
icon a { cool by 5 °C at 5 °C/s; hold for 2 s; return at 4 °C/s }
"""
FOREARM, DEPTH = Rig.load("forearm"), (0.15e-3,)


@pytest.mark.parametrize("place", [0, 1])
def test_same_display_gives_the_circuits_temperatures_and_flows(place: int) -> None:
    rig = Rig.load("tcs2")
    (icon,) = parse(TEXT)
    trace = simulate(icon, rig, rate_Hz=100, tail_s=2.0)
    depths = rig.skin.cold_receptor_m, rig.skin.warm_receptor_m
    skin = thermode_modes(rig, depths, rig.contact.resistance_m2K_per_W)
    kinks = np.diff(trace.display_C, 2, prepend=2 * trace.display_C[0] - trace.display_C[1]) / 0.01
    kinks[0] = (trace.display_C[1] - trace.display_C[0]) / 0.01
    channel = ("cold", "warm")[place]
    for column, row, near in (("{}_receptor_C", 0, 1e-8), ("heat_flow_{}_receptor_W_per_m2", 2, 0.02)):
        rise = skin.rise(row + place, 0.01, trace.time_s.size)
        course = skin.rest(row + place, 32.0) + np.convolve(kinks, rise)[: trace.time_s.size - 1]
        circuit = getattr(trace, column.format(channel))[:-1]
        # The circuit weighs the two cells around a receptor a little differently.
        np.testing.assert_allclose(course, circuit, atol=near if row == 0 else near * np.ptp(circuit))


def test_a_reading_moves_with_its_depth_and_comes_to_rest() -> None:
    row = 1
    flows = [thermode_modes(FOREARM, (d * 1e-6,), 2.5e-4).rise(row, 0.5, 3)[2] for d in range(120, 180)]
    assert np.abs(np.diff(flows, 2)).max() < 0.02 * abs(flows[-1] - flows[0])
    skin = thermode_modes(FOREARM, DEPTH, 2.5e-4)
    late = skin.rise(0, 60.0, 61)
    assert late[-1] - late[-2] == pytest.approx(60.0 * (skin.rest(0, 33.0) - skin.rest(0, 32.0)))


def test_contact_and_effusivity_blunt_a_ramp() -> None:
    met = (1e-4, 1.0), (6e-4, 1.0), (1e-4, 1.4)
    reference, lighter, heavier = (thermode_modes(FOREARM, DEPTH, *how).rise(0, 1.0, 2)[1] for how in met)
    assert lighter < 0.8 * reference
    assert heavier < 0.98 * reference
