"""Features of one trace. Rules and reasons use nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..observer.channels import Channel
from .percept import Percept

if TYPE_CHECKING:
    from thermicon.circuit import Trace

STILL_K = 1e-6
SIDE_SHARE = 0.1
"""A direction counts when its excursion is more than this share of the larger one."""
HELD_SHARE = 0.99


def receptor_C(trace: Trace, channel: Channel) -> Array:
    """Temperature at the depth of a channel, °C."""
    return trace.cold_receptor_C if channel == "cold" else trace.warm_receptor_C


def peak_change_K(trace: Trace, channel: Channel) -> float:
    """Largest change from the start at the depth of a channel, K, with its sign."""
    change = _change(receptor_C(trace, channel))
    return float(change[_peak(change)])


def attack_K_per_s(trace: Trace, channel: Channel) -> float:
    """Steepest rate on the way to that peak, towards it, at the depth of a channel, K/s (0: no change)."""
    change = _change(receptor_C(trace, channel))
    return _attack(trace, change, _peak(change))


def delay_s(trace: Trace, channel: Channel) -> float | None:
    """Time at which the receptor reaches half its peak change minus the same for the face of the skin, s."""
    receptor = _half_time(trace, receptor_C(trace, channel))
    skin = _half_time(trace, trace.skin_C)
    return None if receptor is None or skin is None else receptor - skin


def excursion_K(trace: Trace, channel: Channel) -> float:
    """Largest cooling at the cold depth (≤ 0) or largest warming at the warm depth (≥ 0), K."""
    change = _change(receptor_C(trace, channel))
    return float(change.min() if channel == "cold" else change.max())


def excursion_rate_K_per_s(trace: Trace, channel: Channel) -> float:
    """Steepest rate towards that excursion before it is reached, K/s with its sign."""
    change = _change(receptor_C(trace, channel))
    return _attack(trace, change, int(change.argmin() if channel == "cold" else change.argmax()))


def passing_s(trace: Trace, channel: Channel, threshold_K: float) -> float | None:
    """When a receptor has changed by `threshold_K` in its own direction, s from the start; None where it never does."""
    change = _change(receptor_C(trace, channel)) * (-1.0 if channel == "cold" else 1.0)
    k = int((change >= threshold_K).argmax())
    if change[k] < threshold_K:
        return None
    if k == 0:
        return float(trace.time_s[0])
    share = (threshold_K - change[k - 1]) / (change[k] - change[k - 1])
    return float(trace.time_s[k - 1] + share * (trace.time_s[k] - trace.time_s[k - 1]))


def peak_lead_s(trace: Trace, percept: Percept, channel: Channel) -> float | None:
    """Predicted felt peak minus that of the skin (held: within 1 %), s on the percept clock; None where one rests."""
    felt = percept.felt_peak_s(channel)
    skin = _change(trace.skin_C) * (-1.0 if channel == "cold" else 1.0)
    if felt is None or skin.max() < STILL_K:
        return None
    return felt - float(trace.time_s[int((skin >= HELD_SHARE * skin.max()).argmax())])


def directions(trace: Trace) -> tuple[Channel, ...]:
    """Directions the receptors are moved in, in the order of their excursions; a tenth of the larger is ignored."""
    cold, warm = _change(trace.cold_receptor_C), _change(trace.warm_receptor_C)
    size: dict[Channel, float] = {"cold": float(-cold.min()), "warm": float(warm.max())}
    when: dict[Channel, int] = {"cold": int(cold.argmin()), "warm": int(warm.argmax())}
    least = max(STILL_K, SIDE_SHARE * max(size.values()))
    return tuple(sorted((c for c in size if size[c] > least), key=lambda c: when[c]))


def direction_words(moved: tuple[Channel, ...]) -> str:
    """Directions in words, as in `cools, then warms`."""
    verbs = {"cold": "cools", "warm": "warms"}
    return ", then ".join(verbs[c] for c in moved) or "does not change"


def _change(temperature_C: Array) -> Array:
    return np.asarray(temperature_C - temperature_C[0])


def _peak(change: Array) -> int:
    return int(np.abs(change).argmax())


def _attack(trace: Trace, change: Array, peak: int) -> float:
    if peak == 0 or abs(change[peak]) < STILL_K:
        return 0.0
    rate = np.diff(change[: peak + 1]) / np.diff(trace.time_s[: peak + 1])
    return float(rate.min() if change[peak] < 0 else rate.max())


def _half_time(trace: Trace, temperature_C: Array) -> float | None:
    change = _change(temperature_C)
    peak = change[_peak(change)]
    if abs(peak) < STILL_K:
        return None
    share = change / peak
    k = int((share >= 0.5).argmax())
    step = trace.time_s[k] - trace.time_s[k - 1]
    return float(trace.time_s[k - 1] + step * (0.5 - share[k - 1]) / (share[k] - share[k - 1]))
