"""Blocks: the parts of which every report consists.

In HTML nothing is fetched from anywhere, there are no scripts and no dates, and equal blocks give equal bytes.
"""

from __future__ import annotations

import base64
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from jinja2 import Environment


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading of level 1 to 3."""

    type: ClassVar[str] = "heading"
    text: str
    level: int = 2


@dataclass(frozen=True, slots=True)
class Text:
    """A paragraph, or one line below another; ``kind`` is ``lead``, ``note``, ``warn`` or empty."""

    type: ClassVar[str] = "text"
    text: str
    kind: str = ""


@dataclass(frozen=True, slots=True)
class Code:
    """Text in a fixed-width font, with its line breaks."""

    type: ClassVar[str] = "code"
    text: str


@dataclass(frozen=True, slots=True)
class Bullets:
    """A list of points; an empty one leaves no trace."""

    type: ClassVar[str] = "bullets"
    points: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell of a table; ``kind`` is ``strong`` or empty."""

    text: str
    kind: str = ""


@dataclass(frozen=True, slots=True)
class Grid:
    """A table; every row has one cell per column, and the columns in ``numbers`` are flush right.

    Columns in ``names`` wrap only on a narrow terminal. A line parts the rows from number ``apart`` on, where it is not
    0; without headings, nothing stands above the first row.
    """

    type: ClassVar[str] = "grid"
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    numbers: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    apart: int = 0


@dataclass(frozen=True, slots=True)
class Facts:
    """Pairs of a name and its value, one per line; as ``cards``, pages show large numbers with their meanings below."""

    type: ClassVar[str] = "facts"
    rows: tuple[tuple[str, str], ...]
    cards: bool = False


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure as PNG ``data``, with ``alt``, the text for screen readers, and its ``width`` in CSS pixels."""

    type: ClassVar[str] = "picture"
    caption: str
    alt: str
    width: int
    data: bytes


Block = Heading | Text | Code | Bullets | Grid | Facts | Picture


def grid(
    columns: Sequence[str],
    rows: Iterable[Sequence[str | Cell]],
    numbers: Sequence[str] = (),
    names: Sequence[str] = (),
    apart: int = 0,
) -> Grid:
    """Make a table from texts and cells."""
    cells = tuple(tuple(cell if isinstance(cell, Cell) else Cell(cell) for cell in row) for row in rows)
    return Grid(tuple(columns), cells, tuple(numbers), tuple(names), apart)


def visible(text: str) -> str:
    """Remove invisible characters from a text, such as those that reverse the direction of what follows.

    >>> visible("a\u202eb")
    'ab'
    """
    return "".join(char for char in text if char == "\n" or unicodedata.category(char) not in ("Cf", "Cc"))


@cache
def environment() -> Environment:
    """The Jinja2 environment of all templates: every value is escaped and stripped of invisible characters."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    def printed(value: Any) -> Any:
        return visible(value) if isinstance(value, str) and not isinstance(value, Markup) else value

    folder = resources.files("thermicon.notebooks") / "templates"
    return Environment(
        loader=FileSystemLoader(str(folder)),
        autoescape=True,
        finalize=printed,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def as_html(blocks: Sequence[Block], title: str) -> str:
    """Render the page as one HTML file."""

    def address(picture: Picture) -> str:
        return f"data:image/png;base64,{base64.b64encode(picture.data).decode('ascii')}"

    return environment().get_template("page.html.j2").render(title=title, blocks=blocks, address=address) + "\n"


def shown(*blocks: Block) -> str:
    """Render single blocks for the workbench, in its style; the `kind` of a text is one of its classes `th-…`."""
    return fragment("shown", blocks)


def fragment(name: str, *values: object) -> str:
    """Render a macro of the workbench's template: a small piece of HTML, with every value escaped.

    >>> fragment("block", "5 < 6", "th-note")
    '<div class="th-note">5 &lt; 6</div>'
    """
    macro = getattr(environment().get_template("workbench.html.j2").module, name)
    return str(macro(*values)).strip()


def printed_unit(unit: str) -> str:
    """The unit of a record as it is printed; nothing for a pure number.

    >>> printed_unit("degC"), printed_unit("ln per d'"), printed_unit("1")
    ('°C', 'ln per d′', '')
    """
    return "" if unit == "1" else unit.replace("degC", "°C").replace("d'", "d′")
