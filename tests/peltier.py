"""Closed forms of a Peltier module."""

from math import sqrt

from thermicon.circuit.rig.module import ZERO_C_IN_K, Peltier


def heat_absorbed_W(module: Peltier, current_A: float, cold_C: float, hot_C: float) -> float:
    """Heat taken from the skin side in W: αTcI − I²R/2 − (Th − Tc)/Θ."""
    pumped = module.seebeck_V_per_K * (cold_C + ZERO_C_IN_K) * current_A
    return pumped - current_A**2 * module.resistance_ohm / 2 - (hot_C - cold_C) / module.thermal_resistance_K_per_W


def heat_rejected_W(module: Peltier, current_A: float, cold_C: float, hot_C: float) -> float:
    """Heat given to the hot plate in W: αThI + I²R/2 − (Th − Tc)/Θ."""
    pumped = module.seebeck_V_per_K * (hot_C + ZERO_C_IN_K) * current_A
    return pumped + current_A**2 * module.resistance_ohm / 2 - (hot_C - cold_C) / module.thermal_resistance_K_per_W


def coldest_C(module: Peltier, hot_C: float) -> float:
    """Cold plate in °C where no heat is absorbed any more: (√(1 + 2ZTh) − 1)/Z in kelvin, with Z = α²Θ/R."""
    z = module.seebeck_V_per_K**2 * module.thermal_resistance_K_per_W / module.resistance_ohm
    return (sqrt(1 + 2 * z * (hot_C + ZERO_C_IN_K)) - 1) / z - ZERO_C_IN_K


def greatest_difference_A(module: Peltier, hot_C: float) -> float:
    """Current in A of the greatest difference between the plates, Imax = α·Tc,min/R."""
    return module.seebeck_V_per_K * (coldest_C(module, hot_C) + ZERO_C_IN_K) / module.resistance_ohm
