"""95 % intervals hold the truth in about 95 % of synthetic logs."""

from __future__ import annotations

import numpy as np
import pytest

from thermicon.circuit import Rig, fit
from thermicon.circuit.fitting.laboratory import synthetic_log

from .conftest import TRUTH

LOGS = 200
LEAST, MOST = 0.91, 0.98
"""Of 200 logs, 182 to 196: what 95 % allows within two standard deviations or so."""

RATE_HZ = 10


@pytest.mark.slow
@pytest.mark.parametrize("name", ["thenar", "forearm", "shani2021"])
def test_intervals_hold_the_truth_of_200_logs(name: str) -> None:
    rig = Rig.load(name).with_(**{"driver.update_Hz": RATE_HZ})
    share = np.random.default_rng(0)
    held = dict.fromkeys(TRUTH, 0)
    for seed in range(LOGS):
        # Another truth each time, so that the fit has a way to go.
        truth = {key: _of(rig, key) * float(np.exp(share.normal(0.0, 0.1))) for key in TRUTH}
        log = synthetic_log(rig.with_(**truth), seed=seed, rate_Hz=RATE_HZ, noise_K=0.02)
        found = fit(log, rig, free=list(TRUTH), held=True, fixed_skin=True)
        for key, value in truth.items():
            held[key] += found[key].low <= value <= found[key].high
    shares = {key: count / LOGS for key, count in held.items()}
    assert all(value >= LEAST for value in shares.values()), shares
    # The mesh's error counts as noise in the contact's interval, which is wider for it than these logs need.
    assert all(value <= MOST for key, value in shares.items() if key != "contact.resistance_m2K_per_W"), shares


def _of(rig: Rig, key: str) -> float:
    table, _, name = key.partition(".")
    return float(getattr(getattr(rig, table), name))
