"""A figure drawn for white paper, turned to light ink on a dark ground: hues stay, lightness is turned over."""

from __future__ import annotations

import colorsys
from typing import TYPE_CHECKING, Any

import numpy as np

from .figure_data import heat_map

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GROUND, INK = "#1c1c1c", "#ededed"
GREYISH, PALE, DARK = 0.05, 0.78, 0.55
"""Saturation below which a colour is a grey; lightness above and below which a hue is a background or too dark."""


def turn_dark(figure: Figure) -> None:
    """Recolour every line, surface and word; heat maps and the words on them stay as they are."""
    from matplotlib.collections import Collection
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch
    from matplotlib.text import Text

    on_maps = {id(text) for ax in figure.axes if heat_map(ax) is not None for text in ax.texts}
    for artist in figure.findobj():
        thing: Any = artist
        if isinstance(artist, Text):
            if id(artist) not in on_maps:
                thing.set_color(dark(thing.get_color()))
        elif isinstance(artist, Line2D):
            for name in ("color", "markerfacecolor", "markeredgecolor"):
                _turn(thing, name)
        elif isinstance(artist, Patch):
            face, edge = thing.get_facecolor(), thing.get_edgecolor()
            thing.set_facecolor(dark(face))
            thing.set_edgecolor(dark(edge))
        elif isinstance(artist, Collection):
            if thing.get_array() is None:
                thing.set_facecolor(_each(thing.get_facecolor()))
            thing.set_edgecolor(_each(thing.get_edgecolor()))
    for ax in figure.axes:
        ax.tick_params(colors=INK)


def _turn(line: Any, name: str) -> None:
    colour = getattr(line, f"get_{name}")()
    if isinstance(colour, str) and colour in ("auto", "none"):
        return
    getattr(line, f"set_{name}")(dark(colour))


def _each(colours: Any) -> Any:
    rows = np.atleast_2d(np.asarray(colours, dtype=float))
    return [dark(tuple(row)) for row in rows] if rows.size else colours


def dark(colour: Any) -> tuple[float, float, float, float]:
    """Return the colour that stands for another one on a dark ground.

    >>> [round(part, 2) for part in dark("#ffffff")], [round(part, 2) for part in dark("black")]
    ([0.11, 0.11, 0.11, 1.0], [0.93, 0.93, 0.93, 1.0])
    """
    from matplotlib.colors import to_rgba

    red, green, blue, alpha = to_rgba(colour)
    hue, lightness, saturation = colorsys.rgb_to_hls(red, green, blue)
    if max(red, green, blue) - min(red, green, blue) < GREYISH:
        lightness, saturation = 0.93 - 0.82 * lightness, 0.0
    elif lightness > PALE:
        lightness *= 0.33
    elif lightness < DARK:
        lightness = DARK + 0.5 * (DARK - lightness)
    return (*colorsys.hls_to_rgb(hue, lightness, saturation), alpha)
