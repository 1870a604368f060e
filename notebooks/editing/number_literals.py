"""Numbers where they are written: found in the text of one statement, and put anew in the writer's own unit."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING

from thermicon.icons.model.statements import Current, Ramp, Return
from thermicon.icons.model.units import UNITS, Kind

if TYPE_CHECKING:
    from thermicon.icons.model.statements import Leaf

_BLANK = r"[ \t\u00a0\u202f]*"
_NUMBER = r"[+\-\u2212]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+\-\u2212]?[0-9]+)?"
_UNITS = "|".join(
    sorted({re.escape(unit) for units in UNITS.values() for unit in units if unit}, key=len, reverse=True)
)
_AMOUNT = re.compile(rf"(?<![\w-])(by|to|at|over|for|every){_BLANK}({_NUMBER}){_BLANK}({_UNITS})(?![\w/])")
_END = re.compile(r"[;{}#\r\n]")
_LINE = re.compile(r"\r\n|\r|\n")
_WORD = re.compile(r"(?:(step|pulse)[ \t\u00a0\u202f]+)?(warm|cool)(?![\w-])")

# Per unit, what is rounded to: a step, and finer ones for what is smaller than five times as much.
_STEPS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("°C", "degC", "K"), ("0.1", "0.01", "0.001")),
    **{"s": ("0.05", "0.01", "0.001", "0.0001"), "ms": ("50", "10", "1", "0.1"), "min": ("0.001", "0.0001")},
    **{"A": ("0.01", "0.001"), "mA": ("10", "1")},
}
_SMALL = 5
_DIGITS = (2, 3, 4, 5)


@dataclass(frozen=True, slots=True)
class Amount:
    """One number of a statement in a text: offsets of the number, as written, and its unit."""

    start: int
    end: int
    number: str
    unit: str

    def text(self, value: Decimal) -> str:
        """A value in this unit, with the writer's kind of sign."""
        plain = format(value.normalize(), "f")
        if plain.startswith("-"):
            return ("−" if "−" in self.number else "-") + plain[1:]
        return ("+" if self.number.startswith("+") else "") + plain

    def in_unit(self, value: float, kind: Kind) -> float:
        """An SI value in this unit."""
        return value / float(UNITS[kind][self.unit])

    def si(self, value: Decimal, kind: Kind) -> float:
        """The SI value of a number in this unit, as reading the text gives it."""
        return float(Fraction(value) * UNITS[kind][self.unit])

    def step(self, value: float, kind: Kind) -> float:
        """What an SI value is rounded to, in SI: 0.1 °C, 0.05 s, 0.01 A, finer where it is small."""
        return self.si(self._step(self.in_unit(value, kind)), kind)

    def rounded(self, value: float, kind: Kind) -> Decimal:
        """An SI value in this unit, rounded to its step."""
        own = self.in_unit(value, kind)
        step = self._step(own)
        return round(Decimal(repr(own)) / step) * step

    def exactly(self, value: float, kind: Kind) -> str:
        """An SI value written in this unit, to a millionth."""
        return self.text(round(Decimal(repr(self.in_unit(value, kind))), 6))

    def _step(self, own: float) -> Decimal:
        steps = [Decimal(step) for step in _STEPS[self.unit]]
        return next((each for each in steps if abs(own) >= _SMALL * float(each)), steps[-1])

    def rate(self, amount: float, duration_s: float, kind: Kind) -> Decimal:
        """The rate that takes an amount (SI) in a time, in two digits, or as many more as keep the time to 20 ms."""
        own = self.in_unit(amount / duration_s, kind)
        found = Decimal(0)
        for digits in _DIGITS:
            found = Decimal(f"{own:.{digits - 1}e}")
            if abs(amount / self.si(found, kind) - duration_s) <= min(0.02, 0.02 * duration_s):
                break
        return found


@dataclass(frozen=True, slots=True)
class Written:
    """A statement where it stands in a text: its numbers by keyword, and the word for its direction, if it has one."""

    amounts: Mapping[str, Amount]
    direction: tuple[int, int] | None


def written(text: str, span: tuple[int, int]) -> Written:
    """Find the numbers of the statement that begins at a line and column (from 1) of a text.

    >>> written("cue 1\\nicon dip { cool by 6 °C at 3 °C/s }", (2, 12)).amounts["by"].number
    '6'
    """
    begin = offset_of(text, span)
    stop = _END.search(text, begin)
    end = stop.start() if stop else len(text)
    amounts: dict[str, Amount] = {}
    for match in _AMOUNT.finditer(text, begin, end):
        amounts.setdefault(match[1], Amount(*match.span(2), match[2], match[3]))
    word = _WORD.match(text, begin, end)
    return Written(amounts, word.span(2) if word else None)


def keyword_of(leaf: Leaf, field: str) -> str:
    """Return the word that a field of a statement stands behind.

    >>> from thermicon.icons.model.statements import Hold
    >>> keyword_of(Hold(4), "duration_s")
    'for'
    """
    if field == "duration_s":
        return "over" if isinstance(leaf, Ramp | Current | Return) else "for"
    return "every" if field == "period_s" else "at" if "per_s" in field else field[:2]


def kind_of(leaf: Leaf, field: str, control: str) -> Kind:
    """Return what kind of quantity a field of a statement is."""
    if field in ("duration_s", "period_s"):
        return "time"
    if "per_s" in field:
        return "current_rate" if control == "current" else "rate"
    return {"by_K": "change", "to_C": "absolute"}.get(field, "current")  # type: ignore[return-value]


def replaced(text: str, edits: Mapping[tuple[int, int], str]) -> str:
    """Return the text with other words at these offsets, everything between them untouched."""
    for start, end in sorted(edits, reverse=True):
        text = text[:start] + edits[start, end] + text[end:]
    return text


def offset_of(text: str, span: tuple[int, int]) -> int:
    """Offset of a line and column; lines end as the reader of cue text takes them to, and a mark of order is none."""
    line, column = span
    starts = [1 if text.startswith("\ufeff") else 0, *(match.end() for match in _LINE.finditer(text))]
    return starts[line - 1] + column - 1
