"""A parameter of a family with its values and the places that take them."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from thermicon.base.words.clean_text import name_fault

from .statements import Repeat, Statement
from .units import KIND_WORDS, UNITS, Control, Kind, decimal_text, exact_number, fault

# Of one parameter: no family has more members.
MOST_VALUES = 100_000
Path = tuple[int, ...]
# What the fields of statements that may vary are; by_K and rate_per_s are another kind in some statements.
_KINDS: dict[str, Kind] = {
    **{"by_K": "difference", "to_C": "absolute", "by_A": "current", "to_A": "current"},
    **{"rate_K_per_s": "rate", "rate_A_per_s": "current_rate", "rate_per_s": "rate"},
    **{"duration_s": "time", "period_s": "time", "count": "count"},
}


@dataclass(frozen=True, slots=True, repr=False)
class Parameter:
    """A parameter of a family: ``listed`` values, or a ``span`` of (low, high, step), as numbers in ``unit``.

    The unit is one of the language's (``degC`` becomes ``°C``), or ``""`` for a count. A span includes both ends, and
    its step must lead from one to the other. Raises ValueError for a bad name or unit, no value, one value twice, or a
    span that does not come out.
    """

    name: str
    unit: str
    listed: tuple[float, ...] = ()
    span: tuple[float, float, float] | None = None
    numbers: tuple[tuple[int, ...], int, int] = field(init=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "unit", self.unit.replace("degC", "°C"))
        object.__setattr__(self, "listed", tuple(float(value) + 0.0 for value in self.listed))
        if self.span is not None:
            low, high, step = (float(value) + 0.0 for value in self.span)
            object.__setattr__(self, "span", (low, high, step))
        if wrong := name_fault(self.name):
            raise ValueError(f"parameter {self.name}: {wrong}")
        if not any(self.unit in units for units in UNITS.values()):
            raise ValueError(f"parameter {self.name}: {self.unit!r} is not a unit")
        if any(self.name in units for units in UNITS.values()):
            raise ValueError(f"parameter {self.name}: this is the name of a unit")
        if bool(self.listed) == (self.span is not None):
            raise ValueError(f"parameter {self.name} needs either listed values or a span, and not both")
        if len(set(self.listed)) < len(self.listed):
            raise ValueError(f"parameter {self.name} has one value twice")
        if self.span is not None and (wrong := span_fault(*self.span)):
            raise ValueError(f"parameter {self.name}: {wrong}")
        # Whole numbers over one power of ten: dividing two whole numbers gives the float nearest to the decimal.
        parts = [exact_number(decimal_text(value)) for value in self.span or self.listed]
        power = next(10**n for n in range(1100) if all((part * 10**n).denominator == 1 for part in parts))
        whole = tuple(int(part * power) for part in parts)
        count = len(whole) if self.span is None else (whole[1] - whole[0]) // whole[2] + 1
        object.__setattr__(self, "numbers", (whole, power, count))

    def __len__(self) -> int:
        return self.numbers[2]

    def __iter__(self) -> Iterator[float]:
        return (self.value(place) for place in range(len(self)))

    def __repr__(self) -> str:
        return f"<Parameter {self}: {len(self)} value{'s' if len(self) > 1 else ''}>"

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        if self.span is not None:
            low, high, step = map(decimal_text, self.span)
            return f"{self.name} in {low}..{high} step {step}{unit}"
        return f"{self.name} in [{', '.join(map(decimal_text, self.listed))}]{unit}"

    def value(self, place: int) -> float:
        """Return the value at a place, in the parameter's own unit."""
        whole, power, _ = self.numbers
        return (whole[place] if self.span is None else whole[0] + place * whole[2]) / power

    def text(self, place: int) -> str:
        """Return the value at a place as decimal text, without its unit."""
        return decimal_text(self.value(place))

    def si(self, place: int, kind: Kind) -> float:
        """Return the value at a place in SI, as a quantity of this kind; KeyError when the unit is of another kind."""
        whole, power, _ = self.numbers
        factor: Fraction = UNITS[kind][self.unit]
        number = whole[place] if self.span is None else whole[0] + place * whole[2]
        return number * factor.numerator / (power * factor.denominator)

    def place(self, text: str) -> int | None:
        """Return the place of a value given as decimal text, or None when the parameter does not take it."""
        try:
            number = exact_number(text) * self.numbers[1]
        except ValueError:
            return None
        whole, _, count = self.numbers
        if self.span is None:
            return whole.index(int(number)) if number in whole else None
        place = (number - whole[0]) / whole[2]
        return int(place) if place.denominator == 1 and 0 <= place < count else None


