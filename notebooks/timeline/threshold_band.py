"""Detection threshold at d′ = 1, as the change of temperature at receptor depth."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from thermicon.perception import Observer
from thermicon.perception.observer.observer import CHANNELS, Channel, load_thresholds
from thermicon.perception.sensation.sensation import receptor_drive

if TYPE_CHECKING:
    from thermicon.circuit import Trace

DT_S = 0.01
SMALLEST_K, LARGEST_K = 1e-3, 12.0
CLOSE = 1e-4


@dataclass(frozen=True, slots=True)
class ThresholdBand:
    """Temperatures within ``change_K`` of the level (°C) that a channel is adapted to, which are below its threshold.

    The cold channel responds to falls, the warm one to rises, so each band is on one side of its level.
    """

    channel: Channel
    level_C: float
    change_K: float

    @property
    def low_C(self) -> float:
        """Lower end, °C."""
        return self.level_C - self.change_K if self.channel == "cold" else self.level_C

    @property
    def high_C(self) -> float:
        """Upper end, °C."""
        return self.level_C if self.channel == "cold" else self.level_C + self.change_K


def threshold_bands(trace: Trace, observer: Observer) -> tuple[ThresholdBand, ...]:
    """Return the bands of both channels at the initial temperatures of a trace; none for a heat-flow observer.

    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> trace = simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"))
    >>> [f"{band.channel} {band.change_K:.2f} K" for band in threshold_bands(trace, Observer.load())]
    ['cold 0.06 K', 'warm 0.09 K']
    """
    if observer.drive_unit != "K":
        return ()
    starts = (trace.cold_receptor_C, trace.warm_receptor_C)
    return tuple(
        ThresholdBand(
            channel, float(start[0]), threshold_change_K(observer, channel, trace.area_m2, trace.site, float(start[0]))
        )
        for channel, start in zip(CHANNELS, starts, strict=True)
    )


@lru_cache(maxsize=256)
def threshold_change_K(observer: Observer, channel: Channel, area_m2: float, site: str, level_C: float) -> float:
    """Size (K) of the ramp at receptor depth with d′ = 1, for an observer adapted to the level (°C) it starts from.

    The ramp has the rate and hold of the published threshold step; thresholds depend on area and site as everywhere
    else, and on the level: warm skin must cool further before it is cold. LARGEST_K where no ramp does.
    """
    from thermicon.perception.sensation.sensation import sensitivity

    known = load_thresholds()
    rate, held = known.one("rate of the threshold step").central, known.one("duration of the threshold step").central
    wanted = observer.receptor(channel).threshold_drive / sensitivity(channel, observer, area_m2, site)
    sign = -1.0 if channel == "cold" else 1.0
    low, high = SMALLEST_K, LARGEST_K
    while high > low * (1.0 + CLOSE):
        size = (low * high) ** 0.5
        time = np.arange(0.0, size / rate + held, DT_S)
        drive = receptor_drive(level_C + sign * np.minimum(rate * time, size), DT_S, channel, observer)
        low, high = (low, size) if float(drive.max()) >= wanted else (size, high)
    return high
