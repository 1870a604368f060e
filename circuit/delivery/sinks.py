"""Heat of the other elements on a shared heat sink."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.icons import Icon

from ..rig.layout import Element, Layout
from ..rig.layoutfile import Sink
from ..rig.module import ZERO_C_IN_K
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..solver.trace import Trace
from .device import Device
from .devicefile import DeviceError
from .ways import deliver

MOST_K = 20.0
"""No verdict covers a sink that is farther off, as `uncertainty.heat_sink_K` of a rig file says."""
ROUNDS, NEARLY = 20, 1.01
"""A warmer sink needs more current, which warms it: so often, until it grows by a hundredth."""


def judged_rigs(layout: Layout, tracks: Iterable[Icon], device: Device) -> dict[str, Rig]:
    """The rig of each element as it is judged: on a shared sink in the corners that the others' heat makes of it.

    Raises DeviceError for a current that nothing corrects, RigError where a sink gets farther off than is judged.
    """
    played = tuple(tracks)
    shared = {sink: [one for one in layout.elements if one.sink == sink.name] for sink in layout.sinks}
    rigs = {element.name: element.rig for element in layout.elements}
    for sink, there in shared.items():
        if len(there) > 1 and not device.kind.regulated:
            raise DeviceError(
                f"{device.name} sends {device.driven_by}, and {', '.join(one.name for one in there)} share the sink "
                f"{sink.name}, so that the heat of one moves the others and nothing corrects it; use the device "
                "closed-loop-controller in the format setpoint-csv, or give each element a sink of its own"
            )
        if device.driven_by != "temperatures":
            continue  # a thermode keeps its own heat
        for element, more_K in zip(there, _warmer_K(there, sink, played, device), strict=True):
            own_K = element.rig.uncertainty.heat_sink_K
            if own_K + more_K > MOST_K:
                enough = _judged_sink(there, sink, played, device).resistance_K_per_W
                raise RigError(
                    f"the sink {sink.name}: the other elements change it by up to {more_K:.3g} K under {element.name}, "
                    f"known to {own_K:g} K by itself, and {MOST_K:g} K are judged; use a sink of {enough:g} "
                    "K/W, smaller changes, or fewer elements, or give its capacity_J_per_K"
                )
            rigs[element.name] = element.rig.with_(**{"uncertainty.heat_sink_K": own_K + more_K})
    return rigs


def _judged_sink(elements: Sequence[Element], sink: Sink, tracks: Sequence[Icon], device: Device) -> Sink:
    """The sink with so small a resistance, of two digits, that its elements are judged; the last that was tried."""
    allowed_K = [MOST_K - element.rig.uncertainty.heat_sink_K for element in elements]
    for _ in range(ROUNDS):
        warmer_K = _warmer_K(elements, sink, tracks, device)
        if all(more <= allowed for more, allowed in zip(warmer_K, allowed_K, strict=True)):
            break
        share = min(0.9 * allowed / more for more, allowed in zip(warmer_K, allowed_K, strict=True))
        smaller = float(f"{max(share, 0.1) * sink.resistance_K_per_W:.2g}")
        sink = sink.model_copy(update={"resistance_K_per_W": smaller})
    return sink


def _warmer_K(elements: Sequence[Element], sink: Sink, tracks: Sequence[Icon], device: Device) -> list[float]:
    """By how much the heat of the others changes a sink under each element, either way, in any plays of theirs."""
    warmer_K = [0.0] * len(elements)
    known: dict[tuple[Rig, float], float] = {}
    for _ in range(ROUNDS):
        own_K = []
        for element, by_K in zip(elements, warmer_K, strict=True):
            if (element.rig, by_K) not in known:
                rig = on_warmer(element.rig, by_K)
                heats = [deliver(icon, rig, device).trace for icon in tracks]
                known[element.rig, by_K] = warms_K(heats, rig, sink)
            own_K.append(known[element.rig, by_K])
        before, warmer_K = warmer_K, [sum(own_K) - own for own in own_K]
        if all(now <= NEARLY * then or now > MOST_K for then, now in zip(before, warmer_K, strict=True)):
            break
    return warmer_K


def on_warmer(rig: Rig, by_K: float) -> Rig:
    """A rig on a warmer sink, whose air is as much warmer where it is passive."""
    sink = rig.heat_sink
    changes = {"heat_sink.temperature_C": sink.temperature_C + by_K}
    if sink.passive is not None:
        changes["heat_sink.air_C"] = sink.passive.air_C + by_K
    return rig.with_(**changes) if by_K else rig


def warms_K(plays: Sequence[Trace], rig: Rig, sink: Sink) -> float:
    """How far one element moves its sink at most, in any order of plays.

    Without a capacity of the sink it is R·P at the peak P of the heat. A capacity C lets it follow the mean instead,
    R·P̄, and swing about that by what a play stores and returns, the range of ∫(P − P̄)dt, over C.
    """
    heats_W = [heat_W(trace, rig) for trace in plays]
    peak_K = sink.resistance_K_per_W * max(float(np.abs(heat).max()) for heat in heats_W)
    if sink.capacity_J_per_K is None:
        return peak_K
    means = [float(heat.mean()) for heat in heats_W]
    stored_J = [
        float(np.ptp(np.cumsum((heat - mean)[1:] * np.diff(trace.time_s))))
        for heat, mean, trace in zip(heats_W, means, plays, strict=True)
    ]
    mean_K = sink.resistance_K_per_W * max(map(abs, means))
    return min(peak_K, mean_K + max(stored_J) / sink.capacity_J_per_K)


def heat_W(trace: Trace, rig: Rig) -> Array:
    """Heat from the module into its sink in W (rows,): α·I·T_h + ½·R·I² − K·(T_h − T_c), plates at rest."""
    module, hot_C, current_A = rig.module, trace.hot_plate_C, trace.current_A
    pumped = module.seebeck_V_per_K * current_A * (hot_C + ZERO_C_IN_K) + 0.5 * module.resistance_ohm * current_A**2
    return np.asarray(pumped - (hot_C - trace.display_C) / module.thermal_resistance_K_per_W)
