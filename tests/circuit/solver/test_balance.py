"""Invariants of every run on any mesh.

Energy closes to rounding because the trapezoidal rule is the midpoint rule: over a step, every flow is that of the mean
of the states at both ends. So with a row at each step the balance needs no integration of its own.
"""

from functools import cache

import numpy as np
import pytest

from tests.circuit.solver.watching import watch
from tests.peltier import heat_absorbed_W, heat_rejected_W
from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.solver.network import COLD, HOT, SKIN, network_of

PERFUSED, PRINTED = Rig.load("thenar"), Rig.load("shani2021")
RIGS = [PERFUSED, PRINTED]
SLOPES = Drive([0, 0.5, 1.0, 2.0, 2.5], [0.2, 0.2, 1.1, -0.5, -0.5])
JUMPS = Drive([0, 0.5, 1.0, 2.0, 2.5], [0.2, 1.1, -0.5, 0.3, 0.3], held=True)


def energies(drive: Drive, rig: Rig, rate_Hz: float, begin: int = 0) -> dict[str, np.ndarray]:
    """What flowed and what was stored in each step, in J, from row `begin`."""
    network, module, area = network_of(rig), rig.module, rig.contact.area_m2
    last = len(network.capacity_J_per_K) + SKIN  # the deep node
    start = np.minimum(np.arange(last + 1), last - 2)
    trace, state = watch(drive, rig, (start, np.eye(3)[np.arange(last + 1) - start]), rate_Hz=rate_Hz)
    state, current, time = state[:, begin:], trace.current_A[begin:], trace.time_s[begin:]
    step, change, mean = np.diff(time), np.diff(state, axis=1), (state[:, 1:] + state[:, :-1]) / 2
    first, second = current[:-1], current[:-1] if drive.held else current[1:]
    amperes, square = (first + second) / 2, (first**2 + first * second + second**2) / 3
    blood = network.deep_C
    joule = (square - amperes**2) * module.resistance_ohm  # of the mean of I², beside the square of its mean
    flow = trace.heat_flow_skin_W_per_m2[begin:]
    return {
        "surface": area * (flow[1:] + flow[:-1]) / 2 * step,
        "deep": network.conductance_W_per_K[-1] * (mean[-2] - blood) * step,
        "perfusion": network.perfusion_W_per_K @ (blood - mean[SKIN:-1]) * step,
        "absorbed": (heat_absorbed_W(module, amperes, mean[COLD], mean[HOT]) - joule / 2) * step,
        "rejected": (heat_rejected_W(module, amperes, mean[COLD], mean[HOT]) + joule / 2) * step,
        "electrical": (module.voltage_V(amperes, mean[COLD], mean[HOT]) * amperes + joule) * step,
        "sink": (mean[HOT] - rig.heat_sink.temperature_C) / rig.heat_sink.resistance_K_per_W * step,
        "hot plate": module.hot_plate_J_per_K * change[HOT],
        "cold plate": module.cold_plate_J_per_K * change[COLD],
        "skin": network.capacity_J_per_K @ change[SKIN:-1],
    }


@pytest.mark.parametrize(
    ("drive", "rate_Hz", "begin"),
    [
        (SLOPES, 4000, 0),  # the shortest step, 0.25 ms, from the first row on
        (JUMPS, 4000, 0),
        (SLOPES, 100, 10),  # the longest, once 0.1 s of rest has let the steps grow to 10 ms
    ],
    ids=["slopes, 0.25 ms", "jumps, 0.25 ms", "slopes, 10 ms"],
)
@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
def test_energy_closes(rig: Rig, drive: Drive, rate_Hz: float, begin: int) -> None:
    assert rig.heat_sink.passive is None  # an ideal sink: what it takes is known from the hot plate
    joules = energies(drive, rig, rate_Hz, begin)
    assert rig is PRINTED or np.abs(joules["perfusion"]).sum() > 0.01
    balances = {
        "skin": joules["surface"] - joules["deep"] + joules["perfusion"] - joules["skin"],
        "cold plate": -joules["surface"] - joules["absorbed"] - joules["cold plate"],
        "hot plate": joules["rejected"] - joules["sink"] - joules["hot plate"],
        "module": joules["electrical"] + joules["absorbed"] - joules["rejected"],
        "all": joules["electrical"] - joules["sink"] - joules["deep"] + joules["perfusion"]
        - joules["skin"] - joules["cold plate"] - joules["hot plate"],
    }  # fmt: skip
    moved = np.abs(joules["surface"]).sum()  # the smallest of the large flows: a strict measure
    assert moved > 0.5
    for name, left in balances.items():
        assert abs(left.sum()) < 1e-9 * moved, name
        assert np.abs(left).sum() < 1e-8 * moved, name  # nor does one step make up for another


@pytest.mark.parametrize("drive", [SLOPES, JUMPS], ids=["slopes", "jumps"])
@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
def test_electrical_power_is_heat_rejected_less_heat_absorbed_in_every_row(rig: Rig, drive: Drive) -> None:
    trace, module = simulate_current(drive, rig), rig.module
    plates = trace.current_A, trace.display_C, trace.hot_plate_C
    power = trace.voltage_V * trace.current_A
    assert np.ptp(power) > 3.0
    assert heat_rejected_W(module, *plates) - heat_absorbed_W(module, *plates) == pytest.approx(power, abs=1e-12)


RATES_HZ = (100, 200, 400)
PLACES = ("display_C", "skin_C", "cold_receptor_C", "warm_receptor_C", "heat_flow_warm_receptor_W_per_m2")
TIMES = np.linspace(0, 8, 9)
DRIVES = {
    "corners in rows": Drive(TIMES, 0.1 + 0.6 * np.sin(TIMES / 8 * np.pi) ** 2),
    "corners between rows": Drive([0, 1.0037, 2.3019, 4.00713, 6.5553, 8], [0.1, 0.1, 0.9, 0.3, -0.2, 0.1]),
}


@cache
def errors(rig: Rig, drive: str) -> dict[str, np.ndarray]:
    """Largest differences at the rows of 100 Hz to steps of 1/6400 s, a place each; the rows set the steps."""
    fine = simulate_current(DRIVES[drive], rig, rate_Hz=6400)
    runs = [simulate_current(DRIVES[drive], rig, rate_Hz=rate) for rate in RATES_HZ]
    return {
        place: np.array(
            [
                np.abs(getattr(run, place)[:: rate // 100] - getattr(fine, place)[::64]).max()
                for run, rate in zip(runs, RATES_HZ, strict=True)
            ]
        )
        for place in PLACES
    }


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
def test_second_order_in_time(rig: Rig, drive: str, place: str) -> None:
    found = errors(rig, drive)[place]
    assert np.log2(found[:-1] / found[1:]) == pytest.approx([2.0, 2.0], abs=0.1), found
    assert place.endswith("m2") or found[0] < 2e-5
