"""A rig: everything between a device's output and the receptors."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from thermicon.base.checks.arguments import checked
from thermicon.base.files.atomic import OutputError, complete_or_absent
from thermicon.base.files.inputs import named_text, shipped_names

from .assemble import HeatPump, probes_of, pump_of, skin_of
from .faults import sentence
from .module import Peltier
from .parts import Contact, Driver, HeatSink, Probe
from .rig_words import rig_summary, rig_warnings
from .rigfile import Ambient, Controller, RigError, RigTable, Thermode, parse_toml, read_table
from .rules import Limits
from .settings import changed, flattened, put_all, read_settings, restate, toml_text
from .skin import Skin, SkinColumn, column_of
from .uncertainty import Uncertainty


@dataclass(frozen=True, slots=True)
class Rig:
    """Everything between the drive current, or the set-points of a thermode, and the receptors.

    A rig has a `pump` or a `thermode`, never both; `module`, `heat_sink` and `driver` belong to the pump.

    Attributes
    ----------
    name, title
        Name of the rig, and one line for people.
    notes
        What its author says about it.
    pump
        Module, heat sink and driver; None for a thermode.
    contact, ambient
        Contact between display and skin; air around the skin.
    skin, column
        Layers and receptors; the same skin divided into lumps.
    deep_C
        Temperature of deep tissue and blood in °C.
    document
        The rig file as JSON; rigs are equal if their documents are.
    uncertainty
        How far the parameters may be off, for the worst case of safety.
    limits
        Limits of safety.
    probes
        Sensors that the rig simulates.
    controller
        Temperature controller around the module, if any.
    thermode
        Limits of a thermode, which takes temperatures in place of a current.
    changes
        What differs from the file, as `key=value`.

    Examples
    --------
    >>> rig = Rig.load("thenar")
    >>> rig
    Rig('thenar', thenar, 9 cm², skin rests at 32.0 °C, blood 34.58 °C, driver -1.5 … 1.5 A)
    >>> round(rig.resting_flux_W_per_m2, 1)
    -80.0
    >>> rig.with_(**{"contact.area_cm2": 4}).contact.area_m2
    0.0004
    """

    name: str
    title: str
    notes: tuple[str, ...]
    pump: HeatPump | None
    contact: Contact
    ambient: Ambient
    skin: Skin
    column: SkinColumn
    deep_C: float
    document: str
    uncertainty: Uncertainty
    limits: Limits
    probes: tuple[Probe, ...] = ()
    controller: Controller | None = None
    thermode: Thermode | None = None
    changes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        source = (
            f"driver {self.driver.current_min_A:g} … {self.driver.current_max_A:g} A"
            if self.thermode is None
            else f"thermode {self.thermode.lowest_C:g} … {self.thermode.highest_C:g} °C"
        )
        rest = f"skin rests at {self.skin.rest_C:.1f} °C, blood {self.deep_C:.2f} °C"
        return f"Rig({self.name!r}, {self.site}, {self.contact.area_m2 * 1e4:g} cm², {rest}, {source})"

    def __hash__(self) -> int:
        return hash(self.document)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rig) and self.document == other.document

    @staticmethod
    def of(rig: AnyRig, site: str | None = None) -> Rig:
        """A rig as it is, or that of a name or file; None: the shipped one of the name of this site, or thenar.

        >>> [Rig.of(None, site).name for site in ("fingertip", "cheek", "tcs2", None)]
        ['fingertip', 'thenar', 'thenar', 'thenar']
        """
        if rig is None:
            rig = site if site in rig_names() and Rig.load(site).site == site else "thenar"
        return rig if isinstance(rig, Rig) else Rig.load(rig)

    @staticmethod
    @checked
    def load(source: str | Path) -> Rig:
        """Return a shipped rig by name, or a rig from a `.toml` file.

        A file with the name of a shipped rig is read in its place; a folder of that name is not. Raises RigError with
        every fault of the file on a line of its own, or the nearest name where there is no such rig.
        """
        if str(source) not in rig_names() and str(source) in shipped_names("layouts") and not Path(source).exists():
            raise RigError(
                f"{source}: a layout of several elements, and one plays here; give the rig of one, such as thenar"
            )
        return _read(*named_text(source, rig_names(), "rig", RigError))

    @property
    def toml(self) -> str:
        """The rig as the text of a rig file."""
        return toml_text(json.loads(self.document))

    def save(self, path: str | Path, name: str | None = None) -> None:
        """Write the rig as a `.toml` file, which `Rig.load` reads as an equal rig; an existing file is replaced.

        `name` is that of the saved rig, which then says what was changed; None: the rig's own. Raises RigError for
        another ending, a path that cannot be written, and a rig that no rig file may describe.
        """
        where = Path(path)
        if where.suffix != ".toml":
            raise RigError(f"{where}: the name of a rig file ends in .toml; call it {where.name}.toml")
        saved = self
        if name is not None:
            document = json.loads(self.document)
            restate(document, changed(self.changes))
            saved = rig_of(document | {"name": name}, str(where))
        if rig_of(parse_toml(saved.toml, str(where)), str(where)) != saved:
            raise RigError(f"{where}: rig {self.name} cannot be read back unchanged; it was not saved")
        try:
            with complete_or_absent(where) as draft:
                draft.write_text(saved.toml, encoding="utf-8")
        except OutputError as problem:
            raise RigError(str(problem)) from None

    def _pump_for(self, what: str) -> HeatPump:
        if self.pump is None:
            raise RigError(sentence("parts.thermode", name=self.name, what=what))
        return self.pump

    @property
    def module(self) -> Peltier:
        """The Peltier module; raises RigError on a thermode."""
        return self._pump_for("module").module

    @property
    def heat_sink(self) -> HeatSink:
        """What the hot plate sits on; raises RigError on a thermode."""
        return self._pump_for("heat sink").heat_sink

    @property
    def driver(self) -> Driver:
        """The current source; raises RigError on a thermode."""
        return self._pump_for("driver").driver

    @property
    def update_Hz(self) -> float:
        """Updates per second of the driver's current, or of a thermode's set-point."""
        return self.driver.update_Hz if self.thermode is None else self.thermode.update_Hz

    @property
    def site(self) -> str:
        """Skin site, as in `thenar`."""
        return self.skin.site

    @property
    def resting_flux_W_per_m2(self) -> float:
        """Heat flow into bare skin at rest, W/m²; negative, since skin loses heat."""
        return (self.skin.rest_C - self.deep_C) / self.column.steady_drop_K(1.0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what is unusual about this rig."""
        return tuple(each.text for each in rig_warnings(self))

    @property
    def module_source(self) -> str:
        """One sentence on where the module's parameters come from, and how far they are from the printed Qmax."""
        return self._pump_for("module").origin.sentence

    def about(self) -> str:
        """What to know about this rig before trusting it, as plain text: rest, depths, module, warnings, notes.

        >>> print(Rig.load("thenar").about().splitlines()[2])
          rest       skin 32.0 °C, blood and deep tissue 34.58 °C (from the heat balance), 80 W/m² lost by bare skin
        """
        return rig_summary(self)

    def with_(self, **changes: object) -> Rig:
        """Return a new rig with keys of the rig file changed, in the units of the file.

        `changes` are dotted keys, or tables as dictionaries, of which only the given keys change. A layer or probe is
        named by its place or its name. Raises RigError for an unknown key, with the nearest one, and for a value that
        cannot be.

        >>> rig = Rig.load("thenar")
        >>> rig.with_(**{"skin.layer.dermis.thickness_mm": 1.2}, contact={"area_cm2": 4}).changes
        ('skin.layer.dermis.thickness_mm=1.2', 'contact.area_cm2=4')
        """
        document, changes = json.loads(self.document), flattened(changes)
        put_all(document, changes)
        stated = {**changed(self.changes), **changes}
        texts = tuple(f"{key}={value}" for key, value in stated.items())
        return replace(rig_of(document, f"rig {self.name}"), changes=texts)

    @checked
    def with_set(self, settings: Iterable[str]) -> Rig:
        """Return a new rig with changes given as `key=value` texts, as on the command line."""
        changes = read_settings(settings)
        return self.with_(**changes) if changes else self


