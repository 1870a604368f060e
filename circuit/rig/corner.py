"""A rig at one corner of its uncertainty."""

import json
import math
from dataclasses import replace

from thermicon.base.words.number_text import signed

from .faults import sentence
from .module import ZERO_C_IN_K, Peltier
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
    """Return a rig whose numbers deviate from those of its file, beyond whose bounds they may lie.

    Relative arguments are shares (−0.3 is 30 % less), `_K` are kelvins; the air of a passive sink moves with it.
    Bare skin rests as given; blood is solved again where the rig solves it.
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
    contact, ambient_C = rig.contact, rig.ambient.temperature_C + ambient_K
    contact = replace(contact, resistance_m2K_per_W=contact.resistance_m2K_per_W * (1.0 + contact_resistance_relative))
    ambient, pump = rig.ambient.model_copy(update={"temperature_C": ambient_C}), rig.pump
    if pump is not None:
        sink, passive = pump.heat_sink, pump.heat_sink.passive
        other_air = passive and replace(passive, air_C=passive.air_C + heat_sink_K)  # that is what it tends to
        sink = replace(sink, temperature_C=sink.temperature_C + heat_sink_K, passive=other_air)
        module = _module(rig, seebeck_relative, conductance_relative, plates_relative)
        pump = replace(pump, heat_sink=sink, module=module)
    # Caches are keyed by the document.
    document = json.loads(rig.document) | {"corner": {**shares, "ambient": ambient_K, "heat sink": heat_sink_K}}
    text, deep_C = json.dumps(document, sort_keys=True, ensure_ascii=False), rig.deep_C
    if ambient_K:
        deep_C = _deep_C(rig, ambient_C)
    return replace(rig, contact=contact, ambient=ambient, deep_C=deep_C, pump=pump, document=text)


def with_gain(rig: Rig, gain_relative: float) -> Rig:
    """Return a rig whose driver saturates where a source does whose gain deviates by a share."""
    if not gain_relative:
        return rig
    assert rig.pump is not None
    document, driver, factor = json.loads(rig.document), rig.driver, 1.0 + gain_relative
    low, high = driver.current_min_A * factor, driver.current_max_A * factor
    document["driver"] |= {"current_min_A": low, "current_limit_A": high}
    pump = replace(rig.pump, driver=replace(driver, current_min_A=low, current_max_A=high))
    return replace(rig, pump=pump, document=json.dumps(document, sort_keys=True, ensure_ascii=False))


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
        )
    except ValueError as problem:  # a share so large that nothing finite is left
        raise RigError(f"rig {rig.name}, in one corner: {problem}; use less") from None


def _check(rig: Rig, shares: dict[str, float], shifts: dict[str, tuple[float, float]]) -> None:
    faults = []
    for name, share in shares.items():
        if not (math.isfinite(share) and share > -1.0):
            faults.append(f"{name} {signed(100 * share)} %: must be finite and leave more than nothing, above −100 %")
    for name, (shift, nominal) in shifts.items():
        if not (math.isfinite(shift) and nominal + shift > -ZERO_C_IN_K):
            by, least = f"{name} {signed(shift)} K from {signed(nominal)} °C", signed(-ZERO_C_IN_K)
            faults.append(f"{by}: must be finite and stay above absolute zero, {least} °C")
    if not faults and (deep := _deep_C(rig, sum(shifts["ambient"]))) <= -ZERO_C_IN_K:
        said = {"shift": signed(shifts["ambient"][0]), "deep": signed(deep), "rest": signed(rig.skin.rest_C)}
        faults.append(sentence("parts.deep", **said))
    if faults:
        raise RigError("\n".join(f"rig {rig.name}, in one corner: {fault}; use less" for fault in faults))
