"""Tables that read well at 80 columns, on a terminal and in a pipe."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from rich.table import Table


WIDEST = 160


def show(*parts: object) -> None:
    """Print tables and lines on stdout; colours only on a terminal, never markup taken from people's text."""
    from rich.console import Console

    console = Console(markup=False, highlight=False, emoji=False)
    # A pipe has no width: long names stay on one line there, as a script expects.
    wide = console if console.is_terminal else Console(markup=False, highlight=False, emoji=False, width=WIDEST)
    for part in parts:
        one = console if isinstance(part, str) else wide
        with one.capture() as captured:
            one.print(hanging(part, console.width) if isinstance(part, str) else part)
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


def table(*columns: str, numbers: Sequence[str] = ()) -> Table:
    """Make an empty table with these columns; those in ``numbers`` are set flush right."""
    from rich import box
    from rich.table import Table

    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for column in columns:
        made.add_column(column, justify="right" if column in numbers else "left", overflow="fold")
    return made
