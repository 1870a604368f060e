"""Figures as small vector pictures that take the colours of the page's theme."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_INKS = re.compile(r"#(?:000000|1a1a1a|222222|262626|444444|8a8a8a)\b")
_THEMED = {
    "#2166ac": "--th-cool",
    "#e08214": "--th-warm",
    "#cfe3cf": "--th-target",
    "#6a6a6a": "--th-soft",
    "#ffffff": "--th-paper",
}
_SIZE = re.compile(r'<svg ([^>]*?)height="([0-9.]+)pt"([^>]*?)width="([0-9.]+)pt"')


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
