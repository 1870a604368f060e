"""Probes of a rig file, in SI, with what they leave out filled from records."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib import resources

from ..records import Table, load_records
from .parts import Probe
from .rigfile import ProbeTable


@cache
def insulation_records() -> Table:
    """Sourced and assumed numbers of an insulated probe: the pad over it and the skin around it."""
    return load_records(resources.files("thermicon.circuit") / "data" / "insulated-probe.toml")


def probes_of(tables: Sequence[ProbeTable], thickness_m: float) -> tuple[Probe, ...]:
    """Return the probes of a rig file on skin of a thickness in m; raises ValueError for one that cannot be."""
    probes = tuple(_probe(table) for table in tables)
    for place, probe in enumerate(probes):
        if any(probe.name == other.name for other in probes[:place]):
            raise ValueError(f"probe.name = {probe.name!r}: there are two of that name; give every probe its own")
        if probe.depth_m > thickness_m * (1 + 1e-12):
            raise ValueError(
                f"probe {probe.name}: depth_mm = {probe.depth_m * 1e3:g} mm: must lie inside the skin, "
                f"which is {thickness_m * 1e3:g} mm deep"
            )
    return probes


def _probe(table: ProbeTable) -> Probe:
    lateral_keys = (table.lateral_mm, table.width_mm, table.insulation_m2K_per_W)
    lateral, width, insulation = lateral_keys
    if table.place != "insulated skin":
        if any(value is not None for value in lateral_keys):
            raise ValueError(
                f"probe {table.name}: lateral_mm, width_mm and insulation_m2K_per_W belong to insulated skin, "
                f"not to place = {table.place!r}; remove them"
            )
        return Probe(table.name, table.place, table.depth_mm * 1e-3, table.lag_s, 0.0, 0.0, 0.0)
    records = insulation_records()
    if insulation is None:
        insulation = records.one("aerogel thickness").central * 1e-3 / records.one("aerogel conductivity").central
    if lateral is None:
        lateral = records.one("lateral distance").central if width is None else width / 2
    width = 2 * lateral if width is None else width
    if lateral > width / 2 * (1 + 1e-9):
        raise ValueError(
            f"probe {table.name}: lateral_mm = {lateral:g} mm: no place under a round pad of width_mm = {width:g} mm "
            f"is farther than {width / 2:g} mm from skin in contact; use at most that, or remove width_mm"
        )
    return Probe(
        table.name, table.place, table.depth_mm * 1e-3, table.lag_s, lateral * 1e-3, width * 1e-3, float(insulation)
    )
