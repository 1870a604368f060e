"""The schema of a device file: its keys, the records of each kind of device, and their units."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from thermicon.icons.near_words import did_you_mean
from thermicon.icons.number_text import signed

from ..inputs import (
    LONGEST_NAME,
    InputError,
    Place,
    key_faults,
    one_line,
    paragraph,
    read_toml,
)
from ..records import Record, RecordError


class DeviceError(InputError):
    """An impossible device, or one that cannot play a cue: what, where, value, limit, unit, cure."""


DrivenBy = Literal["volts", "amperes", "duty", "set-points", "temperatures"]

UNITS = {
    "resolution": "bit",
    "update rate": "Hz",
    "buffer length": "samples",
    "carrier frequency": "Hz",
    "set-point range": "°C",
    "set-point step": "K",
    "set-point gain": "V/K",
    "set-point offset": "V",
    "tick": "s",
    "segments": "segments",
    "segment length": "ticks",
    "baseline range": "°C",
    "ramp rate": "K/s",
    "lag": "s",
}
"""Quantities a device may state, each with its unit; those whose unit depends on `driven_by` are below."""

UNITS_BY_DRIVE: dict[str, dict[str, str]] = {
    "output range": {"volts": "V", "amperes": "A", "duty": "A"},
    "slew rate": {"volts": "V/s", "amperes": "A/s"},
}
"""Quantities that only some devices have, each with its unit by `driven_by`."""

NEEDED: dict[str, tuple[str, ...]] = {
    "volts": ("output range", "resolution", "update rate"),
    "amperes": ("output range", "resolution", "update rate"),
    "duty": ("output range", "resolution", "carrier frequency"),
    "set-points": (
        "set-point range", "set-point step", "tick", "segments", "segment length", "baseline range", "ramp rate",
    ),
    "temperatures": ("set-point range", "update rate"),
}  # fmt: skip

INTERVALS = ("output range", "set-point range", "baseline range", "segment length")
"""Quantities that need a low and a high end."""


Text = Annotated[str, AfterValidator(one_line)]

LIMITS: dict[str, tuple[float, float]] = {
    "output range": (-1000.0, 1000.0),  # V or A: far beyond what moves heat through a module on skin
    "resolution": (2, 32),  # symmetric codes need two bits; converters end at 32 (delta-sigma)
    "update rate": (1e-3, 1e12),  # the fastest arbitrary waveform generators make some 2.6e11 samples a second
    "buffer length": (1, 1e12),
    "carrier frequency": (1e-2, 1e7),  # switching converters end at some MHz
    "slew rate": (1e-6, 1e15),  # the fastest amplifiers slew some 1e10 V/s
    "set-point range": (-100.0, 200.0),
    "set-point step": (1e-4, 10.0),
    "set-point gain": (1e-6, 1e3),
    "set-point offset": (-1000.0, 1000.0),
    "tick": (1e-3, 10.0),
    "segments": (1, 1e6),
    "segment length": (1, 1e6),
    "baseline range": (-100.0, 200.0),
    "ramp rate": (1e-3, 1e5),
    "lag": (0.0, 60.0),
}
"""Limits of each quantity, in its unit: wider than any hardware, so that slips are found and no file exhausts the
memory."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class RecordTable(_Table):
    """One sourced number of a device."""

    quantity: Text
    unit: Text
    source: Text
    value: float | None = None
    low: float | None = None
    high: float | None = None
    conditions: Text = ""
    confidence: Literal["high", "medium", "low", ""] = ""


class DeviceTable(_Table):
    """A whole device file."""

    format: Literal[1]
    name: Annotated[Text, Field(min_length=1, max_length=LONGEST_NAME)]
    title: Annotated[Text, Field(min_length=1)]
    driven_by: DrivenBy
    codes: Literal["two's complement", "symmetric", "from zero"] = "two's complement"
    levels: Literal["fixed", "waveform"] = "fixed"
    duty_rule: Literal["equal heat", "mean current"] = "equal heat"
    streams: bool = False
    dc_coupled: bool = False
    played: bool = False
    note: Annotated[str, AfterValidator(paragraph)] = ""
    record: Annotated[list[RecordTable], Field(min_length=1, max_length=100)]


