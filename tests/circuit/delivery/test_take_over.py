"""A display that was without power is taken over by loops on the independent circuit: no cut-off acts on its way."""

import numpy as np
import pytest

from tests.circuit.delivery.benches import Bench
from tests.circuit.delivery.faulted import _benches
from tests.circuit.delivery.independent import Json
from tests.circuit.delivery.lanes import LONGEST, RATE
from tests.circuit.delivery.one_drive import icon_of, prepare
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack

SMALL = {"driver.update_Hz": 20.0, "skin.elements": [1] * 5}
WARM, COOL = "warm by 6.67 °C at 6.24 °C/s; hold for 1.27 s", "cool by 5 °C at 3 °C/s; hold for 1 s; return at 3 °C/s"


def exported(name: str, changes: dict[str, float], shape: str, baseline_C: str) -> tuple[Bench, Json]:
    """The loops of an export in all worlds of its rig, and its demands."""
    form, rig = load_format("setpoint-csv"), Rig.load(name).with_(**SMALL | changes)
    ready = prepare(icon_of(shape, "display", baseline_C), rig, Device.load("closed-loop-controller"), form)
    assert not ready.refusals
    demands = ready.verdict.demanded
    (bench,) = _benches(pack([ready], form), ["a"], [demands], np.random.default_rng(0), 10**6)
    return bench, demands


@pytest.mark.parametrize(
    ("name", "changes", "shape", "baseline_C"),
    [("hand-dorsum", {}, WARM, "29"), ("thenar", {"heat_sink.temperature_C": 24.0}, COOL, "33")],
    ids=["from a warm sink", "from a cold sink"],
)
def test_no_cut_off_acts_where_an_integral_was_held_at_its_limit(
    name: str, changes: dict[str, float], shape: str, baseline_C: str
) -> None:
    """Controllers whose integral stays at the limit of current take the display a few kelvin beyond its baseline."""
    bench, demands = exported(name, changes, shape, baseline_C)
    cut, held, loop = (demands[key] for key in ("cut_off_display_C", "held_cut_off_display_C", "loop"))
    wrong_K, passed_C = loop["sensor_offset_at_most_K"], []
    for kp in loop["kp_A_per_K"]:
        for ki in loop["ki_A_per_Ks"]:
            for offset_K in (-wrong_K, wrong_K):
                bench.loop[:, [0, 1, 3]] = kp, ki, offset_K
                state = bench.unpowered()
                far = bench.wait(state, 60.0)
                assert cut["low"] + wrong_K < far[:, 4].min() and far[:, 5].max() < cut["high"] - wrong_K
                assert held is None or state[:, LONGEST].max() < held["longer_than_s"]
                passed_C.append(far[:, 4].min() if shape is WARM else far[:, 5].max())
    assert max(abs(float(baseline_C) - at_C) for at_C in passed_C) > 1.3 + wrong_K, (
        "a cut-off beside the plays would act"
    )


def test_a_driver_stuck_at_its_limit_from_a_cut_off_keeps_the_rate() -> None:
    changes = {
        "driver.update_Hz": 10.0, "driver.current_limit_A": 1.668, "heat_sink.temperature_C": 33.94,
        "heat_sink.resistance_K_per_W": 0.4542, "module.cold_plate_J_per_K": 2.054, "module.hot_plate_J_per_K": 2.098,
        "module.seebeck_V_per_K": 0.05852, "contact.area_cm2": 4.662, "contact.resistance_m2K_per_W": 0.001064,
    }  # fmt: skip
    shape = "warm by 1.457 °C at 4.139 °C/s; hold for 1.256 s; return at 3.17 °C/s"
    bench, demands = exported("thenar", changes, shape, "32.7")
    flows = bench.settling(demands["cut_off_display_C"]["low"])

    def fastest(limit_A: float) -> float:
        state = bench.lanes.steady(flows, flows**2)
        return float(bench.lanes.hold(state, bench.every, bench.flow(limit_A), 1.0)[:, RATE].max())

    limit_A = demands["current_limit_A"][0]
    assert fastest(limit_A) < 10.0 < fastest(1.2 * limit_A)


def test_wires_swapped_in_mid_play_pass_no_temperature_where_limits_are_unlike_and_their_rate_is_told() -> None:
    shape = "cool by 2.333 °C at 4.944 °C/s; hold for 1.678 s; return at 2.925 °C/s"
    bench, demands = exported("fingertip", {}, shape, "32.9")
    least_A, most_A = demands["current_limit_A"]
    assert -least_A < most_A
    (told,) = (fault for fault in demands["faults"] if fault["fault"].startswith("wires swapped in mid-play"))
    cut = demands["cut_off_display_C"]
    flows = bench.settling(cut["high"] + demands["loop"]["sensor_offset_at_most_K"])
    far = bench.lanes.hold(bench.lanes.steady(flows, flows**2), bench.every, bench.flow(-most_A), cut["react_within_s"])
    assert far[:, 5].max() < 45.0, "the hard limit of a display"
    said = float(told["text"].removeprefix("the skin moves by up to ").removesuffix(" K/s"))
    assert 10.0 < far[:, RATE].max() < said
