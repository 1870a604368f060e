"""The numbers that stand in an icon's statements: where they are, and the icon with one of them changed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from thermicon.icons import Icon
    from thermicon.icons.model.statements import Statement

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

    def ratio_to(self, value: float) -> float:
        """|log| of the ratio of a new value to the old one."""
        return abs(math.log((value - self.above) / (self.value - self.above)))


def numbers_of(icon: Icon, baseline_C: float) -> tuple[Number, ...]:
    """Every number that can be made larger or smaller, in the order of the text; totals only check and are left out.

    >>> from thermicon.icons import Icon
    >>> from thermicon.icons.model.statements import Ramp, Hold, Return
    >>> dip = Icon("dip", (Ramp("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3)))
    >>> [(number.field, number.value) for number in numbers_of(dip, 32.0)]
    [('by_K', 6.0), ('rate_K_per_s', 3.0), ('duration_s', 4.0), ('rate_per_s', 3.0)]
    """
    return tuple(_numbers(icon.statements, (), baseline_C))


def statement_at(icon: Icon, path: Sequence[int]) -> Statement:
    """The statement at a path through repeats."""
    body: Sequence[Any] = icon.statements
    for place in path[:-1]:
        body = body[place].body
    return cast("Statement", body[path[-1]])


def with_number(icon: Icon, number: Number, value: float) -> Icon:
    """The icon with one number changed; raises what an icon raises that cannot be run so."""
    new = int(value) if number.field == "count" else value
    return replace(icon, statements=_changed(icon.statements, number.path, {number.field: new}))


def repeated(icon: Icon, count: int) -> Icon:
    """The icon with all that moves it in one `repeat`; checks of the total stay outside."""
    from thermicon.icons.model.statements import Repeat, Total

    body = tuple(part for part in icon.statements if not isinstance(part, Total))
    checks = tuple(part for part in icon.statements if isinstance(part, Total))
    return replace(icon, statements=(Repeat(count, body), *checks))


def line_of(icon: Icon, path: Sequence[int]) -> str:
    """The line of text at a path: of a repeat its first line.

    >>> from thermicon.icons import Icon
    >>> from thermicon.icons.model.statements import Ramp, Hold, Return
    >>> line_of(Icon("dip", (Ramp("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3))), (1,))
    'hold for 4 s'
    """
    from thermicon.icons.model.format import statement_text

    return statement_text(statement_at(icon, path), icon.context.control).split("\n")[0].strip()


def _numbers(body: Sequence[Any], before: tuple[int, ...], baseline_C: float) -> Iterator[Number]:
    from thermicon.icons.model.statements import Repeat, Total

    for place, part in enumerate(body):
        path = (*before, place)
        for field in FIELDS:
            value = getattr(part, field, None)
            above = baseline_C if field == "to_C" else 0.0
            if value is not None and value != above and not isinstance(part, Total):
                yield Number(path, field, float(value), above)
        if isinstance(part, Repeat):
            yield from _numbers(part.body, path, baseline_C)


def _changed(body: Sequence[Any], path: Sequence[int], values: dict[str, float]) -> tuple[Any, ...]:
    place, rest = path[0], path[1:]
    part = body[place]
    new = replace(part, body=_changed(part.body, rest, values)) if rest else replace(part, **values)
    return (*body[:place], new, *body[place + 1 :])
