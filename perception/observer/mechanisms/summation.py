"""Summation over the area of contact.

A contact smaller than a few receptive fields stimulates the same receptors (Campero et al. 2001: human cold units
respond to spots under 5 mm); above about 200 cm² a larger one adds nothing (Hardy & Oppel 1937: 100 and 225 cm²
of radiant heat differ, 225 and 400 do not). Areas that do not touch add like one.
"""

import math
from dataclasses import dataclass

from ..channels import Channel
from ..constants import ANY, Both, constant
from .mechanism import Mechanism

CM2 = 1e-4
"""A square centimetre in m²."""
END_CM2 = 200.0
"""Area where summation ends; between 100 and 400 (Hardy & Oppel 1937)."""


@dataclass(frozen=True, kw_only=True)
class Summation(Mechanism):
    """Sensitivity grows with the area that counts, relative to that of the thresholds."""

    equation = "A_eff = max(A, A_least), A_sum = A_eff/√(1 + (A_eff/A_end)²), sensitivity ∝ A_sum^n"
    source = "Somatosensory Research 1985 for n; Campero et al. 2001; Hardy & Oppel 1937"
    area_exponent: Both[float] = constant("{} area exponent", ANY)
    reference_area_m2: float = constant("reference area", scale=CM2)
    least_area_m2: float = constant("smallest area that counts", scale=CM2)

    def of_area(self, channel: Channel, area_m2: float | None) -> float:
        """Sensitivity relative to the reference area (None: that area); a ValueError for an area of 0."""
        if area_m2 is None:
            return 1.0
        if not area_m2 > 0.0:
            raise ValueError(f"the area of contact must be above 0 m², not {area_m2:g} m²")
        ratio = self.summed_area_cm2(area_m2) / self.summed_area_cm2(self.reference_area_m2)
        return math.pow(ratio, self.area_exponent.of(channel))

    def summed_area_cm2(self, area_m2: float) -> float:
        """The area that counts, in cm²."""
        touched = max(area_m2, self.least_area_m2) / CM2
        return touched / math.hypot(1.0, touched / END_CM2)
