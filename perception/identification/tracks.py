"""Distinct tracks of icons on the elements of a layout.

A person's surfaces have that person's thresholds, since the scatter of thresholds is published between people and not
between the hands of one; noise is of each surface's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array
from thermicon.icons import Icon, SpatialIcon
from thermicon.icons.model.statements import Rest

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.circuit.rig.layout import Layout

Members = tuple[Icon, ...] | tuple[SpatialIcon, ...]
"""Icons of one set: on one element, or all on several."""


@dataclass(frozen=True, slots=True)
class Tracks:
    """Distinct tracks of icons by the distinct rigs that they are played on.

    `names` are those of the icons, `by_rig` each rig with its tracks, `surfaces` the elements that play. `played`
    (surfaces, icons) says which of all tracks, one rig after the other, an element plays in an icon; None: icons on one
    element, which are their own tracks. In a share `lapse` of trials the task itself makes people give any name.
    `ranks` are those of the surfaces by what they play, whatever their names and their order in the layout.
    """

    names: tuple[str, ...]
    by_rig: tuple[tuple[Rig, tuple[Icon, ...]], ...]
    surfaces: tuple[str, ...] = ("",)
    played: NDArray[np.int64] | None = None
    lapse: float = 0.0
    ranks: tuple[int, ...] = (0,)

    @classmethod
    def of(cls, icons: Sequence[Icon] | Sequence[SpatialIcon], layout: Layout) -> Tracks:
        """The tracks of icons on a layout; an element that never plays is left out, and who pauses has a rest."""
        names, spatial = tuple(icon.name for icon in icons), [icon for icon in icons if isinstance(icon, SpatialIcon)]
        if not spatial:
            return cls(names, ((layout.alone, tuple(icon for icon in icons if isinstance(icon, Icon))),))
        still = Icon("rest", (Rest(1.0),), replace(spatial[0].context, elements=()))
        elements = [element for element in layout.elements if any(element.name in icon.tracks for icon in spatial)]
        known: dict[Rig, dict[tuple[object, object], Icon]] = {element.rig: {} for element in elements}
        keys = []
        for element in elements:
            tracks = [icon.tracks.get(element.name, still) for icon in spatial]
            keys.append([(element.rig, (track.context, track.statements)) for track in tracks])
            for (rig, key), track in zip(keys[-1], tracks, strict=True):
                known[rig].setdefault(key, track)
        places = {(rig, key): 0 for rig, tracks_of in known.items() for key in tracks_of}
        places = {pair: place for place, pair in enumerate(places)}
        played = np.array([[places[pair] for pair in row] for row in keys], dtype=np.int64)
        by_rig = tuple((rig, tuple(tracks_of.values())) for rig, tracks_of in known.items())
        told = [[f"{rig.document} {key}" for rig, key in row] for row in keys]
        ordered = sorted(range(len(told)), key=told.__getitem__)
        ranks = tuple(ordered.index(surface) for surface in range(len(told)))
        return cls(names, by_rig, tuple(element.name for element in elements), played, layout.lapse, ranks)

    @property
    def count(self) -> int:
        """Number of distinct tracks."""
        return sum(len(tracks) for _, tracks in self.by_rig)

    def row(self, icon: int) -> list[int]:
        """The places of the tracks of all surfaces in an icon."""
        return [icon] if self.played is None else self.played[:, icon].tolist()

    def of_icon(self, icon: int) -> list[tuple[tuple[str, ...], int]]:
        """The distinct tracks that play in an icon (else a rest), each with its elements and its place."""
        if self.played is None:
            return [((), icon)]
        rests = [_is_rest(track) for _, tracks in self.by_rig for track in tracks]
        row = self.row(icon)
        places = dict.fromkeys(place for place in row if not rests[place]) or row[:1]
        alike = zip(self.surfaces, row, strict=True)
        elements = [(name, place) for name, place in alike if not rests[place]]
        return [(tuple(name for name, own in elements if own == place), place) for place in places]

    def lapses(self, own: Array) -> Array:
        """Share (people,) of trials with any name: a person's `own`, and of the others those that the task costs."""
        return own if self.lapse == 0.0 else np.asarray(1.0 - (1.0 - own) * (1.0 - self.lapse))


def _is_rest(track: Icon) -> bool:
    return all(isinstance(statement, Rest) for statement in track.statements)
