"""Pages of text, tables and figures, written once and rendered as Markdown and as one self-contained HTML file."""

from __future__ import annotations

import base64
import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1b1f24; background: #fff; margin: 2rem auto; max-width: 76rem;
  padding: 0 1.5rem; }
h1 { font-size: 1.7rem; }
h2 { font-size: 1.3rem; margin-top: 2.6rem; border-top: 1px solid #d8dce1; padding-top: 1rem; }
p, li { max-width: 52rem; }
table { border-collapse: collapse; font-size: 0.86rem; margin: 1rem 0; }
th, td { text-align: left; vertical-align: top; padding: 0.3rem 0.7rem 0.3rem 0; border-bottom: 1px solid #e4e7eb; }
th { border-bottom: 2px solid #9aa1a9; font-weight: 600; }
td.holds::before { content: "✓ "; color: #1a6b2f; } td.misses::before { content: "✗ "; color: #a32a1c; }
td.misses { background: #fbf1ee; } td.shown { color: #555c64; }
figure { margin: 1.2rem 0; } figure img { max-width: 100%; height: auto; }
figcaption { font-size: 0.86rem; color: #444b53; max-width: 52rem; }
"""


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading of level 1 or 2."""

    text: str
    level: int = 2


@dataclass(frozen=True, slots=True)
class Text:
    """A paragraph."""

    text: str


@dataclass(frozen=True, slots=True)
class Bullets:
    """A list of points."""

    points: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell of a table; `kind` (holds, misses, shown or nothing) is told by a mark."""

    text: str
    kind: str = ""


@dataclass(frozen=True, slots=True)
class Grid:
    """A table; every row has as many cells as there are columns."""

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure by the name of its file, without folder and ending, and its caption."""

    name: str
    caption: str


Block = Heading | Text | Bullets | Grid | Picture
MARK = {"holds": "✓ ", "misses": "✗ "}


def as_markdown(blocks: Sequence[Block], folder: str = "figures") -> str:
    """The page as Markdown, with figures as PNG files of a folder beside it.

    >>> print(as_markdown([Heading("A page", 1), Text("5 < 6 * 2")]), end="")
    # A page
    <BLANKLINE>
    5 < 6 \\* 2
    """
    return "\n\n".join(_markdown(block, folder) for block in blocks) + "\n"


def as_html(blocks: Sequence[Block], title: str, pictures: Mapping[str, bytes]) -> str:
    """The page as one HTML file; `pictures` are PNG files by name.

    >>> "5 &lt; 6" in as_html([Text("5 < 6")], "A page", {})
    True
    """
    body = "\n".join(_html(block, pictures) for block in blocks)
    head = (
        f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{html.escape(title)}</title>'
    )
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}<style>{STYLE}</style></head><body>\n{body}\n</body></html>\n'


def _markdown(block: Block, folder: str) -> str:
    if isinstance(block, Heading):
        return f"{'#' * block.level} {_plain(block.text)}"
    if isinstance(block, Text):
        return _plain(block.text)
    if isinstance(block, Bullets):
        return "\n".join(f"- {_plain(point)}" for point in block.points)
    if isinstance(block, Picture):
        return f"![{_plain(block.caption)}]({folder}/{block.name}.png)\n\n*{_plain(block.caption)}*"
    rows = [[_plain(column) for column in block.columns], ["---"] * len(block.columns)]
    rows += [[MARK.get(cell.kind, "") + _plain(cell.text) for cell in row] for row in block.rows]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _plain(text: str) -> str:
    for letter in "\\*_|`":
        text = text.replace(letter, f"\\{letter}")
    return text


def _html(block: Block, pictures: Mapping[str, bytes]) -> str:
    if isinstance(block, Heading):
        return f"<h{block.level}>{html.escape(block.text)}</h{block.level}>"
    if isinstance(block, Text):
        return f"<p>{html.escape(block.text)}</p>"
    if isinstance(block, Bullets):
        return "<ul>" + "".join(f"<li>{html.escape(point)}</li>" for point in block.points) + "</ul>"
    if isinstance(block, Picture):
        held = base64.b64encode(pictures[block.name]).decode("ascii")
        said = html.escape(block.caption)
        image = f'<img alt="{said}" src="data:image/png;base64,{held}">'
        return f"<figure>{image}<figcaption>{said}</figcaption></figure>"
    head = "".join(f"<th>{html.escape(column)}</th>" for column in block.columns)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>\n" for row in block.rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>\n{body}</tbody></table>"


def _cell(cell: Cell) -> str:
    kind = f' class="{cell.kind}"' if cell.kind else ""
    return f"<td{kind}>{html.escape(cell.text)}</td>"
