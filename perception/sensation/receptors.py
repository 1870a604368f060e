"""What reaches a receptor → receptor drive: integration, adaptation, gain lowered by recent drive.

Integration and adaptation are exact for input that is linear between samples. Adaptation is a
level that follows the input clipped to the neutral zone: inside it adaptation is complete,
outside it a hold keeps a residue. The cold channel has a fast part beside the slow one; that part
follows the unclipped input, so it answers to change alone. Gain falls as (1 + r/s)^−p, where r is
the recent size of the drive, of either sign (a receptor that was just silenced is slow to answer
as well), averaged exponentially; r takes the size as linear between samples, which at 100 Hz and
time constants of 1 s and more changes drive by less than 0.1 %.

The input is temperature (°C) or, for an observer of heat flow, W/m² into the skin. An observer of
the Ring & de Dear model counts impulses instead (`impulses`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.channels import Channel, sign_of
from ..observer.observer import Observer
from .impulses import counted_impulses

BLOCK = 16
"""Rows counted at once, few enough that what lies between the steps stays in the processor's cache."""


def receptor_drive(received: ArrayLike, dt_s: float, channel: Channel, observer: Observer) -> Array:
    """Drive (never negative, in `observer.drive_unit`) of one channel for what reaches its receptors.

    `received` has shape (..., n_time) on a uniform clock of `dt_s`: temperature in °C at the depth
    of the channel or, as `observer.variable` says, heat flow there in W/m² into the skin. The drive
    has the same shape. At the first sample the receptor is adapted as far as the neutral zone allows.

    >>> import numpy as np
    >>> cooling = 32.0 - np.minimum(np.arange(0.0, 4.0, 0.01), 1.0)
    >>> bool(receptor_drive(cooling, 0.01, "warm", Observer.load()).max() > 0.0)
    False
    """
    from ..kernels import kernels

    rows, shape = as_rows(received)
    drive = np.empty_like(rows)

    def count(part: slice) -> None:
        for start in range(part.start, part.stop, BLOCK):
            block = slice(start, min(start + BLOCK, part.stop))
            drive[block] = counted_impulses(rows[block], dt_s, channel, observer)

    if observer.model == "ring-de-dear":
        over_rows(count, rows.shape[0], rows.size)
        return drive.reshape(shape)
    receptor = observer.receptor(channel)
    taus = (observer.integration_s, receptor.slow_s, receptor.fast_s, receptor.gain_s)
    step = np.array([_step(dt_s, tau) for tau in taus])
    low, high = observer.neutral(channel)
    scale = receptor.gain_scale * receptor.threshold_drive
    sign = sign_of(channel)

    def work(part: slice) -> None:
        kernels.drive(
            rows[part], step, sign, low, high, receptor.fast_weight, scale, receptor.gain_strength, drive[part]
        )

    over_rows(work, rows.shape[0], rows.size)
    return drive.reshape(shape)


def _step(dt_s: float, tau_s: float) -> tuple[float, float, float, float]:
    """Weights of the old state, the old and the new input, exact for input linear in between."""
    decay = math.exp(-dt_s / tau_s)
    mean = -math.expm1(-dt_s / tau_s) * tau_s / dt_s
    return decay, mean - decay, 1.0 - mean, tau_s
