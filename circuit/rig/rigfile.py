"""The schema of a rig file."""

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, Field, ValidationError

from thermicon.base.checks.arguments import InputError as InputError
from thermicon.base.files.inputs import LONGEST_NAME, Place, key_faults, read_toml
from thermicon.base.words.near_words import did_you_mean, proposals

from . import faults as kinds
from .faults import PARAMETERS, KeyTable, sentence, unit_of
from .module import Datasheet
from .rules import faults_of
from .uncertainty import Uncertainty
from .usual import likely_unit


class RigError(InputError):
    """An impossible rig: one line per fault, with key, value, limit, unit and cure.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> try:
    ...     Rig.load("thenar").with_(**{"contact.area_cm2": -9})
    ... except RigError as problem:
    ...     print(problem)
    rig thenar: contact.area_cm2 = -9...
    """


MOST_LAYERS, MOST_PROBES, MOST_NOTES = 50, 100, 100
"""Skin models have a handful of layers and rigs a few probes; each costs time in every step."""


class ModuleTable(KeyTable):
    """The Peltier module, given by three parameters, data sheets or a shipped name, and its two plates."""

    seebeck_V_per_K: kinds.Ideal | None = None
    resistance_ohm: kinds.Ideal | None = None
    thermal_resistance_K_per_W: kinds.Ideal | None = None
    datasheet: list[Datasheet] | None = None
    name: kinds.Name | None = None
    hot_plate_J_per_K: kinds.Ideal
    cold_plate_J_per_K: kinds.Ideal

    def faults(self) -> Iterable[str]:
        """Given in no way or in two, or by too few parameters or too many sheets."""
        stated = [key for key in PARAMETERS if getattr(self, key) is not None]
        ways = [*stated[:1], *(key for key in ("datasheet", "name") if getattr(self, key) is not None)]
        missing = [key for key in PARAMETERS if stated and key not in stated]
        if not ways:
            yield sentence("faults.module_none", keys=", ".join(PARAMETERS))
        elif len(ways) > 1:
            yield sentence("faults.module_two", ways=" and ".join(ways))
        elif missing:
            yield from (sentence("faults.module_key", key=key, unit=unit_of(key)) for key in missing)
        elif self.datasheet is not None and len(self.datasheet) not in (1, 2):
            yield sentence("faults.module_sheets", count=len(self.datasheet))


class HeatSinkTable(KeyTable):
    """The heat sink under the hot plate."""

    temperature_C: kinds.Celsius | None = None
    resistance_K_per_W: kinds.Ideal
    capacity_J_per_K: kinds.Ideal | None = None
    air_resistance_K_per_W: Annotated[float, Field(ge=1e-3, le=1e6)] | None = None
    air_C: kinds.Celsius | None = None

    def faults(self) -> Iterable[str]:
        """Neither a temperature nor air, or air without a heat capacity, or the other way round."""
        passive = self.air_resistance_K_per_W is not None
        if self.temperature_C is None and not passive:
            yield sentence("faults.sink_start")
        if self.air_C is not None and not passive:
            yield sentence("faults.sink_air", air=self.air_C)
        if passive and self.capacity_J_per_K is None:
            yield sentence("faults.sink_capacity")
        if self.capacity_J_per_K is not None and not passive:
            yield sentence("faults.sink_alone")


class DriverTable(KeyTable):
    """The current source and its limits."""

    transconductance_A_per_V: Annotated[float, Field(ge=1e-6, le=1000)] = 0.1
    current_limit_A: kinds.Amperes
    current_min_A: Annotated[float, Field(ge=-1000)] | None = None
    voltage_limit_V: kinds.Volts
    update_Hz: Annotated[float, Field(ge=1, le=10_000)] = 100


class ContactTable(KeyTable):
    """The contact between display and skin."""

    area_cm2: Annotated[float, Field(ge=0.01, le=10_000)]
    resistance_m2K_per_W: Annotated[float, Field(ge=1e-6, le=1)]


