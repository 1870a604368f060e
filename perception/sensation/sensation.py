"""Receptor drive → sensation, through area, site and transducer. Sensory noise is the unit: ψ = 1 is d′ = 1.

Spatial summation has two ends:

    A_eff = (√A + √A_rf)²,   A_sum = A_eff/√(1 + (A_eff/A_end)²),   sensitivity ∝ A_sum^n

Below the area of a receptive field a smaller contact stimulates the same receptors (Campero et al. 2001: human cold
units respond to spots under 5 mm); above about 200 cm² a larger one adds nothing (Hardy & Oppel 1937: 100 and 225 cm²
of radiant heat differ, 225 and 400 do not). Areas that do not touch add like one.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.channels import Channel
from ..observer.observer import Observer

CM2 = 1e-4
"""A square centimetre in m²."""
FIELD_CM2 = 0.25
"""Area of a receptive field 5 mm wide, as a square (Campero et al. 2001)."""
END_CM2 = 200.0
"""Area where summation ends; between 100 and 400 (Hardy & Oppel 1937)."""


def sensation(
    drive: ArrayLike,
    channel: Channel,
    observer: Observer,
    *,
    area_m2: float | None = None,
    site: str | None = None,
    threshold: ArrayLike = 1.0,
) -> Array:
    """Sensation ψ in d′ units, of shape (..., n_time) like the drive (`observer.drive_unit`).

    `area_m2` is the area of contact (None: the reference area), `site` where on the body (None: the
    thenar); `threshold` multiplies the thresholds of this person, age included, one number or one
    for each leading index.

    >>> person = Observer.load()
    >>> step = [[0.0, person.cold.threshold_drive]]
    >>> round(float(sensation(step, "cold", person)[0, 1]), 12)
    1.0
    """
    rows, shape = as_rows(drive)
    psi = np.empty(shape)
    sense(rows, psi, channel, observer, area_m2=area_m2, site=site, threshold=threshold)
    return psi


def sense(
    rows: Array,
    psi: Array,
    channel: Channel,
    observer: Observer,
    *,
    area_m2: float | None,
    site: str | None,
    threshold: ArrayLike,
) -> None:
    """Fill `psi` (..., n_time) with the sensation of drives seen as rows; both may be the same memory."""
    from ..kernels import kernels

    shape, felt = psi.shape, psi.reshape(rows.shape)
    unit = observer.receptor(channel).threshold_drive / sensitivity(channel, observer, area_m2, site)
    multiples = np.broadcast_to(np.asarray(threshold, dtype=np.float64), shape[:-1])
    scale = np.ascontiguousarray(1.0 / (unit * multiples)).reshape(-1)

    def work(part: slice) -> None:
        kernels.sensation(rows[part], scale[part], observer.a, observer.p, observer.transducer.b, felt[part])

    over_rows(work, rows.shape[0], rows.size)


def sensitivity(channel: Channel, observer: Observer, area_m2: float | None, site: str | None = None) -> float:
    """How much smaller thresholds are than on the hand at the reference area, by summation and site.

    >>> person = Observer.load()
    >>> sensitivity("cold", person, None, "thenar")
    1.0
    """
    factor = observer.site_factor(channel, site)
    if area_m2 is None:
        return 1.0 / factor
    if not area_m2 > 0.0:
        raise ValueError(f"the area of contact must be above 0 m², not {area_m2:g} m²")
    ends = (0.0, math.inf) if "ends of summation" in observer.without else (FIELD_CM2, END_CM2)
    exponent = observer.receptor(channel).area_exponent
    return area_factor(area_m2 / CM2, observer.reference_area_m2 / CM2, exponent, *ends) / factor


def summed_area_cm2(area_cm2: float, field_cm2: float = FIELD_CM2, end_cm2: float = END_CM2) -> float:
    """The area that counts, in cm²; ``math.inf`` as `end_cm2` and 0 as `field_cm2` turn the two ends off.

    >>> [round(summed_area_cm2(area), 2) for area in (0.01, 9.0, 18000.0)]
    [0.36, 12.23, 199.99]
    """
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
    """Sensitivity at an area over that at a reference area.

    >>> round(area_factor(18.0, 9.0, 0.7), 3)
    1.525
    """
    ratio = summed_area_cm2(area_cm2, field_cm2, end_cm2) / summed_area_cm2(reference_cm2, field_cm2, end_cm2)
    return math.pow(ratio, exponent)
