"""The receptor model of the Ring & de Dear type: impulses counted over a window.

A fibre fires at K_s·(T − T_0)⁺ + K_d·dT/dt above its rest, never below silence; the cold one with
the signs turned. What is felt goes by the impulses above those of the start, counted over the last
20 s. With 56 and 62 Hz·s/K a change gives the same count at whatever rate it comes, and a return
to rest gives the other channel as many impulses as the onset gave this one: there is no adaptation
but the end of the window. Constants are reference data from open code; their scale is calibrated.
Depths are the rig's, as for every observer, though the published warm depth is 0.50 mm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..observer.channels import Channel, sign_of

if TYPE_CHECKING:
    from ..observer.observer import Observer


def counted_impulses(temperature_C: Array, dt_s: float, channel: Channel, observer: Observer) -> Array:
    """Impulses (≥ 0) of one channel in the window before each sample, shape (rows, n_time) as given.

    Exact for temperature linear between samples, but in a step that crosses the temperature where
    static discharge starts, where the error is at most K_s·|ΔT|·dt/8 impulses.
    """
    receptor, sign = observer.receptor(channel), sign_of(channel)
    static = receptor.static_Hz_per_K * np.maximum(0.0, sign * (temperature_C - observer.static_from_C))
    above = static - static[:, :1]
    dynamic = (receptor.dynamic_Hz_s_per_K * sign / dt_s) * np.diff(temperature_C, axis=1)
    per_step = dt_s * mean_positive_part(above[:, :-1] + dynamic, above[:, 1:] + dynamic)
    total = np.concatenate([np.zeros((temperature_C.shape[0], 1)), np.cumsum(per_step, axis=1)], axis=1)
    return total - _earlier(total, observer.count_s / dt_s)


def mean_positive_part(start: Array, end: Array) -> Array:
    """Mean of max(0, f) over a step in which f goes straight from `start` to `end`.

    >>> float(mean_positive_part(np.array(-1.0), np.array(3.0)))
    1.125
    """
    up, down = np.maximum(start, 0.0), np.maximum(end, 0.0)
    share = np.divide(up + down, np.abs(start) + np.abs(end), out=np.ones_like(up), where=(up > 0) | (down > 0))
    mean: Array = 0.5 * (up + down) * share
    return mean


def _earlier(total: Array, steps: float) -> Array:
    """The count as it was `steps` samples before, linear between samples; 0 before the first."""
    whole = int(np.floor(steps))
    if whole + 1 >= total.shape[1]:
        return np.zeros_like(total)
    part, before = steps - whole, np.zeros_like(total)
    before[:, whole:] = (1.0 - part) * total[:, : total.shape[1] - whole]
    before[:, whole + 1 :] += part * total[:, : total.shape[1] - whole - 1]
    return before