class Controller(KeyTable):
    """A PID loop on the display: thermistor lag s, gains A/K, A/(K·s), and A·s/K on the measured temperature."""

    lag_s: kinds.Lag = 0.0
    kp_A_per_K: kinds.Gain
    ki_A_per_Ks: kinds.Gain = 0.0
    kd_As_per_K: kinds.Gain = 0.0


class Thermode(KeyTable):
    """A display that follows set-points by its own control: slew K/s, lag s (first order), step K, range °C, rate Hz.

    It stands in place of module, heat sink, driver and controller; a step of 0 K means continuous set-points.
    """

    slew_K_per_s: kinds.Positive
    lag_s: kinds.Lag = 0.0
    resolution_K: Annotated[float, Field(ge=0, le=10)] = 0.0
    lowest_C: kinds.Celsius
    highest_C: kinds.Celsius
    update_Hz: Annotated[float, Field(ge=1, le=10_000)] = 100

    def faults(self) -> Iterable[str]:
        """A range without room."""
        if self.lowest_C >= self.highest_C:
            yield f"thermode.lowest_C = {self.lowest_C:g} °C: must be below thermode.highest_C ({self.highest_C:g} °C)"


class Ambient(KeyTable):
    """The air that bare skin rests in: temperature °C, film W/(m²·K)."""

    temperature_C: kinds.Celsius
    film_W_per_m2K: kinds.Film


class LayerTable(KeyTable):
    """One layer of tissue."""

    name: kinds.Name
    thickness_mm: kinds.Millimetres
    conductivity_W_per_mK: kinds.Conductivity
    density_kg_per_m3: kinds.Density
    heat_capacity_J_per_kgK: kinds.HeatCapacity
    perfusion_per_s: kinds.Perfusion = 0.0


class SkinTable(KeyTable):
    """The skin under the display, surface first."""

    site: kinds.Text
    rest_C: Annotated[float, Field(ge=10, le=45)]
    cold_receptor_mm: kinds.Millimetres | None = None
    warm_receptor_mm: kinds.Millimetres | None = None
    depth_from: Literal["surface", "stratum corneum"] | None = None
    deep_C: kinds.Celsius | None = None
    elements: list[Annotated[int, Field(ge=1, le=200)]] | None = None
    layer: Annotated[list[LayerTable], Field(min_length=1, max_length=MOST_LAYERS)]


class BloodTable(KeyTable):
    """Blood that perfuses the layers."""

    density_kg_per_m3: kinds.Density
    heat_capacity_J_per_kgK: kinds.HeatCapacity


class ProbeTable(KeyTable):
    """A point whose temperature is recorded."""

    name: kinds.Text
    place: Literal["display", "interface", "skin"]
    depth_mm: Annotated[float, Field(ge=0, le=200)] = 0.0
    lag_s: kinds.Lag = 0.0


class SafetyTable(KeyTable):
    """Limits in place of the shipped ones; looser ones need a reason."""

    skin_lowest_C: kinds.Celsius | None = None
    skin_highest_C: kinds.Celsius | None = None
    skin_lowest_soft_C: kinds.Celsius | None = None
    skin_highest_soft_C: kinds.Celsius | None = None
    skin_change_soft_K: kinds.Positive | None = None
    receptor_lowest_C: kinds.Celsius | None = None
    receptor_highest_C: kinds.Celsius | None = None
    display_lowest_C: kinds.Celsius | None = None
    display_highest_C: kinds.Celsius | None = None
    display_lowest_soft_C: kinds.Celsius | None = None
    display_highest_soft_C: kinds.Celsius | None = None
    skin_rate_K_per_s: kinds.Positive | None = None
    hot_plate_highest_C: kinds.Celsius | None = None
    thermal_dose_min_CEM43: kinds.Positive | None = None
    henriques_integral: kinds.Positive | None = None
    session_min: kinds.Positive | None = None
    reason: kinds.Text = ""

    @property
    def changes(self) -> dict[str, float]:
        """The limits that are given, by key."""
        stated = self.model_dump(exclude={"reason"})
        return {key: float(value) for key, value in stated.items() if value is not None}

    def faults(self) -> Iterable[str]:
        """See `faults_of`."""
        return faults_of(self.changes, self.reason)


