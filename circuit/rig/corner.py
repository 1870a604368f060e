"""A rig at one corner of its uncertainty, which may exceed the limits of a rig file."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

from thermicon.icons.number_text import signed

from .faults import PARAMETERS
from .module import ZERO_C_IN_K, Peltier
from .parts import HeatSink
from .rig import Rig
from .rigfile import RigError


def perturbed(
    rig: Rig,
    *,
    contact_resistance_relative: float = 0.0,
    ambient_K: float = 0.0,
    heat_sink_K: float = 0.0,
    seebeck_relative: float = 0.0,
    conductance_relative: float = 0.0,
    plates_relative: float = 0.0,
) -> Rig:
    """Return a rig whose numbers deviate from those of its file.

    The bounds of a rig file do not apply to these numbers, but what is physically impossible is refused. Blood and deep
    tissue are solved again where the rig solves them, since the resting temperature of bare skin stays as given. The
    module's parameters stay those at the given heat sink temperature, even where they depend on it.

    Shares: `contact_resistance_relative` (−0.3 is 30 % less), `seebeck_relative` and `conductance_relative` of the
    module (its thermal resistance goes the other way), `plates_relative` of the heat capacities of both plates and of
    the legs. In K: `ambient_K` of the room air, `heat_sink_K` of the heat sink, of the set point of its controller, or
    of a passive sink and the air around it.
    Raises RigError where a share leaves nothing (−1 or less), a temperature falls to absolute zero or a factor is not
    finite.

    >>> rig = Rig.load("thenar")
    >>> there = perturbed(rig, contact_resistance_relative=-0.3, ambient_K=3.0)
    >>> round(there.contact.resistance_m2K_per_W, 7), there.ambient.temperature_C, round(there.deep_C, 3)
    (0.000378, 27.0, 33.609)
    >>> round(perturbed(rig, conductance_relative=0.25).module.thermal_resistance_K_per_W, 3)
    5.248

    """
    shares = {
        "contact resistance": contact_resistance_relative,
        "Seebeck coefficient": seebeck_relative,
        "thermal conductance": conductance_relative,
        "plates": plates_relative,
    }
    shifts = {"ambient": (ambient_K, rig.ambient.temperature_C)}
    if heat_sink_K or rig.pump is not None:
        shifts["heat sink"] = (heat_sink_K, rig.heat_sink.temperature_C)
    _check(rig, shares, shifts)
    if not any((*shares.values(), ambient_K, heat_sink_K)):
        return rig
    document, changed = json.loads(rig.document), rig
    if contact_resistance_relative:
        resistance = rig.contact.resistance_m2K_per_W * (1.0 + contact_resistance_relative)
        document["contact"]["resistance_m2K_per_W"] = resistance
        changed = replace(changed, contact=replace(rig.contact, resistance_m2K_per_W=resistance))
    if ambient_K:
        ambient = replace(rig.ambient, temperature_C=rig.ambient.temperature_C + ambient_K)
        document["ambient"]["temperature_C"] = ambient.temperature_C
        if rig.pump is not None and rig.heat_sink.passive is not None:  # its air does not follow the room's
            document["heat_sink"]["air_C"] = rig.heat_sink.passive.air_C
        changed = replace(changed, ambient=ambient, deep_C=_deep_C(rig, ambient.temperature_C))
    if heat_sink_K:
        sink = _warmer(rig.heat_sink, heat_sink_K)
        document["heat_sink"] |= _temperatures(sink)
        changed = _pumped(changed, heat_sink=sink)
    if seebeck_relative or conductance_relative or plates_relative:
        module = _module(rig, seebeck_relative, conductance_relative, plates_relative)
        document["module"] = _module_table(module)
        changed = _pumped(changed, module=module)
    return replace(changed, document=json.dumps(document, sort_keys=True, ensure_ascii=False))


def with_gain(rig: Rig, gain_relative: float) -> Rig:
    """Return a rig whose driver saturates where a source does whose gain deviates by a share: at limits as they flow.

    >>> with_gain(Rig.load("thenar"), 0.1).driver.current_max_A
    1.6500000000000001
    """
    if not gain_relative:
        return rig
    assert rig.pump is not None
    document, driver, factor = json.loads(rig.document), rig.driver, 1.0 + gain_relative
    low, high = driver.current_min_A * factor, driver.current_max_A * factor
    document["driver"] |= {"current_min_A": low, "current_limit_A": high}
    flowing = replace(driver, current_min_A=low, current_max_A=high)
    return replace(
        rig,
        pump=replace(rig.pump, driver=flowing),
        document=json.dumps(document, sort_keys=True, ensure_ascii=False),
    )


def _pumped(rig: Rig, *, heat_sink: HeatSink | None = None, module: Peltier | None = None) -> Rig:
    """The rig with another heat sink or module."""
    assert rig.pump is not None
    return replace(rig, pump=replace(rig.pump, heat_sink=heat_sink or rig.heat_sink, module=module or rig.module))


def _warmer(sink: HeatSink, shift_K: float) -> HeatSink:
    """The heat sink at another temperature; a passive one in other air too, since that is what it tends to."""
    passive = sink.passive and replace(sink.passive, air_C=sink.passive.air_C + shift_K)
    return replace(sink, temperature_C=sink.temperature_C + shift_K, passive=passive)


def _temperatures(sink: HeatSink) -> dict[str, float]:
    """The keys of a rig file that hold the temperatures of a heat sink."""
    if sink.passive is None:
        return {"temperature_C": sink.temperature_C}
    start = {} if sink.passive.steady else {"temperature_C": sink.temperature_C}
    return {**start, "air_C": sink.passive.air_C}


def _deep_C(rig: Rig, ambient_C: float) -> float:
    """Blood and deep tissue in °C in air of another temperature: as given, or solved so that bare skin rests."""
    if rig.skin.deep_C is not None:
        return rig.skin.deep_C
    loss = rig.ambient.film_W_per_m2K * (rig.skin.rest_C - ambient_C)
    return float(rig.skin.rest_C - rig.column.steady_drop_K(-loss))


def _module(rig: Rig, seebeck: float, conductance: float, plates: float) -> Peltier:
    nominal = rig.module
    try:
        return Peltier(
            nominal.seebeck_V_per_K * (1.0 + seebeck),
            nominal.resistance_ohm,
            nominal.thermal_resistance_K_per_W / (1.0 + conductance),
            nominal.hot_plate_J_per_K * (1.0 + plates),
            nominal.cold_plate_J_per_K * (1.0 + plates),
            nominal.leg_nodes,
            nominal.leg_capacity_J_per_K * (1.0 + plates),
        )
    except ValueError as problem:  # a share so large that nothing finite is left
        raise RigError(f"rig {rig.name}, one corner of it: {problem}; use less") from None


def _module_table(module: Peltier) -> dict[str, Any]:
    legs = ("leg_nodes", "leg_capacity_J_per_K") if module.leg_nodes else ()
    return {key: getattr(module, key) for key in (*PARAMETERS, "hot_plate_J_per_K", "cold_plate_J_per_K", *legs)}


def _check(rig: Rig, shares: dict[str, float], shifts: dict[str, tuple[float, float]]) -> None:
    """Raise RigError with every impossible factor, a line each."""
    faults = []
    for name, share in shares.items():
        if not (math.isfinite(share) and share > -1.0):
            faults.append(f"{name} {signed(100 * share)} %: must be finite and leave more than nothing, above −100 %")
    for name, (shift, nominal) in shifts.items():
        if not (math.isfinite(shift) and nominal + shift > -ZERO_C_IN_K):
            faults.append(
                f"{name} {signed(shift)} K from {signed(nominal)} °C: must be finite and stay above absolute zero, "
                f"{signed(-ZERO_C_IN_K)} °C"
            )
    if not faults and (deep := _deep_C(rig, sum(shifts["ambient"]))) <= -ZERO_C_IN_K:
        faults.append(
            f"ambient {signed(shifts['ambient'][0])} K: blood and deep tissue would have to be at {signed(deep)} °C, "
            f"below absolute zero, for bare skin to rest at {signed(rig.skin.rest_C)} °C"
        )
    if faults:
        raise RigError("\n".join(f"rig {rig.name}, one corner of it: {fault}; use less" for fault in faults))
