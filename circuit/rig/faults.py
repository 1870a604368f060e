"""Faults between keys of a rig file: what is missing, and what rules each other out, one sentence for each."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .load import LoadTable
    from .rigfile import HeatSinkTable, ModuleTable, RigTable

PARAMETERS = {"seebeck_V_per_K": "V/K", "resistance_ohm": "Ω", "thermal_resistance_K_per_W": "K/W"}
"""The three parameters of a module in a rig file, with their units."""

CONTROLLED = ("capacity_J_per_K", "kp_W_per_K", "ki_W_per_Ks", "power_limit_W")
"""Keys of a heat sink with its own controller, all of which it needs."""


def rig_faults(table: RigTable) -> list[str]:
    """Faults between tables of a rig file: of what warms and cools the display, else of a load, else of a landing."""
    return list(_display(table)) or list(_load(table)) or list(_landing(table))


def _display(table: RigTable) -> Iterator[str]:
    """A module with its parts, or a thermode: never both."""
    pumped = {key: getattr(table, key) for key in ("module", "heat_sink", "driver", "controller")}
    given = [key for key, part in pumped.items() if part is not None]
    missing = [key for key in ("module", "heat_sink", "driver") if pumped[key] is None]
    if table.thermode is not None and given:
        yield (
            f"thermode: a thermode has a loop of its own, so the rig has no {' and no '.join(given)}; remove "
            f"{', '.join(f'[{key}]' for key in given)} or [thermode]"
        )
    elif table.thermode is None and len(missing) == 3:
        yield "module is missing; add [module], [heat_sink] and [driver], or a [thermode] in their place"
    elif table.thermode is None:
        yield from (f"{key} is missing; add it" for key in missing)


def _load(table: RigTable) -> Iterator[str]:
    """What goes with a load in place of skin."""
    if table.load is None:
        return
    yield from _load_keys(table.load)
    if table.thermode is not None:
        yield "load: a thermode keeps its display at the set-points on any load; remove [load] or [thermode]"
    if table.contact.lands_s is not None:
        yield "contact.lands_s: there is no hand to land where the display touches a load; remove it or [load]"
    deep = [probe.name for probe in table.probe if probe.place not in ("display", "interface")]
    if deep:
        yield f'probe {deep[0]}: there is no skin on a rig with [load]; use place = "display" or "interface"'


def _load_keys(load: LoadTable) -> Iterator[str]:
    metal = {"capacity_J_per_K": load.capacity_J_per_K, "conductance_W_per_K": load.conductance_W_per_K}
    given = [key for key, value in metal.items() if value is not None]
    if load.film_W_per_m2K is not None and given:
        yield f"load.film_W_per_m2K belongs to air, load.{given[0]} to a block of metal; remove one of them"
    elif load.film_W_per_m2K is None and not given:
        yield (
            "load: give capacity_J_per_K and conductance_W_per_K (to the room) of a block of metal, or film_W_per_m2K "
            "of air"
        )
    elif load.film_W_per_m2K is None and len(given) == 1:
        yield f"load.{next(key for key in metal if key not in given)} is missing; add it"


def _landing(table: RigTable) -> Iterator[str]:
    """Parts of a rig that start at rest, where a hand lands."""
    sink, insulated = table.heat_sink, any(probe.place == "insulated skin" for probe in table.probe)
    apart = {
        "a thermode, whose skin starts at rest under it; remove it or use a rig with a module": table.thermode
        is not None,
        "a heat sink with a controller of its own, whose loop starts at rest; remove one of them": sink is not None
        and sink.power_limit_W is not None,
        'a probe on "insulated skin", whose skin starts at rest; remove one of them': insulated,
    }
    if table.contact.lands_s is not None:
        yield from (f"contact.lands_s: cannot be combined with {fault}" for fault, there in apart.items() if there)


def heat_sink_faults(table: HeatSinkTable) -> Iterator[str]:
    """Faults in the keys of a heat sink."""
    passive = table.air_resistance_K_per_W is not None
    both = [f"heat_sink.{key}" for key in CONTROLLED[1:] if getattr(table, key) is not None]
    if table.temperature_C is None and not passive:
        yield "heat_sink.temperature_C is missing; add it, in °C"
    if table.air_C is not None and not passive:
        yield (
            f"heat_sink.air_C = {table.air_C:g} °C: belongs to a passive heat sink; add heat_sink.capacity_J_per_K "
            f"and heat_sink.air_resistance_K_per_W, or remove it"
        )
    if passive and both:
        yield f"heat_sink.air_resistance_K_per_W: a passive heat sink has no controller; remove it or {', '.join(both)}"
    elif passive and table.capacity_J_per_K is None:
        yield "heat_sink.capacity_J_per_K is missing; a passive heat sink needs it, in J/K (100 g of aluminium: 90 J/K)"


def module_faults(table: ModuleTable) -> Iterator[str]:
    """Faults in how a rig file gives its module: by parameters, data sheets or a name, and its legs."""
    stated = [key for key in PARAMETERS if getattr(table, key) is not None]
    ways = [*stated[:1], *(key for key in ("datasheet", "name") if getattr(table, key) is not None)]
    missing = [key for key in PARAMETERS if stated and key not in stated]
    if not ways:
        yield (
            f"module: no module is stated; give {', '.join(PARAMETERS)}, "
            f"or one or two [[module.datasheet]], or the name of a shipped module"
        )
    elif len(ways) > 1:
        yield f"module: {' and '.join(ways)} are two ways of giving it; keep one and remove the other"
    elif missing or (stated and table.extraction is not None):
        yield from (f"module.{key} is missing; add it, in {PARAMETERS[key]}" for key in missing)
        if table.extraction is not None:
            yield "module.extraction: only for a data sheet or a name; remove the key"
    elif table.datasheet is not None and len(table.datasheet) not in (1, 2):
        yield f"module.datasheet: {len(table.datasheet)} tables; give one, or two for two hot-side temperatures"
    elif table.leg_nodes and table.leg_capacity_J_per_K is None:
        yield (
            "module.leg_capacity_J_per_K is missing; legs that are divided into nodes need it, in J/K: volume of all "
            "legs times some 1.2e6 J/(m³·K) (127 couples of 1.0 x 1.0 x 2.5 mm legs: 0.76 J/K)"
        )
    elif table.leg_capacity_J_per_K is not None and not table.leg_nodes:
        yield (
            f"module.leg_capacity_J_per_K = {table.leg_capacity_J_per_K:g} J/K: has no effect while module.leg_nodes "
            f"is 0; set module.leg_nodes to 3 or more, or remove it"
        )
