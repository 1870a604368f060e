"""Numbers in the text of a statement and their change in place."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from decimal import Decimal
from fractions import Fraction
from typing import Any

from thermicon.icons import Icon
from thermicon.icons.model.statements import Current, Leaf, Ramp, Repeat, Return, Total
from thermicon.icons.model.units import UNITS, Kind

from .cue_check import read_text

_BLANK = r"[ \t\u00a0\u202f]*"
_NUMBER = r"[+\-\u2212]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+\-\u2212]?[0-9]+)?"
_UNITS = "|".join(
    sorted({re.escape(unit) for units in UNITS.values() for unit in units if unit}, key=len, reverse=True)
)
_AMOUNT = re.compile(rf"(?<![\w-])(by|to|at|over|for|every){_BLANK}({_NUMBER}){_BLANK}({_UNITS})(?![\w/])")
_COUNT = re.compile(r"repeat\s+([0-9]+)")
_END = re.compile(r"[;{}#\r\n]")
_PIECE = re.compile(r'"(?:[^"\\\n]|\\.)*"|#[^\r\n]*|[{}]')
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


class CannotEdit(ValueError):
    """An edit does not fit the text; the sentence says why, or what to do by hand."""


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
        """The rounding step of an SI value, in SI: 0.1 °C, 0.05 s, 0.01 A, finer where it is small."""
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
class WrittenStatement:
    """A statement where it stands in a text: its numbers by keyword, and the word for its direction, if it has one."""

    amounts: Mapping[str, Amount]
    direction: tuple[int, int] | None


def written(text: str, span: tuple[int, int]) -> WrittenStatement:
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
    return WrittenStatement(amounts, word.span(2) if word else None)


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


def with_edit(text: str, edited: Icon, old: str, new: str) -> str:
    """Return the text in which an icon is as edited; comments, and all that is not edited, stay as they are written.

    ``old`` and ``new`` are the lines that show the edit. Raises CannotEdit where the text has changed since, where a
    family writes the icon, or where the edit is more than one number or repeat.

    >>> from thermicon.icons import parse
    >>> from thermicon.icons.model.changes import numbers_of, with_number
    >>> text = "cue 1\\nicon dip { cool by 6 °C at 3 °C/s; return at 3 °C/s } # deep"
    >>> icon = parse(text)["dip"]
    >>> with_edit(text, with_number(icon, numbers_of(icon, 32.0)[0], 6.5), "cool by 6 …", "cool by 6.5 …")
    'cue 1\\nicon dip { cool by 6.5 °C at 3 °C/s; return at 3 °C/s } # deep'
    """
    by_hand = f"change it by hand: in {edited.name}, {old} → {new}"
    reading = read_text(text)
    icon = reading.find(edited.name)
    if icon is None:
        raise CannotEdit(f"no icon is called {edited.name} now; {by_hand}")
    family = reading.family_of(edited.name)
    if family is not None:
        raise CannotEdit(f"{edited.name} is written by the family {family.name}, all of which would change; {by_hand}")
    parts = [part for part in icon.statements if not isinstance(part, Total)]
    first, candidates = edited.statements[0], list[str]()
    if isinstance(first, Repeat) and first.body == tuple(parts) and (made := _repeated(text, icon, first.count)):
        candidates.append(made)
    edits = list(_numbers(text, icon.statements, edited.statements, icon.context.control))
    if len(edits) == 1:  # more than one: the text is not the one that the edit was found for
        candidates.append(replaced(text, dict(edits)))
    for tried in candidates:
        found = read_text(tried).find(edited.name)
        if found is not None and found.statements == edited.statements:
            return tried
    raise CannotEdit(f"the text has changed, or the edit does not fit it; {by_hand}")


def _numbers(
    text: str, before: Sequence[Any], after: Sequence[Any], control: str
) -> Iterator[tuple[tuple[int, int], str]]:
    """Places in the text of the numbers that differ, with their new text."""
    for old, new in zip(before, after, strict=False):
        if old == new or type(old) is not type(new) or old.span is None:
            continue
        if isinstance(old, Repeat):
            match = _COUNT.match(text, offset_of(text, old.span))
            if match is not None and old.count != new.count:
                yield match.span(1), str(new.count)
            yield from _numbers(text, old.body, new.body, control)
            continue
        place = written(text, old.span)
        for each in fields(old):
            value = getattr(new, each.name)
            if not each.compare or value == getattr(old, each.name) or not isinstance(value, float):
                continue
            if amount := place.amounts.get(keyword_of(old, each.name)):
                yield (amount.start, amount.end), amount.exactly(value, kind_of(old, each.name, control))


def _repeated(text: str, icon: Icon, count: int) -> str | None:
    """The text with a repeat around the statements of an icon; None where they are not to be found."""
    parts = [part for part in icon.statements if not isinstance(part, Total)]
    if any(part.span is None for part in parts) or isinstance(icon.statements[0], Total):
        return None
    begin = offset_of(text, parts[0].span)  # type: ignore[arg-type]
    checks = [part for part in icon.statements if isinstance(part, Total) and part.span is not None]
    stop = offset_of(text, checks[0].span) if checks else _closing(text, begin)  # type: ignore[arg-type]
    head, body, tail = text[:begin], text[begin:stop], text[stop:]
    if "\n" not in body:
        return f"{head}repeat {count} {{ {body.strip().rstrip(';')} }}{'; ' if checks else ' '}{tail}"
    indent = head[head.rfind("\n") + 1 :]
    lines = body.rstrip().splitlines(keepends=True)
    inner = "".join([f"{indent}  {lines[0]}", *(f"  {line}" if line.strip() else line for line in lines[1:])])
    between = body[len(body.rstrip()) :]
    return f"{head}repeat {count} {{\n{inner}\n{indent}}}{between}{tail}"


def _closing(text: str, begin: int) -> int:
    """Offset of the brace that closes the block in which a place stands; the end of the text where there is none."""
    depth = 1
    for piece in _PIECE.finditer(text, begin):
        depth += {"{": 1, "}": -1}.get(piece[0], 0)
        if depth == 0:
            return piece.start()
    return len(text)
