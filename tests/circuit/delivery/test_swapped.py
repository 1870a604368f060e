"""The test of the polarity on the independent circuit: right wires pass in every corner and from every start."""

import numpy as np
import pytest

from tests.circuit.delivery.faulted import _benches
from tests.circuit.delivery.independent import Array
from tests.circuit.delivery.one_drive import icon_of, prepare
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack


@pytest.mark.slow
@pytest.mark.parametrize(("device", "form_name"), [("dac-16", "csv"), ("closed-loop-controller", "setpoint-csv")])
def test_right_wires_pass_from_every_start_and_swapped_ones_from_none(device: str, form_name: str) -> None:
    form, rng = load_format(form_name), np.random.default_rng(5)
    rig = Rig.load("thenar").with_(**{"driver.update_Hz": 20.0})
    icon = icon_of("warm by 3 °C at 2 °C/s; hold for 1 s; cool by 6 °C at 3 °C/s; return at 2 °C/s")
    ready = prepare(icon, rig, Device.load(device), form)
    assert not ready.refusals
    check, files = ready.verdict.demanded["polarity_check"], pack([ready], form)
    (bench,) = _benches(files, ["a"], [ready.verdict.demanded], rng, 10**6)
    assert len(bench.every) >= 65
    starts, state, now = [bench.unpowered(), bench.rest()], bench.rest(), 0.0
    for time_s in sorted(rng.uniform(0.0, bench.end_s, 8)):
        bench.run(state, now, float(time_s))
        now = float(time_s)
        starts.append(state.copy())

    def falls_K(begun: Array, off_s: float, sign: float) -> Array:
        """By how much the display of each world falls in the test."""
        after = begun.copy()
        bench.off(after, bench.every, off_s)
        before_C = bench.lanes.shown(after)
        bench.lanes.hold(after, bench.every, bench.flow(sign * check["test_current_A"]), check["test_s"])
        return np.asarray(before_C - bench.lanes.shown(after))

    demanded_K = check["display_change_at_least_K"]
    for off_s in (check["off_before_s"], 30.0, 300.0):
        right, swapped = (np.array([falls_K(start, off_s, sign) for start in starts]) for sign in (1.0, -1.0))
        assert demanded_K < right.min() < 2.5 * demanded_K, "half of the least fall is asked for"
        assert swapped.max() < 0.0, "swapped wires warm it"
    at_once_K = min(falls_K(start, 0.0, 1.0).min() for start in starts)
    assert at_once_K < right.min() - 0.2, "what played before warms or cools the display a little longer"