class RigTable(KeyTable):
    """A whole rig file."""

    format: Literal[1]
    name: Annotated[kinds.Name, Field(max_length=LONGEST_NAME)]
    title: kinds.Text = ""
    notes: Annotated[list[kinds.Paragraph], Field(max_length=MOST_NOTES)] = Field(default_factory=list)
    module: ModuleTable | None = None
    heat_sink: HeatSinkTable | None = None
    driver: DriverTable | None = None
    controller: Controller | None = None
    thermode: Thermode | None = None
    contact: ContactTable
    ambient: Ambient
    skin: SkinTable
    blood: BloodTable
    probe: Annotated[list[ProbeTable], Field(max_length=MOST_PROBES)] = Field(default_factory=list)
    uncertainty: Uncertainty = Field(default_factory=Uncertainty)
    safety: SafetyTable = Field(default_factory=SafetyTable)
    source: dict[kinds.Text, kinds.Paragraph] = Field(default_factory=dict)

    def faults(self) -> Iterable[str]:
        """A module with its parts, or a thermode: never both."""
        pumped = {key: getattr(self, key) for key in ("module", "heat_sink", "driver", "controller")}
        given = [key for key, part in pumped.items() if part is not None]
        missing = [key for key in ("module", "heat_sink", "driver") if pumped[key] is None]
        if self.thermode is not None and given:
            parts, tables = " and no ".join(given), ", ".join(f"[{key}]" for key in given)
            yield sentence("faults.both", parts=parts, tables=tables)
        elif self.thermode is None and len(missing) == 3:
            yield sentence("faults.neither")
        elif self.thermode is None:
            yield from (sentence("faults.part", key=key) for key in missing)


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """Return the TOML text as a dictionary, or raise RigError that says which line is wrong."""
    return read_toml(text, where, "rig file", ("skin", "base", "element"), RigError)


def read_table(document: Mapping[str, Any], where: str) -> RigTable:
    """Return the validated table of a rig document, or raise RigError with all its faults at once."""
    try:
        return RigTable.model_validate(dict(document))
    except ValidationError as problem:
        faults = key_faults(problem, _nearest, unit_of, likely_unit=likely_unit)
        raise RigError("\n".join(f"{where}: {fault}" for fault in faults)) from None


@cache
def rig_keys() -> tuple[str, ...]:
    """All dotted keys of a rig file; those of a layer, a data sheet or a probe have 0 as its place."""
    return tuple(_keys(RigTable, ""))


def _keys(table: type[BaseModel], prefix: str) -> Iterator[str]:
    for name, field in table.model_fields.items():
        inner, listed = _table_in(field.annotation), "list" in str(field.annotation)
        if name != "source" and (inner is None or listed):
            yield prefix + name
        if inner is not None:
            yield from _keys(inner, f"{prefix}{name}.0." if listed else f"{prefix}{name}.")


def _table_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((table for each in get_args(annotation) if (table := _table_in(each))), None)


def unknown_key(key: str) -> str:
    """Return the message for an unknown key."""
    inside = [known for known in rig_keys() if known.startswith(f"{key}.") and ".0." not in known]
    if inside:
        return f"{key}: this is a table; name one of its keys, such as {inside[0]}"
    return f"{key}: unknown key; {_nearest(key.split('.'))}"


def _nearest(parts: Place) -> str:
    if any("." in str(part) for part in parts):
        return "names in quotes belong in [source]; write keys without them"
    key = ".".join("0" if isinstance(part, int) else part for part in parts)
    known = set(rig_keys()) | {known.rpartition(".")[0] for known in rig_keys() if "." in known}
    place, dot, name = key.rpartition(".")
    beside = [other.rpartition(".")[2] for other in known if other.rpartition(".")[0] == place]
    if close := proposals(name, beside, 2, 0.6):
        inside = "".join(f"{part}." for part in parts[:-1])
        return f"did you mean {' or '.join(inside + other for other in close)}?"
    return did_you_mean(key, known if dot and place not in known else beside)
