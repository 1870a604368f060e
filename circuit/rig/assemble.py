"""Assembly of a rig's parts from its file."""

from collections.abc import Sequence
from dataclasses import dataclass

from .faults import sentence
from .module import Peltier
from .modules import ModuleOrigin, module_of
from .parts import Driver, HeatSink, PassiveSink, Probe
from .rigfile import HeatSinkTable, ProbeTable, RigTable, SkinTable
from .skin import STRATUM_CORNEUM, Layer, Skin, usual_depth_mm


@dataclass(frozen=True, slots=True)
class HeatPump:
    """The source of a display's heat by a current: module, the origin of its numbers, heat sink, driver."""

    module: Peltier
    origin: ModuleOrigin
    heat_sink: HeatSink
    driver: Driver


def pump_of(table: RigTable) -> HeatPump | None:
    """Return the module of a rig file with its parts; None for a thermode. Raises ValueError for what cannot be."""
    module, sink, driver = table.module, table.heat_sink, table.driver
    if module is None or sink is None or driver is None:
        return None
    hot_side = _heat_sink(sink, table.ambient.temperature_C)
    lowest = -driver.current_limit_A if driver.current_min_A is None else driver.current_min_A
    limits = lowest, driver.current_limit_A, driver.voltage_limit_V
    found = module_of(module, (hot_side.temperature_C + table.skin.rest_C) / 2, table.source.get("module"))
    return HeatPump(*found, hot_side, Driver(driver.transconductance_A_per_V, *limits, driver.update_Hz))


def _heat_sink(table: HeatSinkTable, room_C: float) -> HeatSink:
    if table.air_resistance_K_per_W is not None:
        assert table.capacity_J_per_K is not None
        air_C = room_C if table.air_C is None else table.air_C
        steady = table.temperature_C is None
        passive = PassiveSink(table.capacity_J_per_K, table.air_resistance_K_per_W, air_C, steady)
        start_C = air_C if table.temperature_C is None else table.temperature_C
        return HeatSink(start_C, table.resistance_K_per_W, passive=passive)
    assert table.temperature_C is not None
    return HeatSink(table.temperature_C, table.resistance_K_per_W)


def skin_of(table: SkinTable) -> Skin:
    """Return the skin of a rig file, with depths from its surface; raises ValueError for what cannot be."""
    thickness = {"thickness_mm"}
    layers = tuple(
        Layer(thickness_m=each.thickness_mm * 1e-3, **each.model_dump(exclude=thickness)) for each in table.layer
    )
    has_corneum = layers[0].name == STRATUM_CORNEUM
    if table.depth_from == STRATUM_CORNEUM and not has_corneum:
        raise ValueError(sentence("parts.depth_from", layer=STRATUM_CORNEUM, first=layers[0].name))
    given = (table.cold_receptor_mm, table.warm_receptor_mm)
    own = table.depth_from is not None or given != (None, None)
    depth_from = table.depth_from or ("surface" if own or not has_corneum else STRATUM_CORNEUM)
    corneum_mm = table.layer[0].thickness_mm if has_corneum else 0.0

    def depth_m(channel: str, given_mm: float | None) -> float:
        usual = given_mm is None and table.depth_from is None
        above_mm = corneum_mm if usual or depth_from == STRATUM_CORNEUM else 0.0
        return (above_mm + (usual_depth_mm(channel) if given_mm is None else given_mm)) * 1e-3

    cold, warm = (depth_m(*each) for each in zip(("cold", "warm"), given, strict=True))
    elements = None if table.elements is None else tuple(table.elements)
    return Skin(table.site, table.rest_C, cold, warm, layers, table.deep_C, elements, depth_from, own)


def probes_of(tables: Sequence[ProbeTable], thickness_m: float) -> tuple[Probe, ...]:
    """Return the probes of a rig file on skin of a thickness in m; raises ValueError for one that cannot be."""
    probes = tuple(Probe(table.name, table.place, table.depth_mm * 1e-3, table.lag_s) for table in tables)
    for place, probe in enumerate(probes):
        if any(probe.name == other.name for other in probes[:place]):
            raise ValueError(sentence("parts.probe_twice", name=probe.name))
        if probe.depth_m > thickness_m * (1 + 1e-12):
            raise ValueError(
                sentence("parts.probe_deep", name=probe.name, depth=probe.depth_m * 1e3, skin=thickness_m * 1e3)
            )
    return probes
