"""Parts of an HTML page that stands alone: escaped text, tables that scroll on a phone, pictures inside the page.

Nothing is fetched from anywhere, there are no scripts and no dates, and equal parts give equal bytes.
"""

from __future__ import annotations

import base64
import html
import io
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLE = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; color: #1b1f24; background: #fff;
  margin: 0 auto; max-width: 62rem; padding: 1.5rem 1.1rem 4rem; overflow-wrap: break-word; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0.2rem 0; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 0.6rem; border-top: 1px solid #d8dce1; padding-top: 1rem; }
h3 { font-size: 1.02rem; margin: 1.6rem 0 0.4rem; }
p, li { max-width: 46rem; }
.lead { color: #444b53; margin-top: 0; }
.warn, .note { border-left: 4px solid #9aa1a9; background: #f5f6f8; padding: 0.5rem 0.9rem; margin: 0.8rem 0;
  max-width: 46rem; }
.warn { border-color: #b2182b; background: #fbf3f2; }
.cards { display: flex; flex-wrap: wrap; gap: 0.8rem; margin: 1.2rem 0; }
.card { flex: 1 1 11rem; border: 1px solid #d8dce1; border-radius: 6px; padding: 0.6rem 0.9rem; }
.card b { display: block; font-size: 1.5rem; line-height: 1.3; }
.card span { color: #444b53; font-size: 0.86rem; display: block; }
.scroll { overflow-x: auto; margin: 0.8rem 0; }
table { border-collapse: collapse; font-size: 0.88rem; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: 0.25rem 0.9rem 0.25rem 0; border-bottom: 1px solid #e4e7eb; }
th { border-bottom: 2px solid #9aa1a9; font-weight: 600; vertical-align: bottom; }
td.n, th.n { text-align: right; white-space: nowrap; }
td.strong { font-weight: 700; }
.facts th { border-bottom: 1px solid #e4e7eb; font-weight: 400; color: #444b53; vertical-align: top; }
.facts td { overflow-wrap: anywhere; }
figure { margin: 1.2rem 0; break-inside: avoid; }
figure img { max-width: 100%; height: auto; display: block; }
figcaption { font-size: 0.86rem; color: #444b53; max-width: 46rem; margin-top: 0.3rem; }
.pair { display: flex; flex-wrap: wrap; gap: 0.4rem 1.6rem; align-items: flex-start; }
.pair > * { flex: 1 1 20rem; min-width: 0; }
pre { font: 0.84rem/1.45 ui-monospace, "DejaVu Sans Mono", Consolas, monospace; background: #f5f6f8; margin: 0.5rem 0;
  padding: 0.6rem 0.8rem; white-space: pre-wrap; }
code { font: 0.9em ui-monospace, "DejaVu Sans Mono", Consolas, monospace; overflow-wrap: anywhere; }
@media print { body { max-width: none; padding: 0; font-size: 10.5pt; } .scroll { overflow: visible; }
  h2, h3 { break-after: avoid; } tr, pre, .card, .warn, .note { break-inside: avoid; } }
"""
SALT = "thermicon"


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell of a table; `strong` ones are set bold."""

    text: str
    strong: bool = False


def page(title: str, parts: Sequence[str]) -> str:
    """The whole file, of parts that are HTML already.

    >>> "<title>a &lt; b</title>" in page("a < b", [])
    True
    """
    head = (
        '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{html.escape(seen(title))}</title>"
    )
    body = "\n".join(parts)
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}<style>{STYLE}</style></head><body>\n{body}\n</body></html>\n'


def element(tag: str, text: str, kind: str = "") -> str:
    """An element of escaped text.

    >>> element("p", "5 < 6", "note")
    '<p class="note">5 &lt; 6</p>'
    """
    named = f' class="{kind}"' if kind else ""
    return f"<{tag}{named}>{html.escape(seen(text))}</{tag}>"


def seen(text: str) -> str:
    """A text without the characters that nobody sees, such as those that turn the direction of what follows.

    >>> seen("a\u202eb")
    'ab'
    """
    return "".join(char for char in text if char == "\n" or unicodedata.category(char) not in ("Cf", "Cc"))


def bullets(points: Sequence[str]) -> str:
    """A list; nothing for no points."""
    return "<ul>" + "".join(element("li", point) for point in points) + "</ul>" if points else ""


def grid(columns: Sequence[str], rows: Sequence[Sequence[str | Cell]], numbers: Sequence[str] = ()) -> str:
    """A table with those columns flush right that are in `numbers`; it scrolls sideways where it is too wide."""
    kinds = ["n" if column in numbers else "" for column in columns]
    head = "".join(element("th", column, kind) for column, kind in zip(columns, kinds, strict=True))
    body = []
    for row in rows:
        cells = []
        for kind, held in zip(kinds, row, strict=True):
            cell = held if isinstance(held, Cell) else Cell(held)
            cells.append(element("td", cell.text, " ".join(filter(None, [kind, "strong" if cell.strong else ""]))))
        body.append(f"<tr>{''.join(cells)}</tr>")
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{"".join(body)}</tbody></table></div>'


def facts(rows: Sequence[tuple[str, str]]) -> str:
    """What is said of what, one line each, which break anywhere on a narrow page."""
    body = "".join(f"<tr>{element('th', name)}{element('td', said)}</tr>" for name, said in rows)
    return f'<table class="facts"><tbody>{body}</tbody></table>'


def cards(told: Sequence[tuple[str, str]]) -> str:
    """Large numbers side by side, each with what it is below it."""
    made = "".join(f'<div class="card">{element("b", n)}{element("span", what)}</div>' for n, what in told)
    return f'<div class="cards">{made}</div>'


def picture(data: bytes, kind: str, said: str, caption: str = "", width: int | None = None) -> str:
    """A picture inside the page: `kind` is `png` or `svg+xml`, `said` what a screen reader says, `width` in pixels."""
    held = base64.b64encode(data).decode("ascii")
    wide = "" if width is None else f' width="{width}"'
    image = f'<img alt="{html.escape(seen(said))}"{wide} src="data:image/{kind};base64,{held}">'
    told = element("figcaption", caption) if caption else ""
    return f"<figure>{image}{told}</figure>"


def svg_of(figure: Figure) -> bytes:
    """A figure as SVG, the same bytes every time: no date, and names drawn from a fixed salt."""
    import matplotlib

    held = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": SALT, "svg.fonttype": "path"}):
        figure.savefig(held, format="svg", metadata={"Date": None})
    return held.getvalue()


def png_of(figure: Figure, dpi: float, colours: int = 64) -> bytes:
    """A figure as a small PNG of few colours."""
    from PIL import Image

    held, small = io.BytesIO(), io.BytesIO()
    figure.savefig(held, format="png", dpi=dpi)
    held.seek(0)
    with Image.open(held) as image:
        image.convert("RGB").quantize(colours, dither=Image.Dither.NONE).save(small, format="png", optimize=True)
    return small.getvalue()
