"""The Peltier module with its parameters from a data sheet.

Equations: Lineykin & Ben-Yaakov, IEEE Trans. Ind. Appl. 43 (2007) 505, and their four-figure form, exact in Qmax.
Current is positive when it cools the skin side.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from .faults import Amperes, Celsius, KeyTable, Volts, sentence

ZERO_C_IN_K = 273.15
"""0 °C in kelvin; the only place where this number stands."""


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

    def voltage_V(self, current_A: float, cold_C: float, hot_C: float) -> float:
        """Voltage at the module in V: α(Th − Tc) + IR."""
        return self.seebeck_V_per_K * (hot_C - cold_C) + current_A * self.resistance_ohm


@dataclass(frozen=True, slots=True)
class Extraction:
    """The parameters α V/K, R Ω and Θ K/W of a module from its data sheet; `mean_C` is where they hold."""

    seebeck_V_per_K: float
    resistance_ohm: float
    thermal_resistance_K_per_W: float
    mean_C: float

    def greatest(self, hot_C: float) -> tuple[float, float]:
        """Greatest difference in K between plates that absorb no heat, and its current in A, with this hot side."""
        merit_per_K = self.seebeck_V_per_K**2 * self.thermal_resistance_K_per_W / self.resistance_ohm
        hot_K = hot_C + ZERO_C_IN_K
        cold_K = (math.sqrt(1.0 + 2.0 * merit_per_K * hot_K) - 1.0) / merit_per_K
        return hot_K - cold_K, self.seebeck_V_per_K * cold_K / self.resistance_ohm


class Datasheet(KeyTable):
    """The figures that a maker prints for a Peltier module at one hot-side temperature.

    Current and voltage at the greatest temperature difference, that difference, the hot side, and the heat absorbed at
    that current and no difference; None where it is not printed.

    >>> sheet = Datasheet(i_max_A=6.4, v_max_V=14.4, dt_max_K=66, t_hot_C=25, q_max_W=50)
    >>> round(sheet.three_figures().resistance_ohm, 3), round(sheet.four_figures().resistance_ohm, 3)
    (1.752, 1.782)
    """

    i_max_A: Amperes
    v_max_V: Volts
    dt_max_K: Annotated[float, Field(gt=0, le=150)]
    t_hot_C: Celsius
    q_max_W: Annotated[float, Field(ge=1e-6, le=1e6)] | None = None

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
        return Extraction(v / hot, v / i * cold / hot, self.dt_max_K / (i * v) * 2 * hot / cold, self.mean_C)

    def four_figures(self) -> Extraction:
        """Parameters from Imax, Vmax, ΔTmax and Qmax: exact in Qmax, Vmax and no heat at ΔTmax and Imax.

        The cost: cooling is greatest slightly below the printed Imax (8 % below for a TEC1-12706).
        """
        q, i, v, span = self.q_max_W, self.i_max_A, self.v_max_V, self.dt_max_K
        assert q is not None
        hot = self.t_hot_C + ZERO_C_IN_K
        low, high = v * i * span / (2 * hot - span), v * i * hot / span
        if not low < q < high:
            raise ValueError(sentence("parts.sheet_heat", heat=q, low=low, high=high))
        seebeck = (v * i + 2 * q) / ((2 * hot + span) * i)
        ohm, theta = 2 * (seebeck * hot * i - q) / i**2, span / (q - seebeck * span * i)
        return Extraction(seebeck, ohm, theta, self.mean_C)


def at_mean_C(extractions: Sequence[Extraction], mean_C: float) -> tuple[float, float, float]:
    """α V/K, R Ω and Θ K/W at a mean temperature, linear between two extractions, the nearer one outside."""
    first, last = min(extractions, key=lambda one: one.mean_C), max(extractions, key=lambda one: one.mean_C)
    span = last.mean_C - first.mean_C
    share = min(max((mean_C - first.mean_C) / span, 0.0), 1.0) if span > 0 else 0.0
    return (
        (1 - share) * first.seebeck_V_per_K + share * last.seebeck_V_per_K,
        (1 - share) * first.resistance_ohm + share * last.resistance_ohm,
        (1 - share) * first.thermal_resistance_K_per_W + share * last.thermal_resistance_K_per_W,
    )
