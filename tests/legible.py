"""Faults of legibility in a drawn figure."""

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.path import Path as Outline
from matplotlib.text import Text
from matplotlib.transforms import Affine2D

GAP_PT, SMALLEST_PT = 0.36, 5.5
"""Half a pixel of a screen around each text; letters that journals take."""


def troubles(figure: Figure) -> list[str]:
    """Texts that are tiny or reach out of a figure, and pairs that touch, aslant ones by their own outline."""
    drawn: dict[Text, Outline] = {}
    usual = Text.draw

    def draw(text: Text, renderer: Any, *more: Any, **named: Any) -> None:
        usual(text, renderer, *more, **named)
        if text.get_visible() and text.get_text().strip():
            drawn[text] = outline(text, renderer, float(figure.dpi) * GAP_PT / 72.0)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Text, "draw", draw)
        figure.draw_without_rendering()
    texts, boxes = list(drawn), np.array([each.get_extents().extents for each in drawn.values()])
    low, high = boxes[:, :2], boxes[:, 2:]
    out = (low.min(axis=1) < -1.0) | (high > np.array(figure.bbox.size) + 1.0).any(axis=1)
    found = [f"{texts[k].get_text()!r} reaches out" for k in np.flatnonzero(out)]
    found += [f"{text.get_text()!r} is tiny" for text in texts if float(text.get_fontsize()) < SMALLEST_PT]
    near = (low[:, None] < high[None]).all(axis=2)
    for a, b in np.argwhere(np.triu(near & near.T, 1)):
        if drawn[texts[a]].intersects_path(drawn[texts[b]], filled=True):
            found.append(f"{texts[a].get_text()!r} touches {texts[b].get_text()!r}")
    return found


def outline(text: Text, renderer: Any, gap: float) -> Outline:
    """The rectangle around a text and a gap."""
    angle, box = text.get_rotation(), text.get_window_extent(renderer)
    text.set_rotation(0.0)
    flat = text.get_window_extent(renderer).padded(gap)
    text.set_rotation(angle)
    turn = Affine2D().translate(-0.5, -0.5).scale(flat.width, flat.height).rotate_deg(angle)
    return Outline.unit_rectangle().transformed(turn.translate(*((box.p0 + box.p1) / 2.0)))
