"""The Peltier module: heat absorbed, voltage, and its parameters from what a data sheet prints.

Equations: Lineykin & Ben-Yaakov, IEEE Trans. Ind. Appl. 43 (2007) 505, and their four-figure form, exact in Qmax.
Current is positive when it cools the skin side.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from .faults import sentence

ZERO_C_IN_K = 273.15
"""0 °C in kelvin; the only place where this number stands."""
Method = Literal["three", "four"]


@dataclass(frozen=True, slots=True)
class Peltier:
    """A module with its two plates.

    `seebeck_V_per_K` α, `resistance_ohm` R, `thermal_resistance_K_per_W` Θ between the plates; plate capacities in J/K.
    The legs between them store no heat.
    """

    seebeck_V_per_K: float
    resistance_ohm: float
    thermal_resistance_K_per_W: float
    hot_plate_J_per_K: float
    cold_plate_J_per_K: float

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"module.{name} = {value}: must be a positive number")

    def heat_absorbed_W(self, current_A: float, cold_C: float, hot_C: float) -> float:
        """Heat taken from the skin side in W: αTcI − I²R/2 − (Th − Tc)/Θ."""
        pumped = self.seebeck_V_per_K * (cold_C + ZERO_C_IN_K) * current_A
        return pumped - current_A**2 * self.resistance_ohm / 2 - (hot_C - cold_C) / self.thermal_resistance_K_per_W

    def voltage_V(self, current_A: float, cold_C: float, hot_C: float) -> float:
        """Voltage at the module in V: α(Th − Tc) + IR."""
        return self.seebeck_V_per_K * (hot_C - cold_C) + current_A * self.resistance_ohm


@dataclass(frozen=True, slots=True)
class Extraction:
    """The parameters of a module extracted from its data sheet, and how far they miss the printed Qmax.

    `seebeck_V_per_K` α, `resistance_ohm` R, `thermal_resistance_K_per_W` Θ; `mean_C` the module temperature for
    which they hold. The residual is the heat absorbed at Imax and ΔT = 0 less the printed Qmax: in W, and relative to
    Qmax; None where the sheet prints no Qmax.
    """

    method: Method
    seebeck_V_per_K: float
    resistance_ohm: float
    thermal_resistance_K_per_W: float
    mean_C: float
    residual_W: float | None
    residual_relative: float | None

    def __repr__(self) -> str:
        miss = "" if self.residual_relative is None else f", Qmax {100 * self.residual_relative:+.1f} %"
        return (
            f"Extraction({self.method} figures: {self.seebeck_V_per_K:.4g} V/K, {self.resistance_ohm:.4g} Ω, "
            f"{self.thermal_resistance_K_per_W:.4g} K/W at {self.mean_C:.1f} °C{miss})"
        )


@dataclass(frozen=True, slots=True)
class Datasheet:
    """The figures that a maker prints for a Peltier module at one hot-side temperature.

    Parameters
    ----------
    i_max_A, v_max_V
        Current in A and voltage in V at the greatest temperature difference.
    dt_max_K
        Greatest temperature difference in K.
    t_hot_C
        Hot-side temperature in °C for which the figures hold.
    q_max_W
        Heat in W absorbed at `i_max_A` and ΔT = 0; None where it is not printed.

    Examples
    --------
    >>> sheet = Datasheet(6.4, 14.4, 66, 25, q_max_W=50)
    >>> sheet.three_figures()
    Extraction(three figures: 0.0483 V/K, 1.752 Ω, 1.839 K/W at 8.5 °C, Qmax +12.6 %)
    >>> sheet.four_figures()
    Extraction(four figures: 0.04533 V/K, 1.782 Ω, 2.139 K/W at 8.5 °C, Qmax +0.0 %)
    """

    i_max_A: float
    v_max_V: float
    dt_max_K: float
    t_hot_C: float
    q_max_W: float | None = None

    def __post_init__(self) -> None:
        for name, unit in (("i_max_A", "A"), ("v_max_V", "V"), ("dt_max_K", "K"), ("q_max_W", "W")):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} = {value:g} {unit}: must be a positive number in {unit}")
        if not math.isfinite(self.t_hot_C):
            raise ValueError(f"t_hot_C = {self.t_hot_C:g} °C: must be a finite number in °C")
        hot_K = self.t_hot_C + ZERO_C_IN_K
        if self.dt_max_K >= hot_K:
            raise ValueError(sentence("parts.sheet_difference", sheet=self, hot=hot_K))

    @property
    def mean_C(self) -> float:
        """Module temperature in °C for which the figures hold: the mean of Th and Tc, with Tc halfway to Th − ΔTmax.

        The figures span differences from 0 (Qmax) to ΔTmax, so the cold side is taken at Th − ΔTmax/2.
        """
        return self.t_hot_C - self.dt_max_K / 4

    def three_figures(self) -> Extraction:
        """Parameters from Imax, Vmax and ΔTmax, which they reproduce; they may miss a printed Qmax."""
        hot, i, v = self.t_hot_C + ZERO_C_IN_K, self.i_max_A, self.v_max_V
        cold = hot - self.dt_max_K
        return self._made("three", hot, v / hot, v / i * cold / hot, self.dt_max_K / (i * v) * 2 * hot / cold)

    def four_figures(self) -> Extraction:
        """Parameters from Imax, Vmax, ΔTmax and Qmax: exact in Qmax, Vmax and no heat at ΔTmax and Imax.

        The cost: cooling is greatest slightly below the printed Imax (8 % below for a TEC1-12706).
        """
        q, i, v, span = self.q_max_W, self.i_max_A, self.v_max_V, self.dt_max_K
        if q is None:
            raise ValueError('q_max_W is missing; four figures need it: add it, in W, or use extraction = "three"')
        hot = self.t_hot_C + ZERO_C_IN_K
        low, high = v * i * span / (2 * hot - span), v * i * hot / span
        if not low < q < high:
            raise ValueError(sentence("parts.sheet_heat", heat=q, low=low, high=high))
        seebeck = (v * i + 2 * q) / ((2 * hot + span) * i)
        return self._made("four", hot, seebeck, 2 * (seebeck * hot * i - q) / i**2, span / (q - seebeck * span * i))

    def _made(self, method: Method, hot_K: float, seebeck: float, ohm: float, theta: float) -> Extraction:
        absorbed = seebeck * hot_K * self.i_max_A - self.i_max_A**2 * ohm / 2
        miss = None if self.q_max_W is None else absorbed - self.q_max_W
        relative = None if miss is None or self.q_max_W is None else miss / self.q_max_W
        return Extraction(method, seebeck, ohm, theta, self.mean_C, miss, relative)


def at_mean_C(extractions: Sequence[Extraction], mean_C: float) -> tuple[float, float, float]:
    """α V/K, R Ω and Θ K/W at a mean module temperature, linear between two extractions; one is taken as it is.

    Outside the two, the nearer one is used, since no sheet supports an extrapolation; callers report it.
    """
    first, last = min(extractions, key=lambda one: one.mean_C), max(extractions, key=lambda one: one.mean_C)
    span = last.mean_C - first.mean_C
    share = min(max((mean_C - first.mean_C) / span, 0.0), 1.0) if span > 0 else 0.0
    return (
        (1 - share) * first.seebeck_V_per_K + share * last.seebeck_V_per_K,
        (1 - share) * first.resistance_ohm + share * last.resistance_ohm,
        (1 - share) * first.thermal_resistance_K_per_W + share * last.thermal_resistance_K_per_W,
    )
