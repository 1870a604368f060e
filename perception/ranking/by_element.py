"""Reasons for the distance of two icons by element."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..identification.episodes import PARTS, Episodes, distance_shares
from ..identification.tracks import Tracks
from ..observer.observer import MemoryForm, Observer
from ..sensation.percept import Percept
from .reasons import DistanceComponent, components_of, pair_reasons
from .rules_of_thumb import RuleResult, pair_rules

if TYPE_CHECKING:
    from thermicon.circuit import Trace


@dataclass(frozen=True, slots=True)
class PairInputs:
    """The input of reasons and rules of pairs: tracks on the nominal rig, as a nominal person feels them."""

    tracks: Tracks
    traces: Sequence[Trace]
    percepts: Sequence[Percept]
    episodes: Episodes
    observer: Observer
    memory: MemoryForm

    def why(self, i: int, j: int) -> tuple[str, ...]:
        """Reasons for the distance of two icons, by element, the one that carries most of it first."""
        elements = self._elements(i, j)
        if not elements:
            both = f"{self.tracks.names[i]} and {self.tracks.names[j]}"
            return (f"nothing differs: {both} play alike on every element, so their names are guessed",)
        return tuple(f"{name}: {said}" if name else said for name, own in elements for said in self._why((i, j), own))

    def rules(self, i: int, j: int) -> tuple[RuleResult, ...]:
        """Rules of thumb on two icons, on each element where they differ."""
        found = []
        for name, (a, b) in self._elements(i, j) or [("", self._places(i, j)[0])]:
            rules = pair_rules(self._trace(i, a), self._trace(j, b))
            found += [replace(rule, text=f"{name}: {rule.text}") if name else rule for rule in rules]
        return tuple(found)

    def parts(self, i: int, j: int) -> tuple[DistanceComponent, ...]:
        """Components of the distance: squares add over elements; values are of the element that has most of one."""
        each = [components_of(self.episodes, a, b, self.observer) for a, b in self._places(i, j)]
        found = []
        for own in zip(*each, strict=True):
            most = max(own, key=lambda part: part.value)
            found.append(most if len(own) == 1 else replace(most, value=math.hypot(*(part.value for part in own))))
        return tuple(found)

    def _why(self, icons: tuple[int, int], places: tuple[int, int]) -> tuple[str, ...]:
        one, other = (self._trace(icon, place) for icon, place in zip(icons, places, strict=True))
        felt = self.percepts[places[0]], self.percepts[places[1]]
        return pair_reasons(one, other, felt, self.observer, self.memory, self.episodes, places)

    def _trace(self, icon: int, place: int) -> Trace:
        """The trace of a track, which icons share, with the name of an icon."""
        trace = self.traces[place]
        return trace if self.tracks.played is None else replace(trace, icon=self.tracks.names[icon])

    def _places(self, i: int, j: int) -> list[tuple[int, int]]:
        played = self.tracks.played
        return [(i, j)] if played is None else [(int(row[i]), int(row[j])) for row in played]

    def _elements(self, i: int, j: int) -> list[tuple[str, tuple[int, int]]]:
        """Elements on which two icons differ with the tracks of both, the one that carries most of d′² first."""
        places = self._places(i, j)
        if self.tracks.played is None:
            return [("", places[0])]
        alike: dict[tuple[int, int], list[str]] = {}
        for name, pair in zip(self.tracks.surfaces, places, strict=True):
            if pair[0] != pair[1]:
                alike.setdefault(pair, []).append(name)
        return [(", ".join(alike[pair]), pair) for pair in sorted(alike, key=self._square, reverse=True)]

    def _square(self, pair: tuple[int, int]) -> float:
        shares = distance_shares(self.episodes, pair[0], self.episodes, pair[1], self.observer, self.memory)
        return sum(shares[part] for part in PARTS)
