"""Closed-form checks of a cue on a rig, without simulation: levels, rates, and whether the baseline can be held."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

from thermicon.icons import Icon
from thermicon.icons.model.corners import Corners
from thermicon.icons.number_text import decimals, significant

from ..rig.module import ZERO_C_IN_K
from ..rig.rig import Rig
from ..rig.rigfile import RigError, Thermode
from .displayed import refuse_current
from .inverse import baseline_C
from .modes import modes_of
from .network import COLD, HOT, network_of
from .steady import holding_current_A, state_under_current, steady_state

WARMEST_COLD_PLATE_K = 320.0
"""αT/R at this temperature, above that of any display, bounds the search for the coldest level: more current heats."""


def check_static(icon: Icon, rig: Rig) -> tuple[str, ...]:
    """The reasons why a cue is impossible on a rig, a sentence each, without simulating it.

    Checked are the baseline, the lowest and the highest level (the rig must be able to hold each in steady state) and,
    under display control, each ramp against the steepest that the driver can start from rest at its first level.

    >>> from thermicon.icons import load_library
    >>> check_static(load_library("six-icons")["cooling-step"], Rig.load("thenar"))
    ()
    """
    control = icon.context.control
    if rig.thermode is not None:
        return _on_thermode(icon, rig, rig.thermode)
    try:
        start_A, _ = steady_state(rig, "skin" if control == "skin" else "display", baseline_C(icon, rig))
    except RigError as problem:
        return (f"icon {icon.name}: {problem}",)
    driver, reasons = rig.driver, []
    if control == "current":
        corners = icon.corners(start_A)
        for level in (corners.lowest, corners.highest):
            if not driver.current_min_A <= level <= driver.current_max_A:
                reasons.append(
                    f"icon {icon.name}: {level:g} A is outside the driver's {driver.current_min_A:g} … "
                    f"{driver.current_max_A:g} A; change the cue or driver.current_limit_A"
                )
        return tuple(reasons)
    corners = icon.corners(baseline_C(icon, rig))
    low, high = _holdable(rig, control)
    for level in (corners.lowest, corners.highest):
        if not low - 1e-9 <= level <= high + 1e-9:
            digits = decimals(level, low if level < low else high, 1)
            reasons.append(
                f"icon {icon.name}: {level:g} °C on the {control} is outside the {low:.{digits}f} … {high:.{digits}f} "
                f"°C that rig {rig.name} can hold; use a smaller change or a higher driver.current_limit_A"
            )
    if control == "display" and not reasons:
        reasons += _too_fast(icon, rig, corners)
    return tuple(reasons)


def _on_thermode(icon: Icon, rig: Rig, thermode: Thermode) -> tuple[str, ...]:
    """As `check_static`, for the range and ramp rate of a thermode; skin levels by the display that holds them."""
    control, modes, base = icon.context.control, modes_of(rig), baseline_C(icon, rig)
    try:
        refuse_current(icon, f"rig {rig.name}")
    except RigError as problem:
        return (f"icon {icon.name}: {problem}",)
    corners, reasons = icon.corners(base), []
    for level in dict.fromkeys((base, corners.lowest, corners.highest)):
        needed = modes.display_holding_skin_C(level) if control == "skin" else level
        if not thermode.lowest_C - 1e-9 <= needed <= thermode.highest_C + 1e-9:
            digits = decimals(needed, thermode.lowest_C if needed < thermode.lowest_C else thermode.highest_C, 1)
            reasons.append(
                f"icon {icon.name}: {level:g} °C on the {control} needs a display of {needed:.{digits}f} °C, outside "
                f"the {thermode.lowest_C:g} … {thermode.highest_C:g} °C of thermode {rig.name}; use a smaller change"
            )
    for time, _, rate in _ramps(corners) if control == "display" else ():
        if abs(rate) > thermode.slew_K_per_s * (1 + 1e-9):
            reasons.append(
                f"icon {icon.name}: {abs(rate):.3g} °C/s of {'cooling' if rate < 0 else 'warming'} at {time:g} s is "
                f"more than the {thermode.slew_K_per_s:g} °C/s of thermode {rig.name}; slow it down"
            )
    return tuple(reasons)


def _holdable(rig: Rig, control: str) -> tuple[float, float]:
    """Lowest and highest level in °C that the rig can hold, within current and voltage."""
    network, driver = network_of(rig), rig.driver
    probe = "skin_C" if control == "skin" else "display_C"

    def level(current: float) -> float:
        return network.read(state_under_current(network, current), probe)

    def volts(current: float) -> float:
        state = state_under_current(network, current)
        return rig.module.voltage_V(current, float(state[COLD]), float(state[HOT]))

    most = rig.module.seebeck_V_per_K * WARMEST_COLD_PLATE_K / rig.module.resistance_ohm
    coldest = _coldest(level, min(driver.current_max_A, most))
    coldest = _within(coldest, lambda current: volts(current) <= driver.voltage_limit_V)
    warmest = _within(
        driver.current_min_A, lambda current: _exists(rig, current) and -volts(current) <= driver.voltage_limit_V
    )
    return level(coldest), level(warmest)


def _coldest(level: Callable[[float], float], most: float) -> float:
    """Current up to `most` of the lowest steady level, which has one minimum: golden section."""
    low, high = 0.0, most
    for _ in range(60):
        a, b = high - 0.618034 * (high - low), low + 0.618034 * (high - low)
        low, high = (low, b) if level(a) < level(b) else (a, high)
    return most if level(most) <= level(high) else high


def _exists(rig: Rig, current: float) -> bool:
    try:
        state_under_current(network_of(rig), current)
    except ArithmeticError:
        return False
    return True


def _within(current: float, allowed: Callable[[float], bool]) -> float:
    """The allowed current nearest to the given one, towards 0."""
    if allowed(current):
        return current
    good, bad = 0.0, current
    for _ in range(60):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if allowed(middle) else (good, middle)
    return good


def _too_fast(icon: Icon, rig: Rig, corners: Corners) -> list[str]:
    """Sentences for the ramps that are steeper than the driver can begin them from rest at their first level."""
    reasons = []
    for time, level, rate in _ramps(corners):
        limit = _steepest(rig, level, cooling=rate < 0)
        if abs(rate) > limit:
            wanted, possible = significant(abs(rate), limit)
            reasons.append(
                f"icon {icon.name}: {wanted} °C/s of {'cooling' if rate < 0 else 'warming'} at {time:g} s "
                f"is more than the {possible} °C/s that rig {rig.name} can begin with at {level:g} °C; slow it down"
            )
    return reasons


def _ramps(corners: Corners) -> Iterator[tuple[float, float, float]]:
    """Start in s, first level and rate of each ramp; a step is as fast as the driver can, whatever that is."""
    points = zip(corners.time_s, corners.value, strict=True)
    for place, ((time, level), (later, to)) in enumerate(itertools.pairwise(points)):
        if place not in corners.steps:
            yield time, level, (to - level) / (later - time)


def _steepest(rig: Rig, level_C: float, cooling: bool) -> float:
    """Steepest fall or rise in K/s of a display at rest at a level, at the driver's limits."""
    module, driver, network = rig.module, rig.driver, network_of(rig)
    state = state_under_current(network, holding_current_A(network, "display", level_C))
    hot, cold = float(state[HOT]), float(state[COLD])
    from_skin = float(network.conductance_W_per_K[0]) * float(state[COLD + 1] - state[COLD])
    seebeck = module.seebeck_V_per_K * (hot - cold)
    if cooling:
        best = module.seebeck_V_per_K * (cold + ZERO_C_IN_K) / module.resistance_ohm
        current = min(driver.current_max_A, best, (driver.voltage_limit_V - seebeck) / module.resistance_ohm)
    else:
        current = max(driver.current_min_A, (-driver.voltage_limit_V - seebeck) / module.resistance_ohm)
    return abs(from_skin - module.heat_absorbed_W(current, cold, hot)) / module.cold_plate_J_per_K
