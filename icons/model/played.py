"""The icons that statements play."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from .statements import Play, Repeat

if TYPE_CHECKING:
    from .icon import Icon
    from .statements import Statement


def played_icons(body: tuple[Statement, ...]) -> Iterator[Icon]:
    """Yield the icons that statements play, in order, those within repeats included."""
    for part in body:
        if isinstance(part, Play):
            yield part.icon
        elif isinstance(part, Repeat):
            yield from played_icons(part.body)  # type: ignore[arg-type]


def all_played(body: tuple[Statement, ...], seen: set[int] | None = None) -> Iterator[Icon]:
    """Yield the icons that statements play, and those that these play in turn, each object once."""
    seen = set() if seen is None else seen
    for icon in played_icons(body):
        if id(icon) not in seen:
            seen.add(id(icon))
            yield icon
            yield from all_played(icon.statements, seen)
