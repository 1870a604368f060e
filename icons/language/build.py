"""Conversion of syntax trees to values in SI units."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from math import prod
from typing import Any, cast

from thermicon.base.words.clean_text import text_fault

from ..model.context import Metadata
from ..model.family import FEWER, MOST_MEMBERS
from ..model.parameter import Parameter, span_fault
from ..model.units import UNITS, Kind, exact_number, fault, to_si
from ..model.words import EXAMPLES, nearest
from .diagnose_family import THREE_DOTS
from .failed_statement import short
from .source import Finding, Patch, Source

Place = tuple[int, int]
_KINDS: dict[str, Kind] = {"signed": "change", "period": "time", "current_change": "current"}
_TARGETS = ("absolute", "difference", "signed", "current", "current_change", "by_use", "to_use")
_ESCAPE = re.compile(r"\\(.)")
_ESCAPES = {"n": "\n", '"': '"', "\\": "\\"}
_LIST_HELP = 'values are a list, "[1, 3] °C", or a range, "1..3 step 0.5 °C"'


@dataclass(slots=True)
class Builder:
    """Turns the tree into model parts; ``places`` of these in the text by ``id``, which ``kept`` keeps from new use."""

    source: Source
    findings: list[Finding] = field(default_factory=list)
    places: dict[int, dict[str, Place]] = field(default_factory=dict)
    kept: list[object] = field(default_factory=list)

    def parts(self, tree: Any, place: Place) -> dict[str, Place]:
        """Return the offsets of what messages may point at: word, target, pace, count, rate, whole."""
        start, end = place
        word = self.source.text[start:end].split(maxsplit=1)[0] if end > start else ""
        found = {"whole": place, "word": (start, start + len(word))}
        for part in getattr(tree, "children", ()):
            rule = rule_of(part)
            if rule in _TARGETS:
                found["target"] = span(part)
            elif rule in ("rate", "current_rate", "time", "at_use", "over_use", "for_use"):
                found["pace"] = found["time" if rule == "for_use" else rule] = span(part)
            elif getattr(part, "type", "") == "DIRECTION":
                found["direction"] = span(part)
        if rule_of(tree) == "repeat":
            found["count"] = (start, span(tree.children[0])[1])
        return found

    def quantity(self, tree: Any, wave: bool = False) -> float:
        """Return the SI value of a number with its unit; NaN, and a finding, when no statement may have it."""
        rule = str(tree.data)
        kind = _KINDS.get(rule) or cast(Kind, rule)
        number, unit = tree.children
        place, help = span(tree), EXAMPLES["difference" if kind == "change" else kind]
        try:
            value = to_si(str(number), str(unit), kind)
        except ValueError as error:
            self.add("E218", span(number), str(error), help)
            return float("nan")
        found = fault(value, kind)
        if not found and rule == "current_change" and value == 0:
            found = "E202", "a change must not be zero"
        if found:
            positive = str(number).lstrip("-−")
            signed = ("absolute", "change", "current")
            cures = (Patch(*span(number), positive),) if value < 0 and kind not in signed else ()
            if wave and kind == "difference" and found[0] == "E202":
                found = "E202", "an amplitude is positive"
                help = 'a wave goes both ways; to begin downwards, add "starting cool"'
            self.add(found[0], place, found[1], help, *cures)
            return float("nan")
        return value

    def metadata(self, trees: Iterable[Any]) -> Metadata:
        """Return the metadata of a header or of the set block."""
        values: dict[str, str] = {}
        first: dict[str, int] = {}
        for tree in trees:
            key, token = str(tree.children[0]), tree.children[1]
            text = self.text(token)
            if key in first:
                line, _ = self.source.place(first[key])
                self.add("E213", span(tree), f'"{key}" is already on line {line}', "keep one of them")
            elif text is not None and not text.strip(" \t\n," if key == "tags" else None):
                self.add("E117", span(token), "the text is empty", f"write something, or leave {key} out")
            elif text is not None:
                values[key] = text
            first.setdefault(key, span(tree)[0])
        tags = tuple(dict.fromkeys(tag.strip() for tag in values.pop("tags", "").split(",") if tag.strip()))
        return Metadata(**values, tags=tags)

    def text(self, token: Any) -> str | None:
        """Return a quoted text without quotes and escapes; None, with a finding, when it is not valid."""
        inner = str(token)[1:-1]
        if wrong := next((escape for escape in _ESCAPE.finditer(inner) if escape[1] not in _ESCAPES), None):
            start = span(token)[0] + 1 + wrong.start()
            help = 'in a text, \\" \\\\ and \\n stand for a quotation mark, a backslash and a new line'
            self.add("E112", (start, start + 2), f'"{wrong[0]}" means nothing', help, Patch(start, start, "\\"))
            return None
        text = _ESCAPE.sub(lambda escape: _ESCAPES[escape[1]], inner)
        if text.strip() and (found := text_fault(text)):
            self.add("E105", span(token), found, "remove it")
            return None
        return text

    def choice(self, token: Any, known: Iterable[str], code: str, noun: str) -> str | None:
        """Return a word that must be one of those known; None, and a finding, when it is not."""
        options = list(known)
        if str(token) in options:
            return str(token)
        close = nearest(str(token), options)
        cures = (Patch(*span(token), close),) if close else ()
        self.add(code, span(token), f'"{short(token)}" is not {noun}', f"one of: {', '.join(options)}", *cures)
        return None

    def at(self, place: Place) -> tuple[int, int]:
        """Return line and column of a place."""
        return self.source.place(place[0])

    def add(self, code: str, place: Place, what: str, help: str = "", *cures: Patch) -> None:
        """Add a finding."""
        self.findings.append(Finding(code, place[0], place[1], what, help, cures))


def span(item: Any) -> Place:
    """Return the offsets of a tree or token."""
    if hasattr(item, "data"):
        return item.meta.start_pos, item.meta.end_pos
    start = item.start_pos or 0
    return start, max(item.end_pos or 0, start + len(item))


def rule_of(item: Any) -> str:
    """Return the name of a tree's rule, or "" for a token."""
    return str(getattr(item, "data", ""))


