"""Tables that read well at 80 columns, on a terminal and in a pipe."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import typer

if TYPE_CHECKING:
    from rich.console import JustifyMethod
    from rich.table import Table


def show(*parts: object) -> None:
    """Print tables and lines on stdout; colours only on a terminal, never markup taken from people's text."""
    from rich.console import Console

    plain = Console(markup=False, highlight=False, emoji=False)
    for part in parts:
        console = plain
        if not isinstance(part, str) and not plain.is_terminal:
            # A pipe has no width: names stay whole there, as a script expects.
            wanted = cast("Table", part)
            least = Console(width=1000).measure(wanted).minimum + 2 * len(wanted.columns)  # rich forgets the gaps
            console = Console(markup=False, highlight=False, emoji=False, width=max(plain.width, least))
        with console.capture() as captured:
            console.print(hanging(part, plain.width) if isinstance(part, str) else part)
        for line in captured.get().splitlines():
            typer.echo(line.rstrip())


def hanging(text: str, width: int) -> str:
    """Wrap a line so that what follows stands under its text, behind its indent and bullet.

    >>> print(hanging("  - one two three four", 14))
      - one two
        three four
    """
    bare = text.lstrip()
    indent = " " * (len(text) - len(bare) + (2 if bare.startswith("- ") else 0))
    return textwrap.fill(text, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


def table(*columns: str, numbers: Sequence[str] = (), names: Sequence[str] = ()) -> Table:
    """Make an empty table with these columns; those in ``numbers`` are set flush right, ``names`` are never broken."""
    from rich import box
    from rich.table import Table

    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for column in columns:
        justify: JustifyMethod = "right" if column in numbers else "left"
        made.add_column(column, justify=justify, overflow="fold", no_wrap=column in names)
    return made
