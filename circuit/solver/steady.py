"""Steady states of the circuit."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.module import ZERO_C_IN_K
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from . import network as net
from .network import Network, network_of
from .plates import current_for_heat_A, greatest_cooling_A, hot_plate_C


def _plates(network: Network, in_the_end: bool = False) -> tuple[float, float, float, float, float]:
    """α, R, 1/Θ, and temperature and conductance of what the hot plate rests on in steady state.

    A passive heat sink stays where it starts; `in_the_end`, or where that is not given, it is itself in balance with
    its air, so that the hot plate rests on the air through two resistances in series.
    """
    places = net.ALPHA, net.RESISTANCE, net.CONDUCTANCE, net.SINK_C, net.SINK_W_PER_K
    alpha, ohm, leak, sink, out = (float(network.plates[k]) for k in places)
    if network.passive:
        start, air = float(network.plates[net.SINK_START_C]), float(network.plates[net.SINK_AIR_W_PER_K])
        sink, out = (sink, out * air / (out + air)) if in_the_end or np.isnan(start) else (start, out)
    return alpha, ohm, leak, sink, out


def _column(network: Network) -> tuple[list[float], list[float]]:
    """Return (z, e) with lump[i] = z[i] + e[i] · (the state above it) in steady state."""
    g, perfusion = network.conductance_W_per_K.tolist(), network.perfusion_W_per_K.tolist()  # quicker one by one
    deep, n = network.deep_C, len(perfusion)
    z, e = [deep] * (n + 1), [0.0] * (n + 1)
    for i in range(n - 1, -1, -1):
        diagonal = g[i] + g[i + 1] * (1.0 - e[i + 1]) + perfusion[i]
        z[i] = (perfusion[i] * deep + g[i + 1] * z[i + 1]) / diagonal
        e[i] = g[i] / diagonal
    return z[:n], e[:n]


def state_under_current(network: Network, current_A: float, in_the_end: bool = False) -> Array:
    """Steady state (nodes,) in °C, read-only, under a current; ArithmeticError where it would heat without limit."""
    alpha, ohm, leak, sink, out = _plates(network, in_the_end)
    (z, e), skin = _column(network), float(network.conductance_W_per_K[0])
    zero = hot_plate_C(current_A, out * sink, out + leak, alpha, ohm)
    per_cold = leak / (out + leak - alpha * current_A)
    diagonal = leak * (1.0 - per_cold) + alpha * current_A + skin * (1.0 - e[0])
    if out + leak - alpha * current_A <= 0 or diagonal <= 0:
        raise ArithmeticError(f"{current_A:g} A has no steady state on this rig: it heats without limit")
    cold = (leak * zero - alpha * current_A * ZERO_C_IN_K + 0.5 * ohm * current_A**2 + skin * z[0]) / diagonal
    hot = zero + per_cold * cold
    nodes = [hot, cold]
    for offset, share in zip(z, e, strict=True):
        nodes.append(offset + share * nodes[-1])
    if network.passive:
        nodes.append(hot - out * (hot - sink) / float(network.plates[net.SINK_W_PER_K]))
    state = np.array([*nodes, network.deep_C])
    state.setflags(write=False)
    return state


def holding_current_A(network: Network, control: str, level_C: float) -> float:
    """Current in A that holds `skin` or `display` at a level in °C: that of greatest cooling where none is enough."""
    alpha, ohm, leak, sink, out = _plates(network)
    z, e = _column(network)
    cold = level_C
    if control == "skin":
        share = network.face_share  # the face lies between the cold plate and the first lump
        offset, to_cold = (1.0 - share) * z[0], share + (1.0 - share) * e[0]
        cold = (level_C - offset) / to_cold
    heat = float(network.conductance_W_per_K[0]) * (z[0] + (e[0] - 1.0) * cold)
    base, total = out * sink + leak * cold, out + leak
    greatest = greatest_cooling_A(cold, base, total, alpha, ohm, leak)
    return current_for_heat_A(heat, cold, base, total, alpha, ohm, leak, greatest, 0.0, 1e-13)


@lru_cache(maxsize=256)
def steady_state(rig: Rig, control: str, level_C: float) -> tuple[float, Array]:
    """The current in A, and the temperatures (nodes,) in °C, read-only, that hold a baseline of `skin` or `display`.

    Raises RigError where the module, the driver or the heat sink cannot hold it, with the limit and a cure.

    >>> current, state = steady_state(Rig.load("thenar"), "skin", 32.0)
    >>> round(current, 2)
    0.08
    """
    network = network_of(rig)
    what = f"rig {rig.name}: a baseline of {level_C:g} °C on the {control} cannot be held"
    current = holding_current_A(network, control, level_C)
    try:
        state = state_under_current(network, current)
    except ArithmeticError as problem:
        raise RigError(f"{what}: {problem}") from None
    reached = network.read(state, "skin_C" if control == "skin" else "display_C")
    driver = rig.driver
    if not abs(reached - level_C) <= 1e-6:
        raise RigError(f"{what}: the module cools it to {reached:.1f} °C at most; use a warmer baseline")
    if not driver.current_min_A - 1e-12 <= current <= driver.current_max_A + 1e-12:
        raise RigError(
            f"{what}: it needs {current:.3f} A, the driver gives {driver.current_min_A:g} … "
            f"{driver.current_max_A:g} A; choose a baseline nearer to rest or a wider current limit"
        )
    voltage = rig.module.voltage_V(current, float(state[net.COLD]), float(state[net.HOT]))
    if abs(voltage) > driver.voltage_limit_V:
        raise RigError(
            f"{what}: it needs {voltage:.2f} V, the driver gives at most {driver.voltage_limit_V:g} V; "
            f"choose a baseline nearer to rest or a higher driver.voltage_limit_V"
        )
    return float(current), state


def steady_of(rig: Rig, duty: float, peak_A: float) -> Array:
    """Steady state in °C of a duty D without ripple: the mean square of the current is D·Ip², as if R were R/D."""
    network = network_of(rig)
    if duty == 0:
        return state_under_current(network, 0.0)
    plates = network.plates.copy()
    plates[net.RESISTANCE] /= abs(duty)
    return state_under_current(replace(network, plates=plates), duty * peak_A)
