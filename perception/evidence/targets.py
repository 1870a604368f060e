"""What the observer has to explain: targets and their rows, read from `data/targets.toml`.

A row names the prediction of an experiment, the published record it is compared with, and the rule
by which it is judged. Published numbers themselves come from the table of thresholds alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from thermicon.circuit.records import Record, RecordError, Table, load_records

from ..observer.observer import DATA

COLUMNS = (
    "kind", "target", "name", "asks", "mechanism", "experiment", "rule", "apply", "times", "says",
    "predicted_where", "published", "published_site", "published_where", "published_apply",
)  # fmt: skip
RULES = ("factor", "share", "range", "published range", "above", "below", "at least", "sign", "close", "shown")
APPLY = ("", "negative", "one plus", "times", "warm over cold", "cold over warm", "cold minus warm")
PAIRED = APPLY[4:]
"""What takes the predictions, and the published numbers, of both channels."""


@dataclass(frozen=True, slots=True)
class Published:
    """What was published for a row: `value`, `low`, `high` in `unit` (None: a direction only), as text and whence.

    `fitted` marks what the constants were inferred from, which is no prediction.
    """

    text: str
    source: str
    conditions: str = ""
    unit: str = ""
    value: float | None = None
    low: float | None = None
    high: float | None = None
    fitted: bool = False


@dataclass(frozen=True, slots=True)
class Row:
    """One number of a target: the prediction it names, the rule and its numbers (`value`, `low`, `high`)."""

    target: int
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

    def __post_init__(self) -> None:
        here = f"targets: {self.name!r}"
        if self.rule not in RULES:
            raise RecordError(f"{here}: rule = {self.rule!r} is not one of {', '.join(RULES)}")
        if self.apply not in APPLY or self.published_apply not in ("", *PAIRED):
            raise RecordError(
                f"{here}: apply = {self.apply or self.published_apply!r} is not one of {', '.join(APPLY)}"
            )
        if self.rule in ("factor", "share", "above", "below", "at least", "close") and self.value is None:
            raise RecordError(f"{here}: the rule {self.rule!r} needs a value")
        if self.rule == "range" and (self.low is None or self.high is None):
            raise RecordError(f"{here}: the rule 'range' needs low and high")
        if self.rule in ("factor", "share", "published range", "sign", "close") and not self.published:
            raise RecordError(f"{here}: the rule {self.rule!r} needs a published record")

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
    """One published result: number, title, what it asks, whose it is, the mechanism suspected of misses, its rows."""

    number: int
    title: str
    asks: str
    source: str
    mechanism: str
    rows: tuple[Row, ...]


def load_targets(path: Path | None = None) -> tuple[Target, ...]:
    """The shipped targets, or those of another file, in the order of their numbers.

    >>> [target.number for target in load_targets()]
    [1, 2, 3, 4, 5, 6, 7, 8, 9]
    """
    table = load_records(DATA / "targets.toml" if path is None else path, extra=COLUMNS)
    rows = [_row(record) for record in table if _text(record, "kind") == "row"]
    made = []
    for record in table:
        kind = _text(record, "kind")
        if kind not in ("target", "row"):
            raise RecordError(f"{table.name}: {record.quantity!r} has kind = {kind!r}, which is neither target nor row")
        if kind == "target":
            number = _number(record)
            own = tuple(row for row in rows if row.target == number)
            if not own:
                raise RecordError(f"{table.name}: target {number} has no row")
            made.append(
                Target(number, record.quantity, _text(record, "asks"), record.source, _text(record, "mechanism"), own)
            )
    lost = {row.target for row in rows} - {target.number for target in made}
    if lost:
        raise RecordError(f"{table.name}: rows of target {min(lost)}, which is not there")
    return tuple(sorted(made, key=lambda target: target.number))


def published_for(row: Row, table: Table) -> Published:
    """What a table of published numbers has for a row.

    Raises `RecordError` where no record, or more than one, fits what the row names.
    """
    if not row.published:
        return Published(row.says or "–", "" if row.says else "nothing published")
    apply = row.published_apply or (row.apply if row.apply in PAIRED else "")
    if apply:
        cold, warm = (_record(row, table, channel) for channel in ("cold", "warm"))
        if cold.channel != "both":
            value = combined(apply, cold.central, warm.central)
            text = _said(row, _digits(value)) + _fitted(cold)
            return Published(text, cold.source, _under(cold), "1", value, fitted=cold.use == "calibrate")
    record = _record(row, table, row.channel if row.channel in ("cold", "warm") else "")
    unit = "" if record.unit in ("1", "sign") else f" {record.unit}"
    low, high = record.low, record.high
    number = _digits(record.value) if record.value is not None else ""
    if record.unit == "sign":
        number = "−" if record.central < 0 else "+"
    span = f"{_digits(low)} to {_digits(high)}" if low is not None and high is not None else ""
    text = f"{number} [{span}]" if number and span else number or span
    said = _said(row, f"{text}{unit}") + _fitted(record)
    fitted = record.use == "calibrate"
    return Published(said, record.source, _under(record), record.unit, record.value, low, high, fitted)


def combined(apply: str, cold: float, warm: float) -> float:
    """One number from those of both channels.

    >>> combined("warm over cold", 0.5, 1.5), combined("cold minus warm", 0.5, 1.5)
    (3.0, -1.0)
    """
    if apply == "cold minus warm":
        return cold - warm
    return warm / cold if apply == "warm over cold" else cold / warm


def _digits(value: float) -> str:
    return f"{value:.3g}".replace("-", "−")


def _said(row: Row, number: str) -> str:
    return row.says.replace("{}", number) if row.says else number


def _fitted(record: Record) -> str:
    """The mark of what the constants were inferred from."""
    return ", fitted" if record.use == "calibrate" else ""


def _under(record: Record) -> str:
    return "; ".join(part for part in (record.site, record.method, record.conditions) if part)


def _record(row: Row, table: Table, channel: str) -> Record:
    found = table.select(row.published, channel=channel, site=row.published_site)
    fits = [record for record in found if record.conditions.startswith(row.published_where)]
    if len(fits) != 1:
        where = f" whose conditions begin with {row.published_where!r}" if row.published_where else ""
        raise RecordError(
            f"{table.name}: {len(fits)} records of {row.published!r}{where} for {row.label!r}: one is needed"
        )
    return fits[0]


def _row(record: Record) -> Row:
    texts = {key: _text(record, key) for key in COLUMNS if key not in ("kind", "target", "asks", "mechanism")}
    return Row(
        target=_number(record),
        channel=record.channel,
        unit=record.unit,
        quantity=record.quantity,
        source=record.source,
        value=record.value,
        low=record.low,
        high=record.high,
        **texts,
    )


def _text(record: Record, key: str) -> str:
    return str(dict(record.extra).get(key, ""))


def _number(record: Record) -> int:
    found = dict(record.extra).get("target")
    if not isinstance(found, float):
        raise RecordError(f"targets: {record.quantity!r} does not say of which target: add target = its number")
    return int(found)
