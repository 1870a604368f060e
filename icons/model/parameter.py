"""A parameter of a family: its name, its unit and the values it takes, listed or counted out from a range."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from .context import name_fault
from .units import UNITS, Kind, decimal_text, exact_number

# Of one parameter: no family has more members.
MOST_VALUES = 100_000


def unit_fault(unit: str) -> str | None:
    """Return what keeps a text from being a unit of a parameter, or None; a count has the unit ``""``."""
    if any(unit in units for units in UNITS.values()):
        return None
    return f"{unit!r} is not a unit"


@dataclass(frozen=True, slots=True, repr=False)
class Parameter:
    """What varies in a family: ``listed`` values, or a ``span`` of (low, high, step), as numbers in ``unit``.

    The unit is one of the language's (``degC`` becomes ``°C``), or ``""`` for a count. A span includes both ends, and
    its step must lead from one to the other. Raises ValueError for a bad name or unit, no value, one value twice, or a
    span that does not come out.

    >>> Parameter("rate", "°C/s", span=(1, 3, 0.5)).texts()
    ('1', '1.5', '2', '2.5', '3')
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
        if wrong := name_fault(self.name) or unit_fault(self.unit):
            raise ValueError(f"parameter {self.name}: {wrong}")
        if any(self.name in units for units in UNITS.values()):
            raise ValueError(f"parameter {self.name}: this is the name of a unit")
        if bool(self.listed) == (self.span is not None):
            raise ValueError(f"parameter {self.name} needs either listed values or a span, and not both")
        if len(set(self.listed)) < len(self.listed):
            raise ValueError(f"parameter {self.name} has one value twice")
        if self.span is not None and (wrong := span_fault(*self.span)):
            raise ValueError(f"parameter {self.name}: {wrong}")
        object.__setattr__(self, "numbers", self._numbers())

    def _numbers(self) -> tuple[tuple[int, ...], int, int]:
        # Whole numbers over one power of ten: dividing two whole numbers gives the float nearest to the decimal.
        parts = [exact_number(decimal_text(value)) for value in self.span or self.listed]
        scale = max(part.denominator for part in parts)
        power = next(10**n for n in range(1100) if all((part * 10**n).denominator == 1 for part in parts)) or scale
        whole = tuple(int(part * power) for part in parts)
        count = len(whole) if self.span is None else (whole[1] - whole[0]) // whole[2] + 1
        return whole, power, count

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

    def texts(self) -> tuple[str, ...]:
        """Return all values as decimal text."""
        return tuple(map(self.text, range(len(self))))

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
    """Return what keeps three numbers from being a range that can be counted out, or None.

    >>> span_fault(1, 3, 0.7)
    '3 is not reached from 1 in steps of 0.7'
    """
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
