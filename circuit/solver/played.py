"""A run on several elements with a trace for each on one clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from .trace import Trace, write_trace

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True, eq=False)
class LayoutTrace:
    """The run of an icon on the elements of a layout.

    Attributes
    ----------
    icon
        Name of the icon.
    played
        Each element of the layout with its trace, in the order of the layout. All have the same times; one that does
        not play rests.

    Examples
    --------
    >>> from thermicon.circuit import simulate
    >>> from thermicon.icons import parse
    >>> (icon,) = parse("cue 1; set { elements left, right }; icon a { on left { pulse by 3 K for 1 s } }").spatial
    >>> simulate(icon, "wheel")
    LayoutTrace('a' on left, right: 101 rows, 1 s, reached)
    """

    icon: str
    played: tuple[tuple[str, Trace], ...]

    def __repr__(self) -> str:
        names, (_, first) = ", ".join(name for name, _ in self.played), self.played[0]
        word = "reached" if self.reachable else "NOT reached"
        return f"LayoutTrace({self.icon!r} on {names}: {len(first.time_s)} rows, {first.time_s[-1]:.6g} s, {word})"

    @property
    def traces(self) -> Mapping[str, Trace]:
        """The trace of each element by its name."""
        return MappingProxyType(dict(self.played))

    @property
    def named(self) -> tuple[Trace, ...]:
        """The traces as those of icons that are called, for example, ``turn on left``."""
        return tuple(replace(trace, icon=f"{self.icon} on {name}") for name, trace in self.played)

    @property
    def reachable(self) -> bool:
        """Whether every element reaches its target."""
        return all(trace.reachable for _, trace in self.played)

    def to_frame(self) -> pd.DataFrame:
        """Return all traces as one table, element by element; the column icon tells them from each other."""
        import pandas as pd

        return pd.concat([trace.to_frame() for trace in self.named], ignore_index=True)

    def to_csv(self, path: str | Path) -> None:
        """Write the table of `to_frame` as a CSV file, or as Parquet where the name ends in ``.parquet``."""
        write_trace(list(self.named), path)
