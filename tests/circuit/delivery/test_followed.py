"""The controlled module that replays set-points, against exact steps."""

import json

import numpy as np
import pytest

from tests.circuit.delivery.followed import Follower
from thermicon.circuit import Rig

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