def span_fault(low: float, high: float, step: float) -> str | None:
    """Return what keeps three numbers from being a range that can be counted out, or None."""
    a, b, by = (exact_number(decimal_text(value)) for value in (low, high, step))
    if by <= 0:
        return "a step is positive"
    if b <= a:
        return f"{decimal_text(high)} does not lie above {decimal_text(low)}"
    if ((b - a) / by).denominator != 1:
        return f"{decimal_text(high)} is not reached from {decimal_text(low)} in steps of {decimal_text(step)}"
    if (b - a) / by >= MOST_VALUES:
        return f"this has more than {MOST_VALUES:,} values"
    return None


@dataclass(frozen=True, slots=True)
class Slot:
    """The place of a parameter: the path of the statement (places, through repeats), its field, the name."""

    path: Path
    field: str
    kind: Kind
    parameter: str


def slot_fault(template: tuple[Statement, ...], slot: Slot, parameter: Parameter, control: Control) -> str | None:
    """Return what keeps a parameter from standing where a slot says, or None."""
    try:
        part = statement_at(template, slot.path)
    except IndexError:
        return f"there is not a statement at {slot.path}"
    value = getattr(part, slot.field, None)
    if slot.field not in _KINDS or value is None:
        return f"{slot.field} is not given by {part!r}"
    kind = _KINDS[slot.field]
    if slot.field == "by_K" and getattr(part, "direction", "") == "change":
        kind = "change"
    if slot.field == "rate_per_s" and control == "current":
        kind = "current_rate"
    if slot.kind != kind:
        return f"{slot.field} is here of kind {kind}, not {slot.kind}"
    if found := value_fault(parameter, kind):
        return found[1]
    if value != parameter.si(0, kind):
        return f"the template has {slot.field} = {value!r}, not the first value"
    try:
        for place in representative_places(parameter):
            value = parameter.si(place, kind)
            changed: dict[str, Any] = {slot.field: int(value) if kind == "count" else value}
            replace(part, **changed)
    except ValueError as error:
        return str(error)
    return None


def representative_places(parameter: Parameter) -> Sequence[int]:
    """Return places of values that stand for all: as a span rises evenly, its ends and those about 0 do."""
    if parameter.span is None:
        return range(len(parameter))
    zero = round(-parameter.span[0] / parameter.span[2])
    return [place for place in (0, zero - 1, zero, zero + 1, len(parameter) - 1) if 0 <= place < len(parameter)]


def value_fault(parameter: Parameter, kind: Kind) -> tuple[str, str] | None:
    """Return error code and words for the first value of a parameter that this kind of quantity may not have."""
    if parameter.unit not in UNITS[kind]:
        unit = f"{parameter.name} is in {parameter.unit}" if parameter.unit else f"{parameter.name} has no unit"
        return "E104", f"{unit}; {KIND_WORDS[kind]} is needed here"
    return next(
        (found for place in representative_places(parameter) if (found := fault(parameter.si(place, kind), kind))), None
    )


def statement_at(template: tuple[Statement, ...], path: Path) -> Statement:
    """Return the statement at a path of places through repeats; IndexError where there is none."""
    part = template[path[0]]
    for place in path[1:]:
        if not isinstance(part, Repeat):
            raise IndexError(f"no statement at {path}")
        part = part.body[place]  # type: ignore[assignment]
    return part


def path_of(template: tuple[Statement, ...], wanted: Statement) -> Path:
    """Return the path of a statement, by identity; LookupError when it is not there."""
    for place, part in enumerate(template):
        if part is wanted:
            return (place,)
        if isinstance(part, Repeat):
            with suppress(LookupError):
                return (place, *path_of(part.body, wanted))  # type: ignore[arg-type]
    raise LookupError("the statement is not in this template")
