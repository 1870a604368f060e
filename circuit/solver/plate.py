"""The two plates of the module as numbers, and the current that moves a given heat between them.

The functions are plain Python, which the kernels compile as they are (so none of them calls another) and the steady
state runs uncompiled. The hot plate enters through `base` (W), the heat that reaches it without current, and `total`
(W/K), its conductance to everything around it: base = C_h/δ·T_h + T_s/R_s + T_c/Θ and total = C_h/δ + 1/R_s + 1/Θ,
where δ is the time step (C_h/δ = 0 at rest) and T_s the temperature of the heat sink.
"""

from __future__ import annotations

import math

from ..rig.module import ZERO_C_IN_K

ALPHA, RESISTANCE, CONDUCTANCE, HOT_J_PER_K, COLD_J_PER_K, SINK_C, SINK_W_PER_K, DEEP_C = range(8)
"""Places in `Network.plates` of the module's α V/K, R Ω and 1/Θ W/K, of both heat capacities, of the heat sink's
temperature and 1/R_s, and of the temperature of deep tissue and blood."""

LOWEST_A, HIGHEST_A, COMPLIANCE_V = range(8, 11)
"""Places of the driver's limits."""

SINK_J_PER_K, SINK_KP, SINK_KI, SINK_POWER_W = range(11, 15)
"""Places of a heat sink's own controller: heat capacity (0: the sink is ideal), W/K, W/(K·s), greatest power."""

SINK_AIR_W_PER_K, SINK_START_C, LEG_J_PER_K = range(15, 18)
"""Places of a passive heat sink's conductance to air (0: it is not passive; SINK_C is then the air's temperature), of
its temperature at the start (NaN: where the current and the air leave it), and of the heat capacity of all legs."""

PAST_MOST_COOLING = 18
"""Place of 1 for a loop that does not know at which current its module cools most, and runs to the driver's limit."""

PLATE_NUMBERS = 19

TEMPERATURE, INTEGRAL, POWER, REST_POWER = range(4)
"""Places in the state of a heat sink with a controller: °C, integral of its error K·s, power W now and at rest."""

SINK_NUMBERS = 4


def hot_plate_C(current: float, base: float, total: float, alpha: float, ohm: float) -> float:
    """Hot-plate temperature in °C at a current in A: T_h = (base + αI·273.15 K + I²R/2) / (total − αI)."""
    heat = base + alpha * current * ZERO_C_IN_K + 0.5 * ohm * current * current
    return heat / (total - alpha * current)


def greatest_cooling_A(cold: float, base: float, total: float, alpha: float, ohm: float, leak: float) -> float:
    """Current in A at which the most heat is absorbed; more current than that heats.

    It is below αT_c/R, since the hot plate warms with the current: fixed-point iteration of
    I = (αT_c − (α·T_h + I·R)/Θ / (total − αI)) / R, temperatures in kelvin.
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

    The smaller root of αT_c·I − I²R/2 = heat + (T_h(I) − T_c)/Θ, with T_h from the previous iterate. The iteration
    starts at `guess` (A) and ends when it moves by less than `close` (A).
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
