"""Detection threshold at d′ = 1, as the change of temperature at receptor depth."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from thermicon.perception import CHANNELS, Observer
from thermicon.perception.observer.observer import Channel, load_thresholds
from thermicon.perception.sensation.receptors import receptor_drive

if TYPE_CHECKING:
    from thermicon.circuit import Trace

DT_S = 0.01
ROUNDS = 4


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
        ThresholdBand(channel, float(start[0]), threshold_change_K(observer, channel, trace.area_m2, trace.site))
        for channel, start in zip(CHANNELS, starts, strict=True)
    )


@lru_cache(maxsize=256)
def threshold_change_K(observer: Observer, channel: Channel, area_m2: float, site: str) -> float:
    """Size (K) of the ramp at receptor depth with d′ = 1, for an observer adapted to its start.

    The ramp has the rate and hold of the step that the observer's unit of sensation was calibrated with; thresholds
    depend on area and site as everywhere else.
    """
    from thermicon.perception.sensation.sensation import sensitivity

    known = load_thresholds()
    rate, held = known.one("rate of the threshold step").central, known.one("duration of the threshold step").central
    wanted = observer.receptor(channel).threshold_drive / sensitivity(channel, observer, area_m2, site)
    # Halfway into the part of the neutral zone in which the channel answers at all.
    low, high = observer.neutral(channel)
    limit = observer.receptor(channel).limit_C
    if limit is not None and channel == "cold":
        high = min(high, limit)
    elif limit is not None:
        low = max(low, limit)
    middle = 0.5 * (low + high)
    sign = -1.0 if channel == "cold" else 1.0
    size = wanted
    for _ in range(ROUNDS):  # drive is in proportion to size, but near a limit of quality
        time = np.arange(0.0, size / rate + held, DT_S)
        felt = receptor_drive(middle + sign * np.minimum(rate * time, size), DT_S, channel, observer)
        size *= wanted / float(felt.max())
    return size
