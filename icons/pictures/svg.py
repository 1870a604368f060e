"""The few parts of SVG that pictures are made of: the document, lines of text, paths."""

import unicodedata
from collections.abc import Sequence
from html import escape

from .curve_style import Points


def document(width: int, height: int, label: str, parts: Sequence[str]) -> str:
    """Return an SVG of this size in pixels; ``label`` is what a screen reader says of it."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
        f'role="img" aria-label="{escape(plain(label))}" font-family="system-ui,sans-serif" '
        f'style="background:#fff;max-width:100%;height:auto">{"".join(parts)}</svg>'
    )


def words(x: float, y: float, said: str, size: int, room: float, bold: bool = False, colour: str = "#111") -> str:
    """Return a line of text, cut to its room at an estimate of its width; a pointer at rest on it shows all of it."""
    whole = plain(said)
    cut = _cut(whole, room / (size * (0.62 if bold else 0.55)))
    full = f"<title>{escape(whole)}</title>" if cut != whole else ""
    weight = ' font-weight="600"' if bold else ""
    return f'<text x="{x:g}" y="{y:g}" font-size="{size}"{weight} fill="{colour}">{full}{escape(cut)}</text>'


def plain(text: str) -> str:
    """Return a text as one line, without the characters that turn the direction of what follows."""
    return "".join(char for char in " ".join(text.split()) if unicodedata.category(char) not in ("Cf", "Cc"))


def _cut(text: str, room: float) -> str:
    used = 0.0
    for place, char in enumerate(text):
        used += 1.8 if unicodedata.east_asian_width(char) in "WF" else 1.0
        if used > room:
            return text[: max(1, place - 1)].rstrip() + "…"
    return text


def path(points: Points) -> str:
    """Return a path through points, relative after the first, without what a tenth of a pixel does not show."""
    (x, y), moves = points[0], []
    for to_x, to_y in points[1:]:
        if (to_x, to_y) != (x, y):
            across, down = _short(to_x - x), _short(to_y - y)
            moves.append(across + down if down.startswith("-") else f"{across},{down}")
        x, y = to_x, to_y
    return f"M{points[0][0]:g},{points[0][1]:g}l{' '.join(moves)}" if moves else ""


def _short(number: float) -> str:
    """A number to a tenth, without a zero before its point."""
    text = f"{number:.1f}".removesuffix(".0")
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else "0" if text == "-0" else text
