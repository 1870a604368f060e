"""Sourced numbers in TOML tables of `[[record]]` blocks: a number without a source does not load."""

import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from ..checks.arguments import InputError
from ..words.near_words import did_you_mean, nearest_words
from .inputs import read_text, read_toml

Plain = str | float
USES = ("calibrate", "predict", "assumed", "reference")
CONFIDENCES = ("high", "medium", "low")
MOST_MB = 1.0
_NUMBERS = ("value", "low", "high")


class RecordError(InputError):
    """A table or a look-up in it is wrong; the message names file, entry and cure."""


@dataclass(frozen=True, slots=True)
class Record:
    """One sourced number: `value` is central, `low` and `high` its interval, `extra` the further columns of a table."""

    quantity: str
    unit: str
    source: str
    value: float | None = None
    low: float | None = None
    high: float | None = None
    channel: str = ""
    site: str = ""
    method: str = ""
    conditions: str = ""
    confidence: str = ""
    use: str = ""
    extra: tuple[tuple[str, Plain], ...] = ()

    def __post_init__(self) -> None:
        if not self.quantity.strip():
            raise RecordError('the record has no quantity: add quantity = "what the number is"')
        if not self.source.strip():
            raise RecordError('the record has no source: add source = "author year, place"')
        numbers = [n for n in (self.value, self.low, self.high) if n is not None]
        if not numbers and not any(isinstance(v, float) for _, v in self.extra):
            raise RecordError("the record has no number: add value, or low and high")
        if not all(math.isfinite(n) for n in numbers):
            raise RecordError("value, low and high must be finite numbers: leave out what is not known")
        known = [n for n in (self.low, self.value, self.high) if n is not None]
        if known != sorted(known):
            stated = [f"{name} = {n!r}" for name in ("low", "value", "high") if (n := getattr(self, name)) is not None]
            raise RecordError(f"{' and '.join(stated)} are not in rising order: low comes first, high last")
        if self.use and self.use not in USES:
            raise RecordError(f"use = {self.use!r} is not one of {', '.join(USES)}")
        if self.confidence and self.confidence not in CONFIDENCES:
            raise RecordError(f"confidence = {self.confidence!r} is not one of {', '.join(CONFIDENCES)}")

    @property
    def central(self) -> float:
        """`value`, or the middle of the interval, or its only end."""
        if self.value is not None:
            return self.value
        ends = [n for n in (self.low, self.high) if n is not None]
        if not ends:
            raise RecordError(f"{self.quantity}: only its further columns have numbers, read them with get()")
        return sum(ends) / len(ends)

    @property
    def interval(self) -> tuple[float, float]:
        """(low, high); an end that is not stated is the central value."""
        middle = self.central
        return (middle if self.low is None else self.low, middle if self.high is None else self.high)

    def get(self, key: str) -> Plain:
        """Value of a further column of this table."""
        known = dict(self.extra)
        if key not in known:
            raise RecordError(f"{self.quantity}: no column {key!r}; {did_you_mean(key, known)}")
        return known[key]


