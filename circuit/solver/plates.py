"""The heat balance of a module's plates.

The functions are plain Python, which the kernels compile as they are (so none of them calls another) and the steady
state runs uncompiled. The hot plate enters through `base` (W), the heat that reaches it without current, and `total`
(W/K), its conductance to everything around it: base = C_h/δ·T_h + T_s/R_s + T_c/Θ, total = C_h/δ + 1/R_s + 1/Θ, where δ
is the time step (C_h/δ = 0 at rest) and T_s the temperature of the heat sink.
"""

import math

from ..rig.module import ZERO_C_IN_K


def hot_plate_C(current: float, base: float, total: float, alpha: float, ohm: float) -> float:
    """Hot-plate temperature in °C at a current in A: T_h = (base + αI·273.15 K + I²R/2) / (total − αI)."""
    heat = base + alpha * current * ZERO_C_IN_K + 0.5 * ohm * current * current
    return heat / (total - alpha * current)


def greatest_cooling_A(cold: float, base: float, total: float, alpha: float, ohm: float, leak: float) -> float:
    """Current in A at which the most heat is absorbed; more current than that heats.

    It is below αT_c/R, since the hot plate warms with it: I = (αT_c − (α·T_h + I·R)/Θ / (total − αI)) / R, iterated, in
    kelvin.
    """
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
    """Smaller current in A that absorbs `heat` (W); `greatest` where the module cannot absorb that much.

    The smaller root of αT_c·I − I²R/2 = heat + (T_h(I) − T_c)/Θ, from `guess` (A) until it moves by less than `close`
    (A): by Newton's steps on I = f(I), where f takes T_h from the current before.
    """
    half = alpha * (cold + ZERO_C_IN_K)
    current = guess
    for _ in range(60):
        around = 1.0 / (total - alpha * current)
        hot = (base + alpha * current * ZERO_C_IN_K + 0.5 * ohm * current * current) * around
        root = half * half - 2.0 * ohm * (heat + leak * (hot - cold))
        if root < 0.0:
            return greatest
        root = math.sqrt(root)
        slope = leak * (alpha * (hot + ZERO_C_IN_K) + ohm * current) * around / root
        better = current + ((half - root) / ohm - current) / (1.0 - slope)
        if better > greatest:
            return greatest
        if abs(better - current) < close:
            return better
        current = better
    return current
