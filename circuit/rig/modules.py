"""The module of a rig by its name or by its own numbers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from thermicon.base.files.records import Record, RecordError, RecordTable, shipped_records

from .faults import PARAMETERS, Unusual, sentence, unusual
from .module import Datasheet, Extraction, Peltier, at_mean_C
from .rigfile import ModuleTable

COLUMNS = ("module", "origin", "couples", "footprint_mm", "plate_J_per_K", *Datasheet.model_fields)
SHEET = {"t_hot_C": "hot °C", "i_max_A": "Imax A", "v_max_V": "Vmax V", "q_max_W": "Qmax W", "dt_max_K": "ΔTmax K"}
FIGURES = ("cm²", "J/K", *SHEET.values())
ONE_STAGE = 0.03
"""Share by which ΔTmax may miss the printed one: single-stage sheets come within 0.008, a two-stage one has 0.19."""
LEAST_APART_K = 1.0
"""Two sheets closer than this in mean module temperature cannot show its influence."""


@dataclass(frozen=True, slots=True)
class ModuleOrigin:
    """The origin of a module's parameters in one sentence, with warnings about them."""

    sentence: str
    warnings: tuple[Unusual, ...] = ()


def module_table() -> RecordTable:
    """The shipped modules as sourced records, one for each data sheet."""
    return shipped_records("modules.toml", *COLUMNS)


def module_names() -> tuple[str, ...]:
    """Names of the shipped modules, in alphabetical order."""
    return tuple(sorted({str(record.get("module")) for record in module_table()}))


@dataclass(frozen=True, slots=True)
class Build:
    """A shipped module besides its parameters: face cm², J/K of each plate (None: not on record), Imax A."""

    face_cm2: float | None
    plate_J_per_K: float | None
    i_max_A: float


def build_of(name: str) -> Build:
    """Return the build of a shipped module; raises RecordError that names all."""
    record = _records(name)[0]
    printed = dict(record.extra)
    size, plate = printed.get("footprint_mm"), printed.get("plate_J_per_K")
    face = math.prod(float(side) for side in str(size).split("x")) / 100.0 if size else None
    return Build(face, float(plate) if plate else None, float(record.get("i_max_A")))


def module_rows() -> list[tuple[str, ...]]:
    """A row for each data sheet on record: the name, and `FIGURES`."""
    rows = []
    for record in module_table():
        name, build = str(record.get("module")), build_of(str(record.get("module")))
        known = [build.face_cm2, build.plate_J_per_K, *(float(record.get(key)) for key in SHEET)]
        rows.append((name, *("–" if each is None else f"{each:g}" for each in known)))
    return sorted(rows)


def load_module(name: str) -> tuple[Datasheet, ...]:
    """Return the data sheets of a shipped module, coolest hot side first; raises RecordError that names all."""
    columns = [{key: record.get(key) for key in Datasheet.model_fields} for record in _records(name)]
    return tuple(sorted(map(Datasheet.model_validate, columns), key=lambda sheet: sheet.t_hot_C))


def _records(name: str) -> list[Record]:
    if name not in module_names():
        raise RecordError(f"{name}: no such module; known: {', '.join(module_names())} (thermicon list modules)")
    return [record for record in module_table() if record.get("module") == name]


def module_of(table: ModuleTable, mean_C: float, source: str | None = None) -> tuple[Peltier, ModuleOrigin]:
    """The module of a rig file at a mean temperature, and its origin; ValueError where its figures are impossible."""
    plates = (table.hot_plate_J_per_K, table.cold_plate_J_per_K)
    if table.name is None and table.datasheet is None:
        alpha, ohm, theta = (float(getattr(table, key)) for key in PARAMETERS)
        return Peltier(alpha, ohm, theta, *plates), ModuleOrigin(f"parameters given: {source or 'no source stated'}")
    what, warnings = f"data sheet given in the rig ({source or 'no source stated'})", list[Unusual]()
    if table.name is not None:
        try:
            sheets = load_module(table.name)
        except RecordError as problem:
            raise ValueError(f"module.name = {problem}") from None
        origin, plate = _records(table.name)[0], build_of(table.name).plate_J_per_K
        what = f"{table.name}, {origin.source} (confidence {origin.confidence})"
        if plate is not None and plates == (plate, plate):
            what += f", plates of {plate:g} J/K a side (assumed from its footprint)"
        if origin.get("origin") != "datasheet":
            warnings.append(unusual("estimated", name=table.name, source=origin.source))
    else:
        sheets = tuple(table.datasheet or ())
    four = all(sheet.q_max_W is not None for sheet in sheets)
    extractions = _extract(sheets, four)
    hot = " and ".join(f"{sheet.t_hot_C:g}" for sheet in sheets)
    figures, how = ("four", "Qmax reproduced") if four else ("three", "no Qmax to check them against")
    for sheet, found in zip(sheets, extractions, strict=True):  # four figures for three numbers leave one to compare
        span, current = found.greatest(sheet.t_hot_C)
        if abs(span / sheet.dt_max_K - 1.0) > ONE_STAGE:
            warnings.append(unusual("not_one_stage", sheet=sheet, span=span, current=current))
    said = f"{what}: {figures} figures with the hot side at {hot} °C, {how}"
    if len(extractions) == 2:
        low, high = sorted(sheet.mean_C for sheet in extractions)
        said += f", taken at a mean module temperature of {min(max(mean_C, low), high):.1f} °C"
        if not low <= mean_C <= high:
            warnings.append(_beyond_sheets(extractions, mean_C, (low, high), own=table.name is None))
    return Peltier(*at_mean_C(extractions, mean_C), *plates), ModuleOrigin(said + ".", tuple(warnings))


def _beyond_sheets(
    extractions: Sequence[Extraction], mean_C: float, span_C: tuple[float, float], *, own: bool
) -> Unusual:
    """A mean temperature beyond both sheets of a module: how much the parameters may be off, and what to do."""
    low, high = span_C
    side, end, sheet = ("below", low, "colder") if mean_C < low else ("above", high, "hotter")
    steps = abs(mean_C - end) / (high - low)
    first, last = (at_mean_C(extractions, place) for place in span_C)
    nearest = first if side == "below" else last
    change = max(abs(b - a) / at * steps for a, b, at in zip(first, last, nearest, strict=True))
    cure = f"give a [[module.datasheet]] of a {sheet} side in place of one of the two, or " if own else ""
    ends = {"mean": mean_C, "low": low, "high": high, "end": end, "change": 100 * change}
    return unusual("beyond_sheets", side=side, cure=cure, **ends)


def _extract(sheets: Sequence[Datasheet], four: bool) -> tuple[Extraction, ...]:
    """Parameters from the four figures of every sheet, or from the three that all have."""
    extractions = []
    for place, sheet in enumerate(sheets):
        try:
            extractions.append(sheet.four_figures() if four else sheet.three_figures())
        except ValueError as problem:
            raise ValueError(f"module.datasheet.{place}.{problem}") from None
    if len(extractions) == 2 and abs(extractions[1].mean_C - extractions[0].mean_C) < LEAST_APART_K:
        raise ValueError(sentence("parts.sheets_alike", mean=extractions[0].mean_C, least=LEAST_APART_K))
    return tuple(extractions)
