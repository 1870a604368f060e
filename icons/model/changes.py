"""The numbers of an icon, and the icon with one of them changed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from .format import statement_text
from .icon import Icon
from .statements import Repeat, Total

FIELDS = (
    *("by_K", "to_C", "by_A", "to_A"),
    *("rate_K_per_s", "rate_A_per_s", "rate_per_s"),
    *("period_s", "duration_s", "count"),
)


@dataclass(frozen=True, slots=True)
class Number:
    """One number of an icon: the way to its statement through repeats, its field, and its value in SI.

    `above` is where its ratio counts from: the baseline for a temperature, 0 for all others.
    """

    path: tuple[int, ...]
    field: str
    value: float
    above: float = 0.0

    def times(self, factor: float) -> float:
        """The value a factor larger, counted from `above`; a count stays whole."""
        scaled = self.above + factor * (self.value - self.above)
        return float(round(scaled)) if self.field == "count" else scaled


def numbers_of(icon: Icon, baseline_C: float) -> tuple[Number, ...]:
    """Every number that can be made larger or smaller, in the order of the text; totals only check and are left out."""
    return tuple(_numbers(icon.statements, (), baseline_C))


def with_number(icon: Icon, number: Number, value: float) -> Icon:
    """The icon with one number changed; raises what an icon raises that cannot be run so."""
    new = int(value) if number.field == "count" else value
    return replace(icon, statements=with_values(icon.statements, number.path, {number.field: new}))


def repeated(icon: Icon, count: int) -> Icon:
    """The icon with all that moves it in one `repeat`; checks of the total stay outside."""
    body = tuple(part for part in icon.statements if not isinstance(part, Total))
    checks = tuple(part for part in icon.statements if isinstance(part, Total))
    return replace(icon, statements=(Repeat(count, body), *checks))


def line_of(icon: Icon, path: Sequence[int]) -> str:
    """The line of text at a path: of a repeat its first line."""
    body: Sequence[Any] = icon.statements
    for place in path[:-1]:
        body = body[place].body
    return statement_text(body[path[-1]], icon.context.control).split("\n")[0].strip()


def _numbers(body: Sequence[Any], before: tuple[int, ...], baseline_C: float) -> Iterator[Number]:
    for place, part in enumerate(body):
        path = (*before, place)
        for field in FIELDS:
            value = getattr(part, field, None)
            above = baseline_C if field == "to_C" else 0.0
            if value is not None and value != above and not isinstance(part, Total):
                yield Number(path, field, float(value), above)
        if isinstance(part, Repeat):
            yield from _numbers(part.body, path, baseline_C)


def with_values(body: Sequence[Any], path: Sequence[int], values: Mapping[str, Any]) -> tuple[Any, ...]:
    """A body in which fields of the statement at a path have other values."""
    place, rest = path[0], path[1:]
    part = body[place]
    new = replace(part, body=with_values(part.body, rest, values)) if rest else replace(part, **values)
    return (*body[:place], new, *body[place + 1 :])
