"""Names of constants mapped to the fields of the mechanisms.

From fields declared with `constant` an observer is built, a file of records is read, and a table of draws is checked.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, Field, field, fields
from typing import Any, Generic, NamedTuple, TypeVar

from thermicon.base.files.records import Record, RecordTable

from .channels import CHANNELS, Channel, Variable, source_of

T = TypeVar("T")
Range = tuple[float, float]
ABOVE_0: Range = (math.nextafter(0.0, 1.0), math.inf)
FROM_0: Range = (0.0, math.inf)
SHARE: Range = (0.0, 1.0)
CORRELATION: Range = (-1.0, 1.0)
ANY: Range = (-math.inf, math.inf)
QUANTITIES: Mapping[str, str] = {
    "memory noise (episodes)": "memory noise",
    "path of the hand": "path length to the cord",
    "path of the forearm": "path length to the cord",
}
"""Quantities of records, where they are not the constant's name without its channel."""


class Both(NamedTuple, Generic[T]):
    """A constant of which each channel has its own."""

    cold: T
    warm: T

    def of(self, channel: Channel) -> T:
        """The channel's."""
        return self.cold if channel == "cold" else self.warm


def constant(
    name: str,
    within: Range = ABOVE_0,
    *,
    default: Any = MISSING,
    scale: float = 1.0,
    only: Variable | None = None,
    task: bool = False,
    span: bool = False,
    **keys: str,
) -> Any:
    """A field of a mechanism by the `name` of its prior, with {} for the channel where each has its own.

    Its value is `scale` times that of files, and lies `within` a range. `only` is the variant that has it, `keys` are
    those of its record in an observer file. A `task` constant is used by laboratory tasks only, and may be
    missing there; the value of a `span` is an interval.
    """
    names = tuple(name.format(channel) for channel in CHANNELS) if "{}" in name else (name,)
    quantity = QUANTITIES.get(name, name.removeprefix("{} "))
    own = {"names": names, "quantity": quantity, "within": within, "scale": scale, "only": only}
    return field(default=default, metadata={**own, "task": task, "span": span, "keys": keys})


def constants_of(kind: Any, variable: Variable | None = None) -> Iterator[Field[Any]]:
    """The declared constants of an observer or a mechanism, those of other variants left out."""
    for each in fields(kind):
        if each.metadata and (variable is None or each.metadata["only"] in (None, variable)):
            yield each


def names_of(kind: Any, *chosen: str) -> tuple[str, ...]:
    """Names of some fields, in this order, or of all constants."""
    held = {each.name: each for each in constants_of(kind)}
    return tuple(name for own in chosen or held if own in held for name in held[own].metadata["names"])


def ranges_of(kind: Any) -> dict[str, Range]:
    """Ranges of the constants, by name."""
    return {name: each.metadata["within"] for each in constants_of(kind) for name in each.metadata["names"]}


def name_of(record: Record) -> str:
    """Name of the constant that a record of an observer file holds."""
    name = f"{record.channel} {record.quantity}" if record.channel in CHANNELS else record.quantity
    return next((own for own, quantity in QUANTITIES.items() if quantity == name), name)


def quantity_of(name: str) -> tuple[str, str]:
    """Channel, or `both`, and quantity of a constant by its name."""
    channel, _, rest = name.partition(" ")
    return (channel, rest) if channel in CHANNELS else ("both", QUANTITIES.get(name, name))


def record_of(table: RecordTable, kind: Any, field: str, channel: Channel | None = None) -> Record:
    """The record of a field, or of its part for one channel; a `RecordError` names what is missing."""
    (each,) = (one for one in constants_of(kind) if one.name == field)
    return table.one(
        each.metadata["quantity"], **each.metadata["keys"], **({} if channel is None else {"channel": channel})
    )


def values_in(table: RecordTable, kind: Any, variable: Variable) -> dict[str, Any]:
    """Values of a table by name; a variant's own number stands under the quantity's name with the variant's ending.

    What is missing is a `RecordError`, but for constants of laboratory tasks and those with a default.
    """
    ending, there, found = source_of(variable), {record.quantity for record in table}, {}
    for each in constants_of(kind, variable):
        about, quantity = each.metadata, each.metadata["quantity"]
        optional = about["task"] or (each.default is not MISSING and about["only"] is None)
        if optional and quantity not in there:
            continue
        own = f"{quantity}{ending}" if f"{quantity}{ending}" in there else quantity
        for name, channel in zip(about["names"], CHANNELS, strict=False):
            record = table.one(own, **about["keys"], **({"channel": channel} if len(about["names"]) > 1 else {}))
            found[name] = record.interval if about["span"] else record.central
    return found


def fields_from(kind: Any, values: Mapping[str, Any], variable: Variable) -> dict[str, Any]:
    """Fields of an observer from values by name; what is missing keeps its default, further values are left alone."""
    found: dict[str, Any] = {"variable": variable}
    for each in constants_of(kind, variable):
        names, scale = each.metadata["names"], each.metadata["scale"]
        if each.default is not MISSING and names[0] not in values:
            continue
        numbers = [values[name] if scale == 1.0 else scale * values[name] for name in names]
        found[each.name] = Both(*numbers) if len(numbers) > 1 else numbers[0]
    return found


def values_of(held: Any) -> Iterator[tuple[str, Range, Any]]:
    """Name, range and value of every constant that an observer or a mechanism has; a span is a tuple."""
    for each in constants_of(held):
        own, names = getattr(held, each.name), each.metadata["names"]
        if own is not None:
            for name, value in zip(names, own if len(names) > 1 else (own,), strict=True):
                yield name, each.metadata["within"], value


BETWEEN_LABORATORIES = "sensitivity between laboratories"
"""The spread (ln) of offsets, which is a prior of its own: no constant of a person."""


def offsets_in(values: Mapping[str, float], places: Sequence[str]) -> dict[str, Both[float]]:
    """Sensitivity of laboratories' people above the usual (ln), from values by name."""
    spread = values[BETWEEN_LABORATORIES]
    return {place: Both(*(spread * values[f"{place} {channel}"] for channel in CHANNELS)) for place in places}


def objection_to(within: Range, value: float) -> str | None:
    """Why a constant cannot have a value; None where it can."""
    low, high = within
    if low <= value <= high:
        return None
    if within == ABOVE_0:
        return "must be above 0"
    return f"must lie in {low:g} to {high:g}" if math.isfinite(high) else f"must be {low:g} or more"
