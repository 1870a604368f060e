"""The shipped sets side by side: a table in a terminal and in a notebook, a mapping for programs."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..files.shipped import library_names, load_library
from ..model.iconset import IconSet
from ..model.words import nearest
from .draw import icon_count

if TYPE_CHECKING:
    import pandas as pd

_WIDTH = 100


class UnknownSet(KeyError):
    """The library has no set of this name; the message lists those that it has, nearest first."""

    def __str__(self) -> str:
        return str(self.args[0])


@dataclass(frozen=True, slots=True)
class Shipped:
    """What the library says of a set: what it is called and for, where it comes from, how many icons it has.

    Members of families count, and are not made.
    """

    name: str
    title: str
    intent: str
    source: str
    count: int


@dataclass(frozen=True, slots=True, repr=False)
class Library(Mapping[str, IconSet]):
    """Shipped sets by name; ``entries`` says of each what it is, and so does its table in a notebook."""

    sets: tuple[tuple[str, IconSet], ...]

    @property
    def entries(self) -> tuple[Shipped, ...]:
        """Name, title, intent, source and number of icons of every set."""
        return tuple(_shipped(name, icons) for name, icons in self.sets)

    def to_frame(self) -> pd.DataFrame:
        """Return a table with a row a set and the columns name, icons, title, intent, source."""
        import pandas as pd

        rows = [(one.name, one.count, one.title, one.intent, one.source) for one in self.entries]
        return pd.DataFrame(rows, columns=["name", "icons", "title", "intent", "source"])

    def __getitem__(self, name: str) -> IconSet:
        found = dict(self.sets).get(name)
        if found is None:
            close = nearest(str(name), self)
            hint = f"did you mean {close}? " if close else ""
            raise UnknownSet(f"no shipped set is called {name!r}; {hint}there are: {', '.join(self)}")
        return found

    def __iter__(self) -> Iterator[str]:
        return (name for name, _ in self.sets)

    def __len__(self) -> int:
        return len(self.sets)

    def __repr__(self) -> str:
        wide = max(len(name) for name in self) + 2
        counts = [icon_count(one.count) for one in self.entries]
        narrow = max(map(len, counts)) + 2
        rows = []
        for one, count in zip(self.entries, counts, strict=True):
            rows.append(f"{one.name:<{wide}}{count:<{narrow}}{one.title}")
            for label, text in (("for", one.intent), ("from", one.source)):
                if text:
                    short = textwrap.shorten(text, _WIDTH - wide - narrow - 6, placeholder=" …")
                    rows.append(f"{'':<{wide + narrow}}{label}: {short}")
        return "\n".join(rows)

    def _repr_html_(self) -> str:
        return str(self.to_frame().to_html(index=False))


def library() -> Library:
    """Return all shipped sets; in a notebook they appear as a table.

    Returns
    -------
    Library
        Sets by name; ``entries`` lists name, title and number of icons of each.

    Examples
    --------
    >>> sets = library()
    >>> sets["six-icons"]["cooling-step"].metadata.means
    'a quick, strong cooling'
    >>> [entry.count for entry in sets.entries if entry.name == "six-icons"]
    [6]
    """
    return Library(tuple((name, load_library(name)) for name in library_names()))


def _shipped(name: str, icons: IconSet) -> Shipped:
    means = (icons.metadata.means, *(entry.metadata.means for entry in icons.entries))
    intent = icons.metadata.means or "; ".join(dict.fromkeys(filter(None, means)))
    known = (icons.metadata.by, icons.metadata.doi)
    source = "; ".join(text for text in known if text) or "not stated"
    return Shipped(name, icons.title, intent, source, len(icons))
