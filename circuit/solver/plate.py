"""What current moves a given heat: scalar functions of the module between its plates.

Plain Python that the compiled kernel takes over as it stands (so no function calls another); the steady state uses it
uncompiled. The hot plate enters through `base` (W), the heat that reaches it without current, and `total` (W/K), its
conductance to everything: base = C_h/δ·T_h + sink/R_s + cold/Θ and total = C_h/δ + 1/R_s + 1/Θ, with C_h/δ = 0 at rest.
"""

from __future__ import annotations

import math

from ..rig.module import ZERO_C_IN_K


def hot_plate_C(current: float, base: float, total: float, alpha: float, ohm: float) -> float:
    """Hot-plate temperature in °C at a current in A."""
    heat = base + alpha * current * ZERO_C_IN_K + 0.5 * ohm * current * current
    return heat / (total - alpha * current)


def greatest_cooling_A(cold: float, base: float, total: float, alpha: float, ohm: float, leak: float) -> float:
    """Current in A of greatest heat absorbed: about αTc/R, lower through the heat sink; beyond it, it heats."""
    absolute = cold + ZERO_C_IN_K
    current = alpha * absolute / ohm
    for _ in range(30):
        under = total - alpha * current
        hot = (base + alpha * current * ZERO_C_IN_K + 0.5 * ohm * current * current) / under
        better = (alpha * absolute - leak * (alpha * (hot + ZERO_C_IN_K) + ohm * current) / under) / ohm
        if abs(better - current) < 1e-10:
            return better
        current = better
    return current


def current_for_heat_A(
    heat: float,
    cold: float,
    base: float,
    total: float,
    alpha: float,
    ohm: float,
    leak: float,
    greatest: float,
    guess: float,
    close: float,
) -> float:
    """Low-current root in A of heat absorbed = `heat` (W); `greatest` where the module cannot absorb that much.

    The search starts at `guess` (A) and ends when it moves by less than `close` (A).
    """
    half = alpha * (cold + ZERO_C_IN_K)
    current = guess
    for _ in range(60):
        hot = (base + alpha * current * ZERO_C_IN_K + 0.5 * ohm * current * current) / (total - alpha * current)
        root = half * half - 2.0 * ohm * (heat + leak * (hot - cold))
        if root < 0.0:
            return greatest
        better = (half - math.sqrt(root)) / ohm
        if better > greatest:
            return greatest
        if abs(better - current) < close:
            return better
        current = better
    return current
