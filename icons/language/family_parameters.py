"""The parameters of a family from the tree: numbers, ranges and units, with errors at their places."""

from dataclasses import dataclass
from itertools import pairwise
from math import prod
from typing import Any

from ..model.family import FEWER, MOST_MEMBERS
from ..model.parameter import Parameter, span_fault
from ..model.units import UNITS, exact_number
from .build import Builder, Place, rule_of, span
from .diagnose_family import THREE_DOTS
from .failed_statement import short
from .source import Edit

_LIST_HELP = 'values are a list, "[1, 3] °C", or a range, "1..3 step 0.5 °C"'


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
            cures = (Edit(*span(values), f"{text[1]}..{text[0]} step {text[2]}"),) if swapped else ()
            builder.add(
                "E228", span(values), wrong, "a range runs from low to high in whole steps: 1..3 step 0.5", *cures
            )
            return None
        return Parameter(name, unit, span=(low, high, step))
    seen: set[float] = set()
    for place, number in enumerate(known):
        if number in seen:
            here = span(values.children[place])
            cure = Edit(span(values.children[place - 1])[1], here[1], "")
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
