"""The controlled module that replays set-points, against exact steps or the gate."""

import json
from typing import Any

import numpy as np
import pytest

from tests.circuit.delivery.followed import Follower
from tests.circuit.delivery.one_drive import icon_of, prepare
from tests.circuit.delivery.replay import RATE_K_PER_S, Worst
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format

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


def test_a_relay_between_the_cut_offs_moves_skin_as_fast_as_the_gate_allows_any_loop() -> None:
    """At the demanded limits, in the independent circuit; without them, as its file says, much faster."""
    icon = icon_of("warm by 2 °C at 1 °C/s")
    rig = SMALL.with_(**{"driver.current_limit_A": 1.5, "driver.voltage_limit_V": 60.0})
    verdict = prepare(icon, rig, Device.load("closed-loop-controller"), load_format("setpoint-csv")).verdict
    assert verdict.colour != "red", verdict.reason
    demands: dict[str, Any] = verdict.demanded
    cut, module = demands["cut_off_display_C"], Follower(json.loads(rig.document), np.random.default_rng(1))
    levels = np.repeat([cut["low"], cut["high"]] * 4, [60, 60, 20, 20, 6, 6, 2, 2])

    def fastest() -> float:
        worst = Worst()
        rows, _ = module.follow(levels, module.rest(cut["high"]))
        worst.rates(rows, np.full(len(rows) - 1, module.row_s))
        return float((1 + worst.beyond["rate"]) * RATE_K_PER_S)

    assert fastest() > 15.0
    module.least_A, module.most_A = (limit * module.circuit.gain for limit in demands["current_limit_A"])
    assert 6.0 < fastest() < RATE_K_PER_S
