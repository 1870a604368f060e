"""Depths of the receptors in both conventions: from the surface, and from the base of the horny layer."""

from __future__ import annotations

from dataclasses import dataclass

HORNY_LAYER = "stratum corneum"
"""Name of the layer from whose base receptor depths may be counted; it must be a skin's first."""


@dataclass(frozen=True, slots=True)
class ReceptorDepths:
    """Where the receptors lie in mm, counted in both ways that papers use.

    `cold_mm`, `warm_mm` from the surface; `cold_below_horny_mm`, `warm_below_horny_mm` from the base of the stratum
    corneum, negative inside it, None where the skin does not begin with that layer.

    >>> print(ReceptorDepths.counted(0.15, 0.30, horny_mm=0.17))
    cold 0.15 mm, warm 0.3 mm below the surface; cold 0.02 mm above, warm 0.13 mm below the base of the stratum corneum
    """

    cold_mm: float
    warm_mm: float
    cold_below_horny_mm: float | None
    warm_below_horny_mm: float | None

    @staticmethod
    def counted(cold_mm: float, warm_mm: float, horny_mm: float | None) -> ReceptorDepths:
        """Return both conventions from depths below the surface and the thickness of the horny layer, in mm."""
        cold, warm = round(cold_mm, 9), round(warm_mm, 9)
        if horny_mm is None:
            return ReceptorDepths(cold, warm, None, None)
        return ReceptorDepths(cold, warm, round(cold - horny_mm, 9), round(warm - horny_mm, 9))

    def __str__(self) -> str:
        said = f"cold {self.cold_mm:.3g} mm, warm {self.warm_mm:.3g} mm below the surface"
        if self.cold_below_horny_mm is None or self.warm_below_horny_mm is None:
            return said
        cold, warm = (
            f"{name} {abs(depth):.3g} mm {'above' if depth < 0 else 'below'}"
            for name, depth in (("cold", self.cold_below_horny_mm), ("warm", self.warm_below_horny_mm))
        )
        return f"{said}; {cold}, {warm} the base of the {HORNY_LAYER}"
