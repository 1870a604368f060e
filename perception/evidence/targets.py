"""Targets of the validation.

Published numbers themselves come from the table of thresholds alone.
"""

import tomllib
from dataclasses import dataclass

from pydantic import ConfigDict, TypeAdapter, ValidationError

from thermicon.base.files.records import Record, RecordError, RecordTable

from ..observer.observer import DATA

RULES: dict[str, tuple[str, ...]] = {
    "factor": ("value", "published"),
    "share": ("value", "published"),
    "range": ("low", "high"),
    "published range": ("published",),
    "above": ("value",),
    "below": ("value",),
    "at least": ("value",),
    "sign": ("published",),
    "close": ("value", "published"),
    "shown": (),
}
"""Rules by which a row is judged, and what each needs of the row."""
PAIRED = ("warm over cold", "cold over warm", "cold minus warm")
"""What takes the predictions, and the published numbers, of both channels."""
APPLY = ("", "negative", "one plus", "times", *PAIRED)
MINUS = "−"


@dataclass(frozen=True, slots=True)
class Published:
    """The published result for a row (no numbers: a direction only); `fitted`: constants were inferred from it."""

    text: str
    source: str
    conditions: str = ""
    unit: str = ""
    value: float | None = None
    low: float | None = None
    high: float | None = None
    fitted: bool = False


@dataclass(frozen=True, slots=True)
class TargetRow:
    """One number of a target, the rule it is judged by; `compared`: what was published is the same quantity."""

    __pydantic_config__ = ConfigDict(extra="forbid")

    name: str
    channel: str
    unit: str
    experiment: str
    quantity: str
    rule: str
    source: str
    value: float | None = None
    low: float | None = None
    high: float | None = None
    apply: str = ""
    times: str = ""
    says: str = ""
    predicted_where: str = ""
    published: str = ""
    published_site: str = ""
    published_where: str = ""
    published_apply: str = ""
    compared: bool = True

    def __post_init__(self) -> None:
        here = f"targets: {self.name!r}"
        if self.rule not in RULES:
            raise RecordError(f"{here}: rule = {self.rule!r} is not one of {', '.join(RULES)}")
        if self.apply not in APPLY or self.published_apply not in ("", *PAIRED):
            raise RecordError(
                f"{here}: apply = {self.apply or self.published_apply!r} is not one of {', '.join(APPLY)}"
            )
        for needed in RULES[self.rule]:
            if getattr(self, needed) in (None, ""):
                raise RecordError(f"{here}: the rule {self.rule!r} needs {needed}")

    @property
    def judged(self) -> bool:
        """Whether the row gets a verdict."""
        return self.rule != "shown"

    @property
    def label(self) -> str:
        """Name with the channel, where there is one."""
        return f"{self.name}, {self.channel}" if self.channel in ("cold", "warm") else self.name


@dataclass(frozen=True, slots=True)
class Target:
    """One published result: number, title, whose it is, what it asks, the mechanism suspected of misses, its rows."""

    __pydantic_config__ = ConfigDict(extra="forbid")

    number: int
    title: str
    source: str
    asks: str
    mechanism: str
    rows: tuple[TargetRow, ...]


def load_targets() -> tuple[Target, ...]:
    """The shipped targets in the order of their numbers.

    >>> [target.number for target in load_targets()]
    [1, 2, 3, 4, 5, 6, 7, 8, 9]
    """
    return read_targets((DATA / "targets.toml").read_text(encoding="utf-8"))


def read_targets(text: str) -> tuple[Target, ...]:
    """Targets from the text of a file; a RecordError says what is wrong in it, and where."""
    try:
        return TypeAdapter(tuple[Target, ...]).validate_python(tomllib.loads(text)["target"])
    except ValidationError as fault:
        first = fault.errors()[0]
        place = ", ".join(str(part) for part in first["loc"])
        raise RecordError(f"targets.toml: target {place}: {first['msg']}") from None


def published_for(row: TargetRow, table: RecordTable) -> Published:
    """A table's result for a row; a `RecordError` where no record, or more than one, fits what the row names."""
    if not row.published:
        return Published(row.says or "–", "" if row.says else "nothing published")
    apply = row.published_apply or (row.apply if row.apply in PAIRED else "")
    if apply:
        cold, warm = (_record(row, table, channel) for channel in ("cold", "warm"))
        if cold.channel != "both":
            value = combined(apply, cold.central, warm.central)
            return _published(row, cold, plain(value), "1", value)
    record = _record(row, table, row.channel if row.channel in ("cold", "warm") else "")
    unit = "" if record.unit in ("1", "sign") else f" {record.unit}"
    low, high = record.low, record.high
    number = plain(record.value) if record.value is not None else ""
    if record.unit == "sign":
        number = MINUS if record.central < 0 else "+"
    span = f"{plain(low)} to {plain(high)}" if low is not None and high is not None else ""
    text = f"{number} [{span}]" if number and span else number or span
    return _published(row, record, f"{text}{unit}", record.unit, record.value, low, high)


def combined(apply: str, cold: float, warm: float) -> float:
    """One number from those of both channels.

    >>> combined("warm over cold", 0.5, 1.5), combined("cold minus warm", 0.5, 1.5)
    (3.0, -1.0)
    """
    if apply == "cold minus warm":
        return cold - warm
    return warm / cold if apply == "warm over cold" else cold / warm


def plain(value: float) -> str:
    """Three digits, with a real minus sign.

    >>> plain(-0.12345), plain(16.466), plain(0.0)
    ('−0.123', '16.5', '0')
    """
    text = f"{value:.3g}"
    if "e" in text:
        text = f"{value:.1e}" if abs(value) < 1e-3 else f"{value:.0f}"
    return text.replace("-", MINUS)


def _published(row: TargetRow, record: Record, number: str, unit: str, *numbers: float | None) -> Published:
    """A published number in the words of its row, marked where the constants were inferred from it."""
    said, fitted = row.says.replace("{}", number) if row.says else number, record.use == "calibrate"
    under = "; ".join(part for part in (record.site, record.method, record.conditions) if part)
    value, low, high = (*numbers, None, None)[:3]
    return Published(f"{said}{', fitted' * fitted}", record.source, under, unit, value, low, high, fitted)


def _record(row: TargetRow, table: RecordTable, channel: str) -> Record:
    found = table.select(row.published, channel=channel, site=row.published_site)
    fits = [record for record in found if record.conditions.startswith(row.published_where)]
    if len(fits) != 1:
        where = f" whose conditions begin with {row.published_where!r}" if row.published_where else ""
        raise RecordError(
            f"{table.name}: {len(fits)} records of {row.published!r}{where} for {row.label!r}: one is needed"
        )
    return fits[0]
