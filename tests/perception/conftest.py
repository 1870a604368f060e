from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from thermicon.circuit import Trace
from thermicon.perception import Observer
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.mechanisms.bounds import NO_LIMIT_C

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
    rig: None = None
    control: str = "skin"

    @property
    def target_C(self) -> Array:
        """It is reached at once."""
        return self.skin_C

    def but(self, **changes: object) -> "FakeTrace":
        """As `dataclasses.replace`."""
        return FakeTrace(**vars(self) | changes)

    __class__ = property(lambda self: Trace)  # type: ignore[assignment]  # passes for one where its type is checked


Cue = Callable[..., FakeTrace]


@pytest.fixture
def observer() -> Observer:
    """Round numbers of nobody: tests of mathematics must not depend on the calibration."""
    return replace(
        Observer.load(),
        limit_C=NO_LIMIT_C,
        adaptation_s=20.0,
        threshold_drive=Both(0.08, 0.15),
        velocity_m_per_s=Both(2.0, 0.5),
        area_exponent=Both(0.7, 0.9),
        forearm_factor=Both(1.0, 1.0),
        softness_K=0.5,
        integration_s=0.1,
        a=12.0,
        p=2.0,
        gain_noise=0.0,
        criterion=3.34,
        noise_correlation_s=0.3,
        decision_s=0.2,
        choice_s=0.0,
        decision_noise=0.0,
        timing_noise=0.30,
        rating_at_threshold=Both(6.0, 2.3),
        rating_exponent=Both(0.5, 0.7),
        mean_rating=Both(40.0, 27.0),
        rating_scatter=13.0,
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
