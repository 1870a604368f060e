"""Figures in a notebook as small pictures, so that a notebook that is saved with its outputs stays small."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell
    from matplotlib.figure import Figure

COLOURS = 64
"""Lines, words and heat maps need no more; a picture is then about a quarter as large."""
WIDEST_PX = 1000
"""A cell is hardly wider; a browser would shrink the picture to it."""


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
