from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from thermicon.perception import Observer
from thermicon.perception.observer.observer import Receptor
from thermicon.perception.observer.parts import EpisodeMemory, Ratings

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FakeTrace:
    """What perception reads of a trace, with receptors that follow the skin at once."""

    icon: str | None
    time_s: Array
    skin_C: Array
    cold_receptor_C: Array
    warm_receptor_C: Array
    site: str = "thenar"
    area_m2: float = 9e-4


Cue = Callable[..., FakeTrace]


@pytest.fixture
def observer() -> Observer:
    """Round numbers of nobody: tests of mathematics must not depend on the calibration."""
    return Observer(
        cold=Receptor(20.0, 0.08, 2.0, 0.7),
        warm=Receptor(14.0, 0.15, 0.5, 0.9),
        integration_s=0.1,
        neutral_low_C=30.0,
        neutral_high_C=36.0,
        a=12.0,
        p=2.0,
        reference_area_m2=9e-4,
        criterion=3.34,
        noise_correlation_s=0.3,
        path_hand_m=0.7,
        path_forearm_m=0.55,
        decision_s=0.2,
        lapse=0.02,
        memory=EpisodeMemory(0.30, 0.5, 3.0, 1.0, Ratings(6.0, 0.5, 40.0, 13.0), Ratings(2.3, 0.7, 27.0, 13.0)),
    )


@pytest.fixture
def cue() -> Cue:
    """Trapezoids about 32 °C: change (K), rate (K/s), hold (s); receptors lag by `lag_s`."""

    def make(
        change: float,
        rate: float = 3.0,
        hold: float = 4.0,
        *,
        name: str = "cue",
        lag_s: float = 0.0,
        end_s: float = 18.0,
    ) -> FakeTrace:
        time = np.arange(round(end_s * 100) + 1) / 100
        ramp = abs(change) / rate

        def skin(t: Array) -> Array:
            corners = [0.0, ramp, ramp + hold, 2 * ramp + hold]
            return np.asarray(32.0 + np.interp(t, corners, [0.0, change, change, 0.0]), dtype=np.float64)

        return FakeTrace(name, time, skin(time), skin(time - lag_s), skin(time - lag_s))

    return make
