"""The device file at the door: which keys there are, which records belong to which kind of device, in which units."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic_core import ErrorDetails

from thermicon.circuit.door import InputError, nearest
from thermicon.circuit.records import Record, RecordError


class DeviceError(InputError):
    """A device that cannot be, or that cannot do what is asked: what, where, value, limit, unit, cure."""


DrivenBy = Literal["volts", "amperes", "duty", "set-points"]

UNITS = {
    "output range": ("V", "A"),
    "resolution": ("bit",),
    "update rate": ("Hz",),
    "slew rate": ("V/s", "A/s"),
    "buffer length": ("samples",),
    "carrier frequency": ("Hz",),
    "set-point range": ("°C",),
    "set-point step": ("K",),
    "tick": ("s",),
    "segments": ("segments",),
    "segment length": ("ticks",),
    "baseline range": ("°C",),
    "ramp rate": ("K/s",),
}
"""Quantities a device may state, each with the units it may be stated in."""

NEEDED: dict[str, tuple[str, ...]] = {
    "volts": ("output range", "resolution", "update rate"),
    "amperes": ("output range", "resolution", "update rate"),
    "duty": ("output range", "resolution", "carrier frequency"),
    "set-points": (
        "set-point range", "set-point step", "tick", "segments", "segment length", "baseline range", "ramp rate",
    ),
}  # fmt: skip

INTERVALS = ("output range", "set-point range", "baseline range", "segment length")
"""Quantities that need a low and a high end."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class RecordTable(_Table):
    """One sourced number of a device."""

    quantity: str
    unit: str
    source: str
    value: float | None = None
    low: float | None = None
    high: float | None = None
    conditions: str = ""
    confidence: Literal["high", "medium", "low", ""] = ""


class DeviceTable(_Table):
    """A whole device file."""

    format: Literal[1]
    name: Annotated[str, Field(min_length=1)]
    title: Annotated[str, Field(min_length=1)]
    driven_by: DrivenBy
    codes: Literal["two's complement", "symmetric", "from zero"] = "two's complement"
    levels: Literal["fixed", "waveform"] = "fixed"
    duty_rule: Literal["equal heat", "mean current"] = "equal heat"
    streams: bool = False
    dc_coupled: bool = False
    played: bool = False
    note: str = ""
    record: Annotated[list[RecordTable], Field(min_length=1)]


def read_device_table(text: str, where: str) -> DeviceTable:
    """Return the checked table of a device file's text, or raise DeviceError with all its faults at once."""
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        raise DeviceError(f"{where}: not a valid TOML file: {problem}") from None
    try:
        table = DeviceTable.model_validate(document)
    except ValidationError as problem:
        findings = [_in_words(error, document) for error in problem.errors(include_url=False)]
        raise DeviceError("\n".join(f"{where}: {finding}" for finding in findings)) from None
    faults = _faults(table)
    if faults:
        raise DeviceError("\n".join(f"{where}: {fault}" for fault in faults))
    return table


def records_of(table: DeviceTable) -> tuple[Record, ...]:
    """Return the numbers of a checked table as records."""
    return tuple(
        Record(
            record.quantity, record.unit, record.source, value=record.value, low=record.low, high=record.high,
            conditions=record.conditions, confidence=record.confidence,
        )
        for record in table.record
    )  # fmt: skip


def _faults(table: DeviceTable) -> list[str]:
    found, stated = [], {record.quantity: record for record in reversed(table.record)}
    for place, record in enumerate(table.record):
        where = f"record.{place} ({record.quantity})"
        if record.quantity not in UNITS:
            found.append(f"{where}: no such quantity; {nearest(record.quantity, UNITS)}")
            continue
        if record.unit not in UNITS[record.quantity]:
            found.append(f"{where}: unit = {record.unit!r}: must be {' or '.join(UNITS[record.quantity])}")
        if stated[record.quantity] is not record:
            found.append(f"{where}: is there twice; keep one")
        if record.quantity in INTERVALS and (record.low is None or record.high is None or record.low >= record.high):
            found.append(f"{where}: needs low and high, low below high")
        try:
            records_of(table.model_copy(update={"record": [record]}))
        except RecordError as problem:
            found.append(f"{where}: {problem}")
            continue
        if record.quantity not in INTERVALS and not all(
            number > 0 for number in (record.value, record.low, record.high) if number is not None
        ):
            found.append(f"{where}: must be above 0")
    missing = [quantity for quantity in NEEDED[table.driven_by] if quantity not in stated]
    found += [
        f"a device driven by {table.driven_by} needs a record of its {quantity}, in {UNITS[quantity][0]}"
        for quantity in missing
    ]
    return found


def _in_words(error: ErrorDetails, document: Mapping[str, Any]) -> str:
    key = ".".join(str(part) for part in error["loc"])
    value, kind, context = error.get("input"), error["type"], error.get("ctx", {})
    said = f"{key} = {value!r}" if isinstance(value, (int, float, str, bool)) else key
    if kind == "extra_forbidden":
        table = RecordTable if error["loc"][0] == "record" else DeviceTable
        return f"{key}: unknown key; {nearest(str(error['loc'][-1]), table.model_fields)}"
    if kind == "missing":
        return f"{key} is missing; add it"
    if kind == "literal_error":
        return f"{said}: must be {context.get('expected')}"
    if kind in ("float_type", "finite_number"):
        return f"{said}: must be a finite number without quotes or unit"
    if kind == "bool_type":
        return f"{said}: must be true or false"
    return f"{said}: {error['msg'][:1].lower()}{error['msg'][1:]}"
