"""What reaches a receptor → receptor drive → sensation. Sensory noise is the unit: ψ = 1 is d′ = 1.

Drive goes through limits of quality, integration and adaptation. There is no cold above the cold channel's limit and no
warmth below the warm channel's: a fall from 36 to 34 °C is less warm, not cold. Adaptation is a level that follows the
input clipped to the neutral zone: inside it adaptation is complete, outside it a hold keeps a residue. The equations
stand in `kernels.kernels`. The input is temperature (°C) or, for an observer of heat flow, W/m² into the skin.
Sensation goes through area, site and transducer.
"""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.channels import Channel, sign_of
from ..observer.observer import Observer


def receptor_drive(received: ArrayLike, dt_s: float, channel: Channel, observer: Observer) -> Array:
    """Drive (never negative, in `observer.drive_unit`) of one channel for what reaches its receptors.

    `received` has shape (..., n_time) on a uniform clock of `dt_s`: temperature in °C at the depth
    of the channel or, as `observer.variable` says, heat flow there in W/m² into the skin. The drive
    has the same shape. At the first sample the receptor is adapted as far as the neutral zone allows.
    """
    from ..kernels.kernels import adapted_drive

    rows, shape = as_rows(received)
    drive = np.empty_like(rows)
    sign, limit, (low, high) = sign_of(channel), observer.limit_C.of(channel), observer.neutral(channel)
    times = observer.integration_s, observer.adaptation_s

    def work(part: slice) -> None:
        adapted_drive(rows[part], dt_s, sign, limit, observer.softness_K, low, high, *times, drive[part])

    over_rows(work, rows.shape[0], rows.size)
    return drive.reshape(shape)


def sensation(
    drive: ArrayLike,
    channel: Channel,
    observer: Observer,
    *,
    area_m2: float | None = None,
    site: str | None = None,
    threshold: ArrayLike = 1.0,
    out: Array | None = None,
) -> Array:
    """Sensation ψ in d′ units, of shape (..., n_time) like the drive (`observer.drive_unit`).

    `area_m2` is the area of contact (None: the reference area), `site` where on the body (None: the
    thenar); `threshold` multiplies the thresholds of this person, age included, one number or one
    for each leading index. It is written to `out`, which may be the drive, where that is given.
    """
    from ..kernels import kernels

    rows, shape = as_rows(drive)
    psi = np.empty(shape) if out is None else out
    felt = psi.reshape(rows.shape)
    unit = observer.threshold_drive.of(channel) / observer.sensitivity(channel, area_m2, site)
    multiples = np.broadcast_to(np.asarray(threshold, dtype=np.float64), shape[:-1])
    scale = np.ascontiguousarray(1.0 / (unit * multiples)).reshape(-1)

    def work(part: slice) -> None:
        kernels.sensation(rows[part], scale[part], observer.a, observer.p, observer.b, felt[part])

    over_rows(work, rows.shape[0], rows.size)
    return psi
