"""Temperature at receptor depth → receptor drive: integration, then adaptation.

Both filters are exact for input that is linear between samples. Adaptation is a level that
follows the temperature clipped to the neutral zone: inside it adaptation is complete, outside
it a hold keeps a residue. The cold channel has a fast part beside the slow one; that part
follows the unclipped temperature, so it answers to change alone.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermicon.perception.observer import Channel, Observer
from thermicon.perception.parallel import over_rows

Array = NDArray[np.float64]


def receptor_drive(temperature_C: ArrayLike, dt_s: float, channel: Channel, observer: Observer) -> Array:
    """Drive (K, never negative) of one channel for temperatures at its depth.

    `temperature_C` has shape (..., n_time) on a uniform clock of `dt_s`; the drive has the same
    shape. At the first sample the receptor is adapted as far as the neutral zone allows.

    >>> import numpy as np
    >>> cooling = 32.0 - np.minimum(np.arange(0.0, 4.0, 0.01), 1.0)
    >>> bool(receptor_drive(cooling, 0.01, "warm", Observer.load()).max() > 0.0)
    False
    """
    from thermicon.perception import kernels

    rows, shape = as_rows(temperature_C)
    receptor = observer.receptor(channel)
    taus = (observer.integration_s, receptor.slow_s, receptor.fast_s)
    step = np.array([_step(dt_s, tau) for tau in taus])
    drive = np.empty_like(rows)
    sign = -1.0 if channel == "cold" else 1.0

    def work(part: slice) -> None:
        low, high = observer.neutral_low_C, observer.neutral_high_C
        kernels.drive(rows[part], step, sign, low, high, receptor.fast_weight, drive[part])

    over_rows(work, rows.shape[0], rows.size)
    return drive.reshape(shape)


def as_rows(values: ArrayLike) -> tuple[Array, tuple[int, ...]]:
    """(rows, n_time) view of a contiguous float64 array, and the shape it came in."""
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] < 2:
        raise ValueError(f"a trace needs at least two samples on its last axis, not shape {array.shape}")
    return array.reshape(-1, array.shape[-1]), array.shape


def _step(dt_s: float, tau_s: float) -> tuple[float, float, float, float]:
    """Weights of the old state, the old and the new input, exact for input linear in between."""
    decay = math.exp(-dt_s / tau_s)
    mean = -math.expm1(-dt_s / tau_s) * tau_s / dt_s
    return decay, mean - decay, 1.0 - mean, tau_s
