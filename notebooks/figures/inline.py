"""Figures as small pictures: with few colours in a notebook that is saved, in the colours of the theme on a page."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell
    from matplotlib.figure import Figure

COLOURS = 64
"""Lines, words and heat maps need no more; a picture is then about a quarter as large."""
WIDEST_PX = 1000
"""A cell is hardly wider; a browser would shrink the picture to it."""

_INKS = re.compile(r"#(?:000000|1a1a1a|222222|262626|444444|8a8a8a)\b")
_THEMED = {
    "#2166ac": "--th-cool",
    "#e08214": "--th-warm",
    "#cfe3cf": "--th-target",
    "#6a6a6a": "--th-soft",
    "#ffffff": "--th-paper",
}
_SIZE = re.compile(r'<svg ([^>]*?)height="([0-9.]+)pt"([^>]*?)width="([0-9.]+)pt"')


def small_png(figure: Figure) -> bytes:
    """Draw a figure as PNG with a palette of its own, cut to what is drawn.

    >>> from matplotlib.figure import Figure
    >>> small_png(Figure(figsize=(1, 1)))[1:4]
    b'PNG'
    """
    from PIL import Image

    drawn, small = io.BytesIO(), io.BytesIO()
    dpi = min(figure.dpi, WIDEST_PX / figure.get_figwidth())
    figure.savefig(drawn, format="png", dpi=dpi, bbox_inches="tight", facecolor="white")
    Image.open(drawn).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(small, "PNG", optimize=True)
    return small.getvalue()


def register(shell: InteractiveShell) -> None:
    """Show every matplotlib figure that is the result of a cell so; matplotlib is not imported for it."""
    _pictures(shell).for_type_by_name("matplotlib.figure", "Figure", small_png)


def unregister(shell: InteractiveShell) -> None:
    """Leave figures to IPython again."""
    _pictures(shell).pop("matplotlib.figure.Figure", None)


def _pictures(shell: InteractiveShell) -> Any:
    formatter = shell.display_formatter
    assert formatter is not None
    return formatter.formatters["image/png"]


def themed_svg(figure: Figure) -> str:
    """Return a figure as SVG without background, its inks those of the text around it; letters stay letters.

    >>> from matplotlib.figure import Figure
    >>> figure = Figure(figsize=(1, 1))
    >>> _ = figure.text(0.5, 0.5, "dip", color="#1a1a1a")
    >>> "currentColor" in themed_svg(figure), themed_svg(figure)[:4]
    (True, '<svg')
    """
    import matplotlib

    held = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "thermicon"}):
        figure.savefig(held, format="svg", transparent=True, metadata={"Date": None})
    text = held.getvalue()
    text = _INKS.sub("currentColor", text[text.index("<svg") :])
    for colour, name in _THEMED.items():
        text = text.replace(colour, f"var({name}, {colour})")
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    # Without a colour of its own, text in a picture is black on any theme.
    text = re.sub(r'<g id="text_(\d+)">', r'<g id="text_\1" fill="currentColor">', text)
    return _SIZE.sub(r"<svg \1\3", text, count=1)
