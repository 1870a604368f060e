"""What reaches a receptor → receptor drive → sensation. Sensory noise is the unit: ψ = 1 is d′ = 1.

Drive goes through limits of quality, integration and adaptation. There is no cold above the cold channel's limit and no
warmth below the warm channel's: a fall from 36 to 34 °C is less warm, not cold. Adaptation is a level that follows the
input clipped to the neutral zone: inside it adaptation is complete, outside it a hold keeps a residue. The equations
stand in `kernels.kernels`. The input is temperature (°C) or, for an observer of heat flow, W/m² into the skin.
Sensation goes through area, site and transducer.

Spatial summation has two ends:

    A_eff = (√A + √A_rf)²,   A_sum = A_eff/√(1 + (A_eff/A_end)²),   sensitivity ∝ A_sum^n

Below the area of a receptive field a smaller contact stimulates the same receptors (Campero et al. 2001: human cold
units respond to spots under 5 mm); above about 200 cm² a larger one adds nothing (Hardy & Oppel 1937: 100 and 225 cm²
of radiant heat differ, 225 and 400 do not). Areas that do not touch add like one.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.channels import Channel, sign_of
from ..observer.observer import Observer

CM2 = 1e-4
"""A square centimetre in m²."""
FIELD_CM2 = 0.25
"""Area of a receptive field 5 mm wide, as a square (Campero et al. 2001)."""
END_CM2 = 200.0
"""Area where summation ends; between 100 and 400 (Hardy & Oppel 1937)."""


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
    unit = observer.threshold_drive.of(channel) / sensitivity(channel, observer, area_m2, site)
    multiples = np.broadcast_to(np.asarray(threshold, dtype=np.float64), shape[:-1])
    scale = np.ascontiguousarray(1.0 / (unit * multiples)).reshape(-1)

    def work(part: slice) -> None:
        kernels.sensation(rows[part], scale[part], observer.a, observer.p, observer.b, felt[part])

    over_rows(work, rows.shape[0], rows.size)
    return psi


def sensitivity(channel: Channel, observer: Observer, area_m2: float | None, site: str | None = None) -> float:
    """How much smaller thresholds are than on the hand at the reference area, by summation and site."""
    factor = observer.site_factor(channel, site)
    if area_m2 is None:
        return 1.0 / factor
    if not area_m2 > 0.0:
        raise ValueError(f"the area of contact must be above 0 m², not {area_m2:g} m²")
    exponent = observer.area_exponent.of(channel)
    return area_factor(area_m2 / CM2, observer.reference_area_m2 / CM2, exponent) / factor


def summed_area_cm2(area_cm2: float, field_cm2: float = FIELD_CM2, end_cm2: float = END_CM2) -> float:
    """The area that counts, in cm²; ``math.inf`` as `end_cm2` and 0 as `field_cm2` turn the two ends off."""
    if not area_cm2 > 0.0:
        raise ValueError(f"the area of contact must be above 0 cm², not {area_cm2:g} cm²")
    touched = (math.sqrt(area_cm2) + math.sqrt(field_cm2)) ** 2
    return touched / math.hypot(1.0, touched / end_cm2)


def area_factor(
    area_cm2: float,
    reference_cm2: float,
    exponent: float,
    field_cm2: float = FIELD_CM2,
    end_cm2: float = END_CM2,
) -> float:
    """Sensitivity at an area over that at a reference area."""
    ratio = summed_area_cm2(area_cm2, field_cm2, end_cm2) / summed_area_cm2(reference_cm2, field_cm2, end_cm2)
    return math.pow(ratio, exponent)
