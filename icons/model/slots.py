"""Where the parameters of a family stand in its statements, and whether they can stand there."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from .parameter import Parameter
from .statements import Repeat, Statement
from .units import KIND_WORDS, UNITS, Kind
from .value_limits import Control, fault

Path = tuple[int, ...]
# What the fields of statements that may vary are; by_K and rate_per_s are another kind in some statements.
_KINDS: dict[str, Kind] = {
    **{"by_K": "difference", "to_C": "absolute", "by_A": "current", "to_A": "current"},
    **{"rate_K_per_s": "rate", "rate_A_per_s": "current_rate", "rate_per_s": "rate"},
    **{"duration_s": "time", "period_s": "time", "count": "count"},
}


@dataclass(frozen=True, slots=True)
class Slot:
    """Where a parameter stands: the path of the statement (places, through repeats), its field, the name."""

    path: Path
    field: str
    kind: Kind
    parameter: str


def in_order(slots: Iterable[Slot]) -> tuple[Slot, ...]:
    """Return slots in the order of the statements that they stand in."""
    return tuple(sorted(slots, key=lambda slot: (slot.path, slot.field)))


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
