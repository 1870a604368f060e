"""Tables that read well at 80 columns, on a terminal and in a pipe."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from rich.console import JustifyMethod
    from rich.table import Table


WIDEST = 1000
VALUE = re.compile(r"(?<=\d) (?=(?:%|°C|°C/s|K|K/s|m?s|mm|cm²|A|J|bits|bits/s)(?![\w/]))")
"""The space between a number and its unit."""
KEPT = "\u00a0"


def show(*parts: Table | str) -> None:
    """Print tables and lines on stdout; colours only on a terminal, never markup taken from people's text."""
    from rich.console import Console

    terminal = Console()
    for part in parts:
        for line in rendered(part, terminal.width, terminal.is_terminal):
            typer.echo(line)


def rendered(part: Table | str, width: int, is_terminal: bool = True) -> list[str]:
    """Return the lines of a table or a text at this width.

    Names and headings stay whole: in a pipe, which has no width, the table gets as wide as they need; on a narrow
    terminal they are wrapped, and no letter is lost. A command stays on one line, so that it can be copied.

    >>> rendered("  thermicon rank six-icons --observer a-laboratory.csv", 20)
    ['  thermicon rank six-icons --observer a-laboratory.csv']
    """
    from rich.console import Console

    if isinstance(part, str) and part.lstrip().startswith("thermicon "):
        return [part]
    if not isinstance(part, str):
        least = Console(width=WIDEST).measure(part).minimum + 2 * len(part.columns)  # rich leaves out the gaps
        if not is_terminal:
            width = max(width, least)
        elif least > width:
            part.collapse_padding = True
            for column in part.columns:
                column.no_wrap = False
    console = Console(markup=False, highlight=False, emoji=False, width=width, force_terminal=is_terminal or None)
    with console.capture() as captured:
        console.print(hanging(part, width) if isinstance(part, str) else part)
    return [line.rstrip() for line in captured.get().splitlines()]


def hanging(text: str, width: int) -> str:
    """Wrap a line so that what follows stands under its text, behind its indent and bullet; units stay with numbers.

    >>> print(hanging("  - one two three 4 K", 19))
      - one two three
        4 K
    """
    bare = text.lstrip()
    indent = " " * (len(text) - len(bare) + (2 if bare.startswith("- ") else 0))
    filled = textwrap.fill(
        VALUE.sub(KEPT, text), width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )
    return filled.replace(KEPT, " ")


def table(*columns: str, numbers: Sequence[str] = (), names: Sequence[str] = ()) -> Table:
    """Make an empty table with these columns; ``numbers`` are flush right, ``names`` wrap only on a narrow terminal."""
    from rich import box
    from rich.table import Table

    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for column in columns:
        justify: JustifyMethod = "right" if column in numbers else "left"
        made.add_column(column, justify=justify, overflow="fold", no_wrap=column in names)
    return made
