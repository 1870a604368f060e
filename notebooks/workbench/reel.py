"""What the page asks for once: the curves of all icons, to play them, and the icons of shipped sets, to insert them."""

from __future__ import annotations

from dataclasses import replace

from thermicon.icons import Family, Icon, library

from ..editing.cue_check import read_text
from ..timeline.frames import DRAGGED_POINTS, CanvasFrame, frame_of
from ..timeline.scene import draw
from .design_model import DesignModel

MOST_PLAYED, MOST_MEMBERS = 24, 24
"""Icons of a set that are played, and members of a family that are offered one by one."""


def reel_of(design: DesignModel) -> tuple[list[CanvasFrame], str]:
    """Return one frame for each icon of the set that can be drawn, and what is left out or why there is none."""
    reading = read_text(design.text)
    if reading.icons is None:
        return [], "not played: the text has errors"
    icons, frames, left = reading.icons, list[CanvasFrame](), []
    for name in reading.names[:MOST_PLAYED]:
        icon = icons.find(name)
        assert icon is not None
        try:
            drawing = draw(icon, design.rig, design.observer, reading)
        except (ValueError, ArithmeticError):
            left.append(name)
            continue
        shown = replace(design.scene, icon=name, names=(), stale=False, drawing=drawing)
        frames.append(frame_of(shown, DRAGGED_POINTS))
    more = len(icons) - MOST_PLAYED
    said = [f"{name} cannot be drawn" for name in left] + ([f"the first of {len(icons):,}"] if more > 0 else [])
    return frames, "; ".join(said)


def shipped_texts() -> dict[str, dict[str, str]]:
    """Texts of the icons of shipped sets, by set and name; a large family is one text."""
    found = {}
    for name, icons in library().items():
        if icons.spatial:
            continue
        entries: list[Icon | Family] = []
        for entry in icons.entries:
            entries += entry if isinstance(entry, Family) and len(entry) <= MOST_MEMBERS else [entry]
        texts = ((entry.name, str(entry)) for entry in entries)
        found[name] = {own: text[text.index("\nicon ") + 1 :].rstrip() for own, text in texts}
    return found
