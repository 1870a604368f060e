"""The schema of a device file."""

from collections.abc import Iterable, Iterator
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from thermicon.base.files.inputs import LONGEST_NAME, InputError, Place, key_faults, read_toml, shipped_table
from thermicon.base.files.records import Record, RecordError
from thermicon.base.words.near_words import did_you_mean
from thermicon.base.words.number_text import signed

from ..rig.faults import KeyTable, Paragraph, Text


class DeviceError(InputError):
    """An impossible device, or one that cannot play a cue: what, where, value, limit, unit, cure."""


DrivenBy = Literal["volts", "amperes", "duty", "set-points", "temperatures"]


def quantities() -> tuple[dict[str, dict[str, Any]], dict[str, list[str]]]:
    """Quantities that a device may state, with units and limits; and those that it must, by what drives it."""
    table = shipped_table("device-quantities.toml")
    return table["quantities"], table["needed"]


class DeviceRecordTable(KeyTable):
    """One sourced number of a device."""

    quantity: Text
    unit: Text
    source: Text
    value: float | None = None
    low: float | None = None
    high: float | None = None
    conditions: Text = ""
    confidence: Literal["high", "medium", "low", ""] = ""


class DeviceTable(KeyTable):
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
    note: Paragraph = ""
    record: Annotated[list[DeviceRecordTable], Field(min_length=1, max_length=100)]

    def faults(self) -> Iterable[str]:
        """Statements of its records that no device has, and missing ones."""
        (known, needed), driven_by = quantities(), self.driven_by
        stated = {record.quantity: record for record in reversed(self.record)}
        for place, record in enumerate(self.record):
            if record.quantity in known:
                wrong = [*_unit_faults(record, driven_by), *_number_faults(record)]
                wrong += [] if stated[record.quantity] is record else ["appears twice; keep one"]
            else:
                wrong = [f"no such quantity; {did_you_mean(record.quantity, known)}"]
            yield from (f"record.{place} ({record.quantity}): {fault}" for fault in wrong)
        for quantity in needed[driven_by]:
            if quantity not in stated:
                unit = units_of(quantity).get(driven_by)
                yield f"a device driven by {driven_by} needs a record of its {quantity}, in {unit}"


def read_device_table(text: str, where: str) -> DeviceTable:
    """Return the checked table of a device file's text, or raise DeviceError with all its faults at once."""
    document = read_toml(text, where, "device file", ("driven_by",), DeviceError)
    try:
        return DeviceTable.model_validate(document)
    except ValidationError as problem:
        raise DeviceError("\n".join(f"{where}: {fault}" for fault in key_faults(problem, _nearest))) from None


def units_of(quantity: str) -> dict[str, str]:
    """Unit of a quantity by what drives the devices that have it."""
    known, needed = quantities()
    about = known[quantity]
    return dict(about.get("units") or dict.fromkeys(needed, about["unit"]))


def _unit_faults(record: DeviceRecordTable, driven_by: str) -> Iterator[str]:
    units, stated = units_of(record.quantity), record.unit
    required = units.get(driven_by)
    others = [f'"{drive}"' for drive, unit in units.items() if unit == stated]
    if required is None:
        takers = " or ".join(units)
        yield f"does not apply to a device driven by {driven_by}, only to one driven by {takers}; remove it"
    elif stated != required and not others:
        yield f"unit = {stated!r}: must be {required}; state it in {required}"
    elif stated != required:
        yield (
            f'unit = {stated!r}: must be {required} for a device with driven_by = "{driven_by}"; state it in '
            f"{required}, or set driven_by to {' or '.join(others)} if {stated} is what it puts out"
        )


def _number_faults(record: DeviceRecordTable) -> Iterator[str]:
    about, unit = quantities()[0][record.quantity], record.unit
    low, high = record.low, record.high
    if about.get("interval"):
        if low is None or high is None:
            yield f"needs both low and high; {'low' if low is None else 'high'} is missing, add it in {unit}"
            return
        if low >= high:
            cure = "swap them" if low > high else "leave some room between them"
            yield f"low = {signed(low)} {unit} is not below high = {signed(high)} {unit}; {cure}"
            return
    try:
        Record(**record.model_dump())
    except RecordError as problem:
        yield str(problem)
        return
    least, most = about["limits"]
    stated = {name: number for name in ("value", "low", "high") if (number := getattr(record, name)) is not None}
    wrong = {name: number for name, number in stated.items() if not least <= number <= most}
    for name, number in wrong.items():
        yield f"{name} = {signed(number)} {unit}: must be {signed(least)} to {signed(most)} {unit}"
    if record.quantity == "resolution" and not wrong and any(number != int(number) for number in stated.values()):
        yield "must be a whole number of bits"


def _nearest(place: Place) -> str:
    return did_you_mean(str(place[-1]), (DeviceRecordTable if place[0] == "record" else DeviceTable).model_fields)
