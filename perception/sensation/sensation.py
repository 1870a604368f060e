"""Receptor drive → sensation, through area, site and transducer. Sensory noise is the unit: ψ = 1 is d′ = 1."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.channels import Channel
from ..observer.observer import Observer
from .summation import END_CM2, FIELD_CM2, area_factor

CM2 = 1e-4
"""A square centimetre in m²."""


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