@dataclass(frozen=True, slots=True)
class FamilyParameters:
    """The parameters of a family by name, where each stands, and whether one of them could not be read."""

    named: dict[str, Parameter]
    places: dict[str, Place]
    unread: bool


def parameters_of(builder: Builder, tree: Any) -> FamilyParameters:
    """Return the parameters that a tree lists."""
    named: dict[str, Parameter] = {}
    places: dict[str, Place] = {}
    unread = False
    for part in tree.children:
        token = part.children[0]
        name = str(token)
        found = _parameter(builder, part)
        if name in places:
            line, column = builder.source.place(places[name][0])
            what = f'"{short(name)}" is already on line {line}, column {column}'
            builder.add("E213", span(token), what, "each parameter needs a different name")
            unread = True
        places.setdefault(name, span(token))
        unread |= found is None
        if found is not None:
            named.setdefault(name, found)
    members = prod(len(parameter) for parameter in named.values())
    if members > MOST_MEMBERS:
        what = f"this family has {members:,} members" if members < 10**15 else "this family has more than 10^15 members"
        builder.add("E231", span(tree), what, f"a family has at most {MOST_MEMBERS:,}: {FEWER}")
        unread = True
    return FamilyParameters(named, places, unread)


def _parameter(builder: Builder, tree: Any) -> Parameter | None:
    token, values, *rest = tree.children
    name, unit = str(token), str(rest[0]) if rest else ""
    sound = True
    if any(name in units for units in UNITS.values()):
        what = f'"{name}" is a unit, and cannot be the name of a parameter'
        builder.add("E113", span(token), what, "call it after what varies, such as: amount, rate, pause")
        sound = False
    numbers = [_number(builder, number) for number in values.children]
    known = [number for number in numbers if number is not None]
    if len(known) < len(numbers) or not sound or not _punctuated(builder, values):
        return None
    if rule_of(values) == "range":
        low, high, step = known
        if wrong := span_fault(low, high, step):
            swapped = low > high and not span_fault(high, low, step)
            text = [builder.source.text[slice(*span(number))] for number in values.children]
            cures = (Patch(*span(values), f"{text[1]}..{text[0]} step {text[2]}"),) if swapped else ()
            builder.add(
                "E228", span(values), wrong, "a range runs from low to high in whole steps: 1..3 step 0.5", *cures
            )
            return None
        return Parameter(name, unit, span=(low, high, step))
    seen: set[float] = set()
    for place, number in enumerate(known):
        if number in seen:
            here = span(values.children[place])
            cure = Patch(span(values.children[place - 1])[1], here[1], "")
            what = f"{short(values.children[place])} is already in this list"
            builder.add("E213", here, what, "keep one of them", cure)
            return None
        seen.add(number)
    return Parameter(name, unit, tuple(known))


def _punctuated(builder: Builder, values: Any) -> bool:
    """Tell whether dots and commas between the values can be meant as they stand."""
    ends = [span(number) for number in values.children]
    if rule_of(values) == "range":
        if builder.source.text[ends[1][0]] != ".":
            return True
        builder.add("E118", (ends[0][1], ends[1][0] + 1), THREE_DOTS, "for example: 0.1..0.5 step 0.1")
        return False
    gaps = [builder.source.text[end:start] for (_, end), (start, _) in pairwise(ends)]
    if not any(gap == "," for gap in gaps) or all(gap == "," for gap in gaps):
        return True
    place = next(place for place, gap in enumerate(gaps) if gap == ",")
    low, high = (str(number) for number in values.children[place : place + 2])
    what = f'is "{low},{high}" one value or two?'
    help = f"the decimal mark is a point: {low}.{high}; two values have a space after the comma: {low}, {high}"
    builder.add("E118", (ends[place][0], ends[place + 1][1]), what, help)
    return False


def _number(builder: Builder, token: Any) -> float | None:
    try:
        return float(exact_number(str(token)))
    except ValueError as error:
        builder.add("E218", span(token), str(error), _LIST_HELP)
        return None
