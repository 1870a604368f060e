"""Blocks as text for a terminal of 80 columns or for a pipe."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import typer

from .blocks import Block, Bullets, Code, Facts, Grid, Heading, Picture, Text

if TYPE_CHECKING:
    from rich.console import JustifyMethod
    from rich.table import Table

WIDEST = 1000
VALUE = re.compile(r"(?<=\d) (?=(?:%|°C|°C/s|K|K/s|m?s|mm|cm²|A|J|bits|bits/s)(?![\w/]))")
"""The space between a number and its unit."""
KEPT = "\u00a0"
COMMAND = ("thermicon ", "Next: thermicon ")
"""How lines begin that stay whole, so that they can be copied."""


def show(blocks: Sequence[Block | str]) -> None:
    """Print blocks on stdout; a text alone is a paragraph. Never markup taken from people's text."""
    from rich.console import Console

    terminal = Console()
    told: list[Block] = [Text(block) if isinstance(block, str) else block for block in blocks]
    for line in lines(told, terminal.width, terminal.is_terminal):
        typer.echo(line)


def lines(blocks: Sequence[Block], width: int, is_terminal: bool = True) -> list[str]:
    """Return the lines of blocks at this width, with an empty one between two that do not belong together."""
    shown = [block for block in blocks if not isinstance(block, Picture) and block not in (Bullets(()), Text(""))]
    said = list(_block(shown[0], width, is_terminal)) if shown else []
    for before, block in pairwise(shown):
        joined = (isinstance(block, Bullets) and isinstance(before, Text | Heading)) or (
            isinstance(block, Text) and isinstance(before, Facts)
        )
        said += [*([] if joined else [""]), *_block(block, width, is_terminal)]
    return said


def _block(block: Block, width: int, is_terminal: bool) -> Iterator[str]:
    if isinstance(block, Grid):
        yield from rendered(_table(block), width, is_terminal)
    elif isinstance(block, Facts):
        wide = max(len(name) for name, _ in block.rows) + 2
        for name, value in block.rows:
            yield from hanging(f"{name.ljust(wide)}{value}", width, wide).splitlines()
    elif isinstance(block, Bullets):
        for point in block.points:
            yield from hanging(f"  - {point}", width, 4).splitlines()
    elif isinstance(block, Code):
        yield from block.text.splitlines()
    elif isinstance(block, (Heading, Text)):
        for line in block.text.split("\n"):
            yield from hanging(line, width).splitlines() or [""]


def hanging(text: str, width: int, indent: int | None = None) -> str:
    """Wrap a line so that what follows stands behind its indent; units stay with numbers, a command on one line.

    >>> print(hanging("  - one two three 4 K", 19, 4))
      - one two three
        4 K
    >>> hanging("  thermicon rank six-icons --observer lab.csv", 20)
    '  thermicon rank six-icons --observer lab.csv'
    """
    bare = text.lstrip()
    if bare.startswith(COMMAND):
        return text
    behind = " " * (len(text) - len(bare) if indent is None else indent)
    filled = textwrap.fill(
        VALUE.sub(KEPT, text), width, subsequent_indent=behind, break_long_words=False, break_on_hyphens=False
    )
    return filled.replace(KEPT, " ")


def rendered(made: Table, width: int, is_terminal: bool = True) -> list[str]:
    """Return the lines of a table at this width.

    Names and headings stay whole: in a pipe, which has no width, the table gets as wide as they need; on a narrow
    terminal they are wrapped, and no letter is lost.
    """
    from rich.console import Console

    least = Console(width=WIDEST).measure(made).minimum + 2 * len(made.columns)  # rich leaves out the gaps
    if not is_terminal:
        width = max(width, least)
    elif least > width:
        made.collapse_padding = True
        for column in made.columns:
            column.no_wrap = False
    console = Console(markup=False, highlight=False, emoji=False, width=width, force_terminal=is_terminal or None)
    with console.capture() as captured:
        console.print(made)
    return [line.rstrip() for line in captured.get().splitlines()]


def _table(block: Grid) -> Table:
    from rich import box
    from rich.table import Table

    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, show_header=any(block.columns))
    for column in block.columns:
        justify: JustifyMethod = "right" if column in block.numbers else "left"
        made.add_column(column, justify=justify, overflow="fold", no_wrap=column in block.names)
    for place, row in enumerate(block.rows):
        if place and place == block.apart:
            made.add_section()
        made.add_row(*(cell.text for cell in row))
    return made
