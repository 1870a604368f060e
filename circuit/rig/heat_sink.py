"""The heat sink of a rig file: ideal, under a controller of its own, or passive and cooled by air."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .parts import HeatSink, PassiveSink, SinkController

if TYPE_CHECKING:
    from .rigfile import HeatSinkTable

CONTROLLED = ("capacity_J_per_K", "kp_W_per_K", "ki_W_per_Ks", "power_limit_W")
"""Keys of a heat sink with its own controller, all of which it needs."""


def heat_sink_faults(table: HeatSinkTable) -> list[str]:
    """Return one sentence for each fault in the keys of a heat sink."""
    passive, faults = table.air_resistance_K_per_W is not None, []
    if table.temperature_C is None and not passive:
        faults.append("heat_sink.temperature_C is missing; add it, in °C")
    if not passive:
        if table.air_C is not None:
            faults.append(
                f"heat_sink.air_C = {table.air_C:g} °C: belongs to a passive heat sink; add heat_sink.capacity_J_per_K "
                f"and heat_sink.air_resistance_K_per_W, or remove it"
            )
        return faults
    if both := [f"heat_sink.{key}" for key in CONTROLLED[1:] if getattr(table, key) is not None]:
        faults.append(
            f"heat_sink.air_resistance_K_per_W: a passive heat sink has no controller; remove it or {', '.join(both)}"
        )
    elif table.capacity_J_per_K is None:
        faults.append(
            "heat_sink.capacity_J_per_K is missing; a passive heat sink needs it, in J/K (100 g of aluminium: 90 J/K)"
        )
    return faults


def heat_sink_of(table: HeatSinkTable, room_C: float) -> HeatSink:
    """Return the heat sink of a rig file in a room; raises ValueError for a controller with a key missing."""
    if table.air_resistance_K_per_W is not None:
        assert table.capacity_J_per_K is not None
        air_C = room_C if table.air_C is None else table.air_C
        steady = table.temperature_C is None
        passive = PassiveSink(table.capacity_J_per_K, table.air_resistance_K_per_W, air_C, steady)
        start_C = air_C if table.temperature_C is None else table.temperature_C
        return HeatSink(start_C, table.resistance_K_per_W, passive=passive)
    assert table.temperature_C is not None
    settings = {name: getattr(table, name) for name in CONTROLLED}
    missing = [name for name, value in settings.items() if value is None]
    if not missing:
        return HeatSink(table.temperature_C, table.resistance_K_per_W, SinkController(**settings))
    if len(missing) < len(CONTROLLED):
        raise ValueError(
            f"heat_sink.{missing[0]} is missing; a hot plate under its own control needs {', '.join(CONTROLLED)}; "
            f"without all four it is ideal, or with heat_sink.air_resistance_K_per_W and a capacity passive"
        )
    return HeatSink(table.temperature_C, table.resistance_K_per_W)