def read_device_table(text: str, where: str) -> DeviceTable:
    """Return the checked table of a device file's text, or raise DeviceError with all its faults at once."""
    document = read_toml(text, where, DeviceError)
    try:
        table = DeviceTable.model_validate(document)
    except ValidationError as problem:
        raise DeviceError("\n".join(f"{where}: {fault}" for fault in key_faults(problem, _nearest))) from None
    faults = _faults(table)
    if faults:
        raise DeviceError("\n".join(f"{where}: {fault}" for fault in faults))
    return table


def records_of(table: DeviceTable) -> tuple[Record, ...]:
    """Return the numbers of a checked table as records."""
    return tuple(Record(**record.model_dump()) for record in table.record)


def _faults(table: DeviceTable) -> list[str]:
    faults, stated = [], {record.quantity: record for record in reversed(table.record)}
    for place, record in enumerate(table.record):
        where = f"record.{place} ({record.quantity})"
        if record.quantity not in UNITS and record.quantity not in UNITS_BY_DRIVE:
            faults.append(f"{where}: no such quantity; {did_you_mean(record.quantity, [*UNITS, *UNITS_BY_DRIVE])}")
            continue
        if fault := _unit_fault(record, table.driven_by):
            faults.append(f"{where}: {fault}")
        if stated[record.quantity] is not record:
            faults.append(f"{where}: appears twice; keep one")
        if record.quantity in INTERVALS and (fault := _interval_fault(record)):
            faults.append(f"{where}: {fault}")
            continue
        try:
            records_of(table.model_copy(update={"record": [record]}))
        except RecordError as problem:
            faults.append(f"{where}: {problem}")
            continue
        faults += [f"{where}: {fault}" for fault in _limit_faults(record)]
    missing = [quantity for quantity in NEEDED[table.driven_by] if quantity not in stated]
    faults += [
        f"a device driven by {table.driven_by} needs a record of its {quantity}, in "
        f"{_unit_of(quantity, table.driven_by)}"
        for quantity in missing
    ]
    return faults


def _unit_of(quantity: str, driven_by: str) -> str | None:
    """Unit of a quantity of such a device; None where it has none of that kind."""
    return UNITS.get(quantity) or UNITS_BY_DRIVE[quantity].get(driven_by)


def _unit_fault(record: RecordTable, driven_by: str) -> str | None:
    """What is wrong with the unit of a record, in a sentence with the cure."""
    required, stated = _unit_of(record.quantity, driven_by), record.unit
    if required is None:
        takers = " or ".join(UNITS_BY_DRIVE[record.quantity])
        return f"does not apply to a device driven by {driven_by}, only to one driven by {takers}; remove it"
    if stated == required:
        return None
    others = [drive for drive, unit in UNITS_BY_DRIVE.get(record.quantity, {}).items() if unit == stated]
    if not others:
        return f"unit = {stated!r}: must be {required}; state it in {required}"
    either = " or ".join(f'"{drive}"' for drive in others)
    return (
        f'unit = {stated!r}: must be {required} for a device with driven_by = "{driven_by}"; state it in {required}, '
        f"or set driven_by to {either} if {stated} is what it puts out"
    )


def _limit_faults(record: RecordTable) -> list[str]:
    """What numbers of a record no device has, a sentence each with the limit."""
    least, most = LIMITS[record.quantity]
    numbers = {"value": record.value, "low": record.low, "high": record.high}
    faults = [
        f"{name} = {signed(number)} {record.unit}: must be {signed(least)} to {signed(most)} {record.unit}"
        for name, number in numbers.items()
        if number is not None and not least <= number <= most
    ]
    if record.quantity == "resolution" and not faults and any(n is not None and n != int(n) for n in numbers.values()):
        faults.append("must be a whole number of bits")
    return faults


def _interval_fault(record: RecordTable) -> str | None:
    """What is wrong with the two ends of a record, in a sentence with the cure."""
    low, high = record.low, record.high
    if low is None or high is None:
        return f"needs both low and high; {'low' if low is None else 'high'} is missing, add it in {record.unit}"
    if low >= high:
        return (
            f"low = {signed(low)} {record.unit} is not below high = {signed(high)} {record.unit}; "
            f"{'swap them' if low > high else 'leave some room between them'}"
        )
    return None


def _nearest(place: Place) -> str:
    return did_you_mean(str(place[-1]), (RecordTable if place[0] == "record" else DeviceTable).model_fields)