@dataclass(frozen=True, slots=True)
class RecordTable:
    """Records of one file, in its order."""

    name: str
    records: tuple[Record, ...]

    def __iter__(self) -> Iterator[Record]:
        return iter(self.records)

    def __len__(self) -> int:
        return len(self.records)

    def select(
        self,
        quantity: str,
        *,
        channel: str = "",
        site: str = "",
        method: str = "",
    ) -> tuple[Record, ...]:
        """All records that match every key given; a channel also matches records for both channels."""
        records = [record for record in self.records if record.quantity == quantity]
        if not records:
            known = dict.fromkeys(record.quantity for record in self.records)
            near = "".join(f"; it has {each!r}" for each in nearest_words(quantity, known, cutoff=0.8))
            raise RecordError(f"{self.name}: no quantity {quantity!r}{near}")
        for key, value in {"channel": channel, "site": site, "method": method}.items():
            if not value:
                continue
            matching = [r for r in records if getattr(r, key) == value or (key == "channel" and r.channel == "both")]
            if not matching:
                hint = did_you_mean(value, {getattr(r, key) for r in records})
                raise RecordError(f"{self.name}: {quantity!r} has no record with {key} = {value!r}; {hint}")
            records = matching
        return tuple(records)

    def one(self, quantity: str, *, channel: str = "", **keys: Any) -> Record:
        """The only record that matches the keys of `select`; an error when there are several or none."""
        records = self.select(quantity, channel=channel, **keys)
        if len(records) > 1:
            exact = [r for r in records if r.channel == channel]
            if channel and len(exact) == 1:
                return exact[0]
            choices = "; ".join(f"{r.channel or '-'}, {r.site or '-'}, {r.method or '-'}" for r in records)
            raise RecordError(
                f"{self.name}: {len(records)} records match {quantity!r}: say which channel, site or method ({choices})"
            )
        return records[0]


def load_records(path: Path | Traversable | str, *, extra: Iterable[str] = ()) -> RecordTable:
    """Read a TOML table of records with `extra` columns; RecordError names file, entry and cure."""
    file = Path(path) if isinstance(path, str) else path
    what = "table of records"
    text = read_text(file, what, MOST_MB, RecordError) if isinstance(file, Path) else file.read_text(encoding="utf-8")
    tree = read_toml(text, file.name, what, ("record",), RecordError)
    if set(tree) != {"record"} or not isinstance(tree["record"], list):
        raise RecordError(f"{file.name}: a table of records has [[record]] blocks and nothing else")
    declared = tuple(extra)
    return RecordTable(file.name, tuple(_record(file.name, *each, declared) for each in enumerate(tree["record"], 1)))


@cache
def shipped_records(name: str, *extra: str) -> RecordTable:
    """A table of `circuit/data` by its name; `extra` as in `load_records`."""
    return load_records(resources.files("thermicon.circuit") / "data" / name, extra=extra)


def dump_records(table: RecordTable, *, comment: str = "") -> str:
    """TOML text that `load_records` reads back; `comment` heads the file."""
    lines = [f"# {line}".rstrip() for line in comment.splitlines()]
    for record in table:
        lines += ["", "[[record]]"]
        for column in fields(record):
            value = getattr(record, column.name)
            if column.name != "extra" and value not in (None, ""):
                lines.append(f"{column.name} = {json.dumps(value, ensure_ascii=False)}")
        lines += [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in record.extra]
    return "\n".join(lines).lstrip("\n") + "\n"


def _record(file: str, index: int, entry: object, declared: tuple[str, ...]) -> Record:
    if not isinstance(entry, dict):
        raise RecordError(f"{file}: record {index} is not a block of key = value lines")
    place = f"{file}, record {index} ({entry.get('quantity', 'no quantity')})"
    field_names = [f.name for f in fields(Record) if f.name != "extra"]
    given: dict[str, Any] = {"quantity": "", "unit": "", "source": ""}
    further: list[tuple[str, Plain]] = []
    for key, value in entry.items():
        if key not in field_names and key not in declared:
            raise RecordError(f"{place}: unknown key {key!r}; {did_you_mean(key, [*field_names, *declared])}")
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise RecordError(f"{place}: {key} must be a number or a text")
        checked: Plain = value if isinstance(value, str) else float(value)
        if key in _NUMBERS and isinstance(checked, str):
            raise RecordError(f"{place}: {key} = {checked!r} must be a number without quotes or unit")
        if key in field_names and key not in _NUMBERS and not isinstance(checked, str):
            raise RecordError(f"{place}: {key} = {checked!r} must be a text in quotes")
        if key in field_names:
            given[key] = checked
        else:
            further.append((key, checked))
    try:
        return Record(**given, extra=tuple(further))
    except RecordError as problem:
        raise RecordError(f"{place}: {problem}") from None
