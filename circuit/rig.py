"""A rig: module, heat sink, driver, contact, air and skin, as one frozen object read from a rig file."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from thermicon.circuit.door import nearest, read_text
from thermicon.circuit.module import Peltier
from thermicon.circuit.parts import Ambient, Contact, Driver, HeatSink
from thermicon.circuit.rigfile import RigError, RigTable, parse_toml, read_table
from thermicon.circuit.settings import put, read_settings
from thermicon.circuit.skin import Column, Layer, Skin, column_of

HIGH_RESTING_FLUX_W_PER_M2 = 150.0
"""Bare skin in still air loses 40 to 120 W/m²; a rig that rests above this is told so."""


@dataclass(frozen=True, slots=True)
class Rig:
    """Everything between the drive current and the receptors.

    >>> rig = Rig.load("thenar")
    >>> rig
    Rig('thenar', thenar, 9 cm², skin rests at 32.0 °C, blood 34.57 °C, driver -1.5 … 1.5 A)
    >>> round(rig.resting_flux_W_per_m2, 1)
    -80.0
    >>> rig.with_(**{"contact.area_cm2": 4}).contact.area_m2
    0.0004
    """

    name: str
    title: str
    module: Peltier
    heat_sink: HeatSink
    driver: Driver
    contact: Contact
    ambient: Ambient
    skin: Skin
    column: Column
    deep_C: float
    document: str

    def __repr__(self) -> str:
        return (
            f"Rig({self.name!r}, {self.skin.site}, {self.contact.area_m2 * 1e4:g} cm², "
            f"skin rests at {self.skin.rest_C:.1f} °C, blood {self.deep_C:.2f} °C, "
            f"driver {self.driver.current_min_A:g} … {self.driver.current_max_A:g} A)"
        )

    def __hash__(self) -> int:
        return hash(self.document)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rig) and self.document == other.document

    @staticmethod
    def load(source: str | Path) -> Rig:
        """Return a shipped rig by name, or a rig from a `.toml` file; raises RigError with every fault."""
        path = Path(source)
        if path.suffix == ".toml" or path.exists():
            text = read_text(path, "rig file", 1, RigError)
            return _build(parse_toml(text, str(path)), str(path))
        if str(source) not in rig_names():
            raise RigError(f"{source}: no such rig; {nearest(str(source), rig_names())}")
        return _shipped(str(source))

    @property
    def site(self) -> str:
        """Skin site, as in `thenar`."""
        return self.skin.site

    @property
    def blood_C(self) -> float:
        """Temperature of deep tissue and blood in °C, solved from the rest unless the rig fixes it."""
        return self.deep_C

    @property
    def resting_flux_W_per_m2(self) -> float:
        """Heat flow into bare skin at rest, W/m²; negative, since skin loses heat."""
        return (self.skin.rest_C - self.deep_C) / self.column.steady_drop_K(1.0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is unusual about this rig, a sentence each."""
        found = []
        flux = -self.resting_flux_W_per_m2
        if flux > HIGH_RESTING_FLUX_W_PER_M2:
            found.append(
                f"skin at rest loses {flux:.0f} W/m², over the {HIGH_RESTING_FLUX_W_PER_M2:g} W/m² "
                f"that bare skin in room air can lose"
            )
        if self.deep_C < self.skin.rest_C:
            found.append(f"blood at {self.deep_C:.2f} °C is colder than the resting surface at {self.skin.rest_C:g} °C")
        return tuple(found)

    def with_(self, **changes: object) -> Rig:
        """Return a new rig with dotted keys of the rig file changed; a layer is named by its place or its name.

        Keys are those of the rig file, in its units: `rig.with_(**{"skin.layer.0.thickness_mm": 0.2})`.
        """
        document = json.loads(self.document)
        for key, value in changes.items():
            put(document, key, value)
        return _build(document, f"rig {self.name}")

    def with_set(self, settings: Iterable[str]) -> Rig:
        """Return a new rig changed by texts of the form `key=value`, as given on the command line."""
        changes = read_settings(settings)
        return self.with_(**changes) if changes else self


def rig_names() -> tuple[str, ...]:
    """Names of the shipped rigs, the default first."""
    names = [path.name.removesuffix(".toml") for path in _rig_folder().iterdir() if path.name.endswith(".toml")]
    return tuple(sorted(names, key=lambda name: (name != "thenar", name)))


def _rig_folder() -> Any:
    return resources.files("thermicon.circuit") / "rigs"


@cache
def _shipped(name: str) -> Rig:
    return _build(parse_toml((_rig_folder() / f"{name}.toml").read_text("utf-8"), f"rig {name}"), f"rig {name}")


def _build(document: Mapping[str, Any], where: str) -> Rig:
    table = read_table(document, where)
    try:
        return _assemble(table, json.dumps(document, sort_keys=True, ensure_ascii=False))
    except ValueError as problem:
        raise RigError(f"{where}: {problem}") from None


def _assemble(table: RigTable, document: str) -> Rig:
    driver, contact, skin = table.driver, table.contact, table.skin
    layers = tuple(
        Layer(
            layer.name,
            layer.thickness_mm * 1e-3,
            layer.conductivity_W_per_mK,
            layer.density_kg_per_m3,
            layer.heat_capacity_J_per_kgK,
            layer.perfusion_per_s,
        )
        for layer in skin.layer
    )
    body = Skin(
        skin.site,
        skin.rest_C,
        skin.cold_receptor_mm * 1e-3,
        skin.warm_receptor_mm * 1e-3,
        layers,
        skin.deep_C,
        None if skin.elements is None else tuple(skin.elements),
    )
    column = column_of(body, table.blood.density_kg_per_m3 * table.blood.heat_capacity_J_per_kgK)
    loss = table.ambient.film_W_per_m2K * (skin.rest_C - table.ambient.temperature_C)
    deep = skin.deep_C if skin.deep_C is not None else skin.rest_C - column.steady_drop_K(-loss)
    lowest = -driver.current_limit_A if driver.current_min_A is None else driver.current_min_A
    return Rig(
        table.name,
        table.title,
        Peltier(**table.module.model_dump()),
        HeatSink(**table.heat_sink.model_dump()),
        Driver(
            driver.transconductance_A_per_V, lowest, driver.current_limit_A, driver.voltage_limit_V, driver.update_Hz
        ),
        Contact(contact.area_cm2 * 1e-4, contact.resistance_m2K_per_W),
        Ambient(**table.ambient.model_dump()),
        body,
        column,
        float(deep),
        document,
    )