AnyRig = Rig | str | Path | None
"""What is taken where a rig is needed: the rig, or its name or file; None: the usual rig for the icons."""


def rig_names() -> tuple[str, ...]:
    """Return the names of the shipped rigs, which `Rig.load` accepts, the default first."""
    return tuple(sorted(shipped_names("rigs"), key=lambda name: name != "thenar"))


@lru_cache(maxsize=64)
def _read(text: str, where: str) -> Rig:
    return rig_of(parse_toml(text, where), where)


def rig_of(document: Mapping[str, Any], where: str) -> Rig:
    """The rig of a document, as its file has it; raises RigError with every fault, on `where`."""
    if isinstance(document.get("element"), list):
        raise RigError(
            f"{where}: a layout of several elements, and one plays here; give the rig of one, such as thenar"
        )
    table = read_table(document, where)
    try:
        return _assemble(table, json.dumps(document, sort_keys=True, ensure_ascii=False))
    except ValueError as problem:
        raise RigError(f"{where}: {problem}") from None


def _assemble(table: RigTable, document: str) -> Rig:
    contact, skin, body = table.contact, table.skin, skin_of(table.skin)
    blood = table.blood.density_kg_per_m3 * table.blood.heat_capacity_J_per_kgK
    column = column_of(body, blood)
    loss = table.ambient.film_W_per_m2K * (skin.rest_C - table.ambient.temperature_C)
    deep = skin.deep_C if skin.deep_C is not None else skin.rest_C - column.steady_drop_K(-loss)
    return Rig(
        table.name,
        table.title,
        tuple(table.notes),
        pump_of(table),
        Contact(contact.area_cm2 * 1e-4, contact.resistance_m2K_per_W),
        table.ambient,
        body,
        column,
        float(deep),
        document,
        table.uncertainty,
        Limits.of(table.safety.changes, table.safety.reason),
        probes_of(table.probe, body.thickness_m),
        table.controller,
        table.thermode,
    )
