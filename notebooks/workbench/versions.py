"""A version of the design that is pinned beside the present one, and what is said of both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from thermicon.base.words.number_text import percent
from thermicon.circuit import Rig
from thermicon.perception import Ranking

from ..files.document import Document
from ..timeline.frames import DRAGGED_POINTS, CanvasFrame, frame_of
from ..timeline.scene import Scene
from .set_model import WELL, SetRequest

BEHIND = {"temperature": ("skin",), "heat": ("skin",), "current": ("current",), "sensation": ("cold", "warm")}
"""Curves of a pinned version that lie behind the present ones, by their panel."""


@dataclass(frozen=True, slots=True, eq=False)
class Version:
    """A scene with the rig that its knobs start from, the values that they are set to, and the document it is of."""

    scene: Scene
    nominal: Rig
    values: Mapping[str, float]
    document: Document

    @property
    def request(self) -> SetRequest:
        """Text and rig, of which its set is ranked."""
        return self.scene.text, self.scene.rig

    def behind(self, frame: CanvasFrame) -> CanvasFrame:
        """Put the curves of this version behind those of a frame, on a clock of their own."""
        own = frame_of(self.scene, DRAGGED_POINTS)
        buffers, panels = list(frame.buffers), []
        series = {panel["key"]: panel["series"] for panel in own.meta["panels"]}
        for panel in frame.meta["panels"]:
            behind = []
            for each in series.get(panel["key"], ()):
                if each["key"] in BEHIND[panel["key"]]:
                    behind.append({**each, "buffer": len(buffers)})
                    buffers.append(own.buffers[each["buffer"]])
            panels.append({**panel, "pinned": behind})
        return CanvasFrame({**frame.meta, "panels": panels, "pinned": own.meta["time"]}, tuple(buffers))

    def row(self, side: str, ranking: Ranking | None, stale: bool = False) -> dict[str, Any]:
        """One row of the table of versions; what is not ranked yet is a dash."""
        drawing = self.scene.drawing
        onset = None if drawing is None else drawing.percept.onset_s
        felt = "–" if drawing is None else "not felt" if onset is None else f"{onset:.2f} s"
        changed = " *" if self.values else ""
        row = {"side": side, "what": f"{self.scene.icon}, {self.nominal.name}{changed}", "onset": felt, "stale": stale}
        numbers = dict.fromkeys(("set", "icon", "worst"), "–")
        if ranking is not None and len(ranking.icons) > 1:
            nearly = "≈ " if ranking.people < WELL[0] else ""
            numbers["set"] = nearly + percent(ranking.felt_and_named)
            for each in ranking.icons:
                if each.name == self.scene.icon:
                    numbers["icon"] = nearly + percent(each.felt_and_named)
            if (worst := ranking.worst) is not None:
                confused = percent(worst.confused_probability)
                numbers["worst"] = f"{worst.a} and {worst.b}: {nearly}{confused} confused"
        return row | numbers
