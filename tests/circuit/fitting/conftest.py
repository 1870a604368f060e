"""A rig with known truth and its logs."""

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.circuit.fitting.log import Log
from thermicon.circuit.fitting.synthetic_log import synthetic_log

TRUTH = {
    "contact.resistance_m2K_per_W": 7e-4,
    "module.seebeck_V_per_K": 0.0505,
    "module.resistance_ohm": 6.6,
}


def altered(log: Log, name: str = "rig.csv", **columns: np.ndarray) -> Log:
    """The same rows with some columns changed or added."""
    return Log.of(name, {"time_s": log.time_s, **dict(log.columns), **columns})


@pytest.fixture(scope="session")
def thenar() -> Rig:
    return Rig.load("thenar").with_(**{"driver.update_Hz": 20})


@pytest.fixture(scope="session")
def true_rig(thenar: Rig) -> Rig:
    return thenar.with_(**TRUTH)


@pytest.fixture(scope="session")
def log(true_rig: Rig) -> Log:
    """A log of display and voltage, 20 rows a second, one for each update of the driver."""
    return synthetic_log(true_rig, seed=3, rate_Hz=20.0)
