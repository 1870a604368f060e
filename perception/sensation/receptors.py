"""What reaches a receptor → receptor drive: limits of quality, integration, adaptation.

There is no cold above the cold channel's limit and no warmth below the warm channel's: a fall from 36 to 34 °C is less
warm, not cold. Adaptation is a level that follows the input clipped to the neutral zone: inside it adaptation is
complete, outside it a hold keeps a residue. The equations stand in `kernels.adapted_drive`.

The input is temperature (°C) or, for an observer of heat flow, W/m² into the skin.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.channels import Channel, sign_of
from ..observer.observer import Observer

NO_LIMIT_C = 1e6
"""So far away that a limit does nothing."""


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
    from ..kernels.adapted_drive import adapted_drive

    rows, shape = as_rows(received)
    drive = np.empty_like(rows)
    receptor, sign = observer.receptor(channel), sign_of(channel)
    limit = -NO_LIMIT_C * sign if receptor.limit_C is None else receptor.limit_C
    low, high = observer.neutral(channel)

    def work(part: slice) -> None:
        adapted_drive(
            rows[part],
            dt_s,
            sign,
            limit,
            receptor.softness_K,
            low,
            high,
            observer.integration_s,
            receptor.adaptation_s,
            drive[part],
        )

    over_rows(work, rows.shape[0], rows.size)
    return drive.reshape(shape)
