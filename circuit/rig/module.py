"""The Peltier module: heat absorbed and voltage.

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

    def voltage_V(self, current_A: float, cold_C: float, hot_C: float) -> float:
        """Voltage at the module in V: α(Th − Tc) + IR."""
        return self.seebeck_V_per_K * (hot_C - cold_C) + current_A * self.resistance_ohm
