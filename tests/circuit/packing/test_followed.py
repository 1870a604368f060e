"""The controller and the module that replay set-points: against exact steps, and against what the gate says."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from tests.circuit.packing.exported_files import read_file, sidecar_in
from tests.circuit.packing.followed import Follower, followed
from tests.circuit.packing.replay import RATE_K_PER_S, Worst
from thermicon.circuit import Device, Rig, prepare
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.packing.pack import pack
from thermicon.icons import parse

SMALL = Rig.load("thenar").with_(**{
    "skin.elements": [1] * 5, "driver.update_Hz": 20.0, "module.hot_plate_J_per_K": 1.5,
    "module.cold_plate_J_per_K": 1.5, "driver.current_limit_A": 0.7,
})  # fmt: skip


def follower() -> Follower:
    return Follower(json.loads(SMALL.document), np.random.default_rng(1))


def test_an_update_is_an_exact_step_of_the_circuit() -> None:
    module = follower()
    state = module.rest(32.0)
    assert module.circuit.read(state[:, :, None])[:, 2, 0] == pytest.approx(np.full(len(state), 32.0), abs=1e-6)
    amperes = np.linspace(-0.9, 0.9, len(state))
    *_, last = module.update(amperes, state)
    move, add = module.modes(amperes).step(module.period_s)
    assert last == pytest.approx((move @ state[:, :, None] + add)[:, :, 0], abs=2e-4)


def test_the_display_is_at_its_set_point_at_the_end_of_an_update() -> None:
    module = follower()
    state = module.rest(32.0)
    for level in (32.05, 31.97, 32.0):
        rows, state = module.follow(np.array([level]), state)
        assert rows[-1, :, 2] == pytest.approx(np.full(len(state), level), abs=1e-4)
    rows, _ = module.follow(np.array([40.0]), state)
    assert rows[-1, :, 2].max() < 34.0, "at the driver's limit it takes longer"


@pytest.mark.parametrize(
    ("shape", "pause_s"),
    [
        ("step warm by 1 °C; hold for 1 s; step cool by 2 °C; hold for 1 s", 0.0),
        ("step cool by 4 °C; hold for 1 s", 15.0),
        ("step warm by 2 °C; hold for 2 s; return at 2 °C/s", 5.0),
    ],
)
def test_the_fastest_skin_is_that_of_the_gate(shape: str, pause_s: float) -> None:
    """In a second play at once, on the return after the last set-point, and in the play itself."""
    icon = parse(f"cue 1\nset s {{ control display\n baseline 32 °C }}\nicon a {{ {shape} }}")["a"]
    form = load_format("setpoint-csv")
    ready = prepare(icon, SMALL, Device.load("closed-loop-controller"), form, pause_s=pause_s)
    files = pack([replace(ready, refusals=())], form)
    rig, course = sidecar_in(files, "a")["rig"]["document"], read_file(files, "a")
    worst = followed(rig, course, [pause_s], np.random.default_rng(1), Worst())
    assert ready.verdict.colour != "red", "a play that is refused by itself is not judged in sequences"
    rates = [abs(check.value) for check in ready.verdict.checks if check.quantity == "rate of skin temperature"]
    assert (1 + worst.beyond["rate"]) * RATE_K_PER_S == pytest.approx(max(rates), rel=2e-3)


def test_the_hottest_plate_is_that_of_the_gate_where_a_loop_passes_the_most_cooling() -> None:
    rig = Rig.load("thenar").with_(**{
        "skin.elements": [1] * 5, "heat_sink.resistance_K_per_W": 0.6081, "module.cold_plate_J_per_K": 7.119,
        "module.hot_plate_J_per_K": 5.684, "contact.area_cm2": 4.871, "contact.resistance_m2K_per_W": 0.002575,
        "driver.current_limit_A": 1.819, "driver.update_Hz": 10.0,
    })  # fmt: skip
    text = "warm by 3.53 °C at 9.98 °C/s; hold for 2.51 s; return at 3.15 °C/s"
    icon = parse(f"cue 1\nset s {{ control skin\n baseline 31.7 °C }}\nicon a {{ {text} }}")["a"]
    form = load_format("setpoint-csv")
    ready = prepare(icon, rig, Device.load("closed-loop-controller"), form, pause_s=4.9)
    hottest = max(check.value for check in ready.verdict.checks if check.quantity == "hot plate")
    files = pack([replace(ready, refusals=())], form)
    rig_text, course = sidecar_in(files, "a")["rig"]["document"], read_file(files, "a")
    worst = followed(rig_text, course, [4.9], np.random.default_rng(1), Worst())
    assert worst.beyond["hot plate high"] == pytest.approx(0.26, abs=0.1), "in a second play, and in no first one"
    assert hottest - 60.0 == pytest.approx(worst.beyond["hot plate high"], abs=0.03)
    assert ready.verdict.colour == "red"
