"""Spatial summation with two ends: how sensitivity depends on the area of contact.

    A_eff = (√A + √A_rf)²,   A_sum = A_eff/√(1 + (A_eff/A_end)²),   sensitivity ∝ A_sum^n

Below the area of a receptive field a smaller contact stimulates the same receptors (Campero et al. 2001: human cold
units respond to spots under 5 mm); above about 200 cm² a larger one adds nothing (Hardy & Oppel 1937: 100 and 225 cm²
of radiant heat differ, 225 and 400 do not). Areas that do not touch add like one.
"""

from __future__ import annotations

import math

FIELD_CM2 = 0.25
"""Area of a receptive field 5 mm wide, as a square (Campero et al. 2001)."""

END_CM2 = 200.0
"""Area where summation ends; between 100 and 400 (Hardy & Oppel 1937)."""


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
