"""Faults of a rig file as a whole: what warms and cools the display, and what a landing hand rules out."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .rigfile import RigTable


def display_faults(table: RigTable) -> list[str]:
    """Return one sentence for each table that is missing or too many: a module and its parts, or a thermode."""
    pumped = {key: getattr(table, key) for key in ("module", "heat_sink", "driver", "controller")}
    given = [key for key, part in pumped.items() if part is not None]
    missing = [key for key in ("module", "heat_sink", "driver") if pumped[key] is None]
    if table.thermode is not None and given:
        return [
            f"thermode: a thermode has a loop of its own, so the rig has no {' and no '.join(given)}; remove "
            f"{', '.join(f'[{key}]' for key in given)} or [thermode]"
        ]
    if table.thermode is not None or not missing:
        return []
    if len(missing) == 3:
        return ["module is missing; add [module], [heat_sink] and [driver], or a [thermode] in their place"]
    return [f"{key} is missing; add it" for key in missing]


def landing_faults(table: RigTable) -> list[str]:
    """Return one sentence for each part of a rig that starts at rest, where a hand lands."""
    if table.contact.lands_s is None:
        return []
    sink, insulated = table.heat_sink, [probe for probe in table.probe if probe.place == "insulated skin"]
    faults = []
    if table.thermode is not None:
        faults.append("a thermode, whose skin starts at rest under it; remove it or use a rig with a module")
    if sink is not None and sink.power_limit_W is not None:
        faults.append("a heat sink with a controller of its own, whose loop starts at rest; remove one of them")
    if insulated:
        faults.append('a probe on "insulated skin", whose skin starts at rest; remove one of them')
    return [f"contact.lands_s: cannot be combined with {fault}" for fault in faults]
