"""The Peltier module: heat pumped, heat rejected, voltage, and the currents that closed forms give.

Equations: Lineykin & Ben-Yaakov, IEEE Trans. Ind. Appl. 43 (2007) 505. Current is positive when it cools the skin side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

ZERO_C_IN_K = 273.15
"""0 °C in kelvin; the only place where this number stands."""


@dataclass(frozen=True, slots=True)
class Peltier:
    """A module with its two plates.

    `seebeck_V_per_K` α, `resistance_ohm` R, `thermal_resistance_K_per_W` Θ between the plates; plate capacities in J/K.
    `leg_nodes` divide the legs into cells that store heat, `leg_capacity_J_per_K` in all; 0: legs without capacity.

    >>> module = Peltier(0.0521, 6.35, 6.56, 2.6, 2.6)
    >>> round(module.greatest_heat_W(300 - ZERO_C_IN_K, 313.15 - ZERO_C_IN_K), 2)
    17.23
    """

    seebeck_V_per_K: float
    resistance_ohm: float
    thermal_resistance_K_per_W: float
    hot_plate_J_per_K: float
    cold_plate_J_per_K: float
    leg_nodes: int = 0
    leg_capacity_J_per_K: float = 0.0

    def __post_init__(self) -> None:
        for name in self.__slots__[:5]:
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"module.{name} = {value}: must be a positive number")
        if self.leg_nodes and not (math.isfinite(self.leg_capacity_J_per_K) and self.leg_capacity_J_per_K > 0):
            raise ValueError(f"module.leg_capacity_J_per_K = {self.leg_capacity_J_per_K}: must be a positive number")

    def heat_absorbed_W(self, current_A: float, cold_C: float, hot_C: float) -> float:
        """Heat taken from the skin side in W: αTcI − I²R/2 − (Th − Tc)/Θ."""
        pumped = self.seebeck_V_per_K * (cold_C + ZERO_C_IN_K) * current_A
        return pumped - current_A**2 * self.resistance_ohm / 2 - (hot_C - cold_C) / self.thermal_resistance_K_per_W

    def heat_rejected_W(self, current_A: float, cold_C: float, hot_C: float) -> float:
        """Heat given to the hot plate in W: αThI + I²R/2 − (Th − Tc)/Θ."""
        pumped = self.seebeck_V_per_K * (hot_C + ZERO_C_IN_K) * current_A
        return pumped + current_A**2 * self.resistance_ohm / 2 - (hot_C - cold_C) / self.thermal_resistance_K_per_W

    def voltage_V(self, current_A: float, cold_C: float, hot_C: float) -> float:
        """Voltage at the module in V: α(Th − Tc) + IR."""
        return self.seebeck_V_per_K * (hot_C - cold_C) + current_A * self.resistance_ohm

    def greatest_heat_W(self, cold_C: float, hot_C: float) -> float:
        """Most heat the module can absorb in W at fixed plate temperatures, at I = αTc/R."""
        cold_K = cold_C + ZERO_C_IN_K
        return (self.seebeck_V_per_K * cold_K) ** 2 / (2 * self.resistance_ohm) - (
            hot_C - cold_C
        ) / self.thermal_resistance_K_per_W

    def greatest_heat_current_A(self, cold_C: float) -> float:
        """Current in A at which the most heat is absorbed at fixed plate temperatures: αTc/R."""
        return self.seebeck_V_per_K * (cold_C + ZERO_C_IN_K) / self.resistance_ohm

    def figure_of_merit_per_K(self) -> float:
        """Z = α²Θ/R in 1/K."""
        return self.seebeck_V_per_K**2 * self.thermal_resistance_K_per_W / self.resistance_ohm

    def coldest_C(self, hot_C: float) -> float:
        """Lowest cold-plate temperature in °C, where no heat is absorbed any more: (√(1 + 2ZTh) − 1)/Z in kelvin."""
        z = self.figure_of_merit_per_K()
        return (math.sqrt(1 + 2 * z * (hot_C + ZERO_C_IN_K)) - 1) / z - ZERO_C_IN_K

    def greatest_difference_K(self, hot_C: float) -> float:
        """Greatest difference between the plates in K, ΔTmax.

        >>> round(Peltier(0.0521, 6.35, 6.56, 2.6, 2.6).greatest_difference_K(27.0), 1)
        72.6
        """
        return hot_C - self.coldest_C(hot_C)

    def greatest_difference_current_A(self, hot_C: float) -> float:
        """Current in A of the greatest difference, Imax = α·Tc,min/R."""
        return self.greatest_heat_current_A(self.coldest_C(hot_C))
