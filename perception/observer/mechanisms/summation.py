"""Summation over the area of contact."""

from dataclasses import dataclass

from ..constants import ANY, Both, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Summation(Mechanism):
    """Sensitivity grows with the area that counts, relative to that of the thresholds."""

    equation = "A_eff = (√A + √A_rf)², A_sum = A_eff/√(1 + (A_eff/A_end)²), sensitivity ∝ A_sum^n"
    source = "Campero et al. 2001; Hardy & Oppel 1937"
    area_exponent: Both[float] = constant("{} area exponent", ANY)
    reference_area_m2: float = constant("reference area", scale=1e-4)
