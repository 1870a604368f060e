"""Components of the distance of two icons as they are remembered: direction, intensity, rate, duration, pause.

Each is the part of d′ from memory that it carries, so that their squares add up to d′² of the pair.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..identification.episodes import PARTS as COMPONENTS
from ..identification.episodes import Episode, Episodes, distance_shares, remembered
from ..observer.observer import Observer
from ..sensation.percept import Percept, perceive

if TYPE_CHECKING:
    from thermicon.circuit import Trace

__all__ = ["COMPONENTS", "DistanceComponent", "components_of", "distance_components", "strongest"]
NOTICEABLE = 1.0
"""One SD of what is remembered."""


@dataclass(frozen=True, slots=True)
class DistanceComponent:
    """One component of the distance of two icons, in d′ from memory; `a` and `b` are its values for each icon.

    Attributes
    ----------
    name
        `direction` (what only one icon has), `intensity`, `rate`, `duration` or `pause`.
    value
        The part of the d′ of the pair that it carries.
    a, b
        Values of the two episodes at one place that differ most in it, in multiples of threshold (intensity), those per
        second (rate) or s (duration, pause); None for an icon that is not felt, and for `direction`.

    See Also
    --------
    distance_components : Computes all five.

    Examples
    --------
    >>> component = DistanceComponent("rate", 2.5, 12.0, 5.0)
    >>> component, component.above
    (DistanceComponent(rate 2.5 d′), True)

    """

    name: str
    value: float
    a: float | None = None
    b: float | None = None

    @property
    def above(self) -> bool:
        """Whether it carries at least one SD of memory noise."""
        return self.value >= NOTICEABLE

    def to_dict(self) -> dict[str, str | float | bool | None]:
        """The keys of the ranking file."""
        return {
            "part": self.name,
            "value": self.value,
            "unit": "d′",
            "noticeable": NOTICEABLE,
            "above": self.above,
            "a": self.a,
            "b": self.b,
        }

    def __repr__(self) -> str:
        return f"DistanceComponent({self.name} {self.value:.3g} d′)"


def distance_components(
    a: Trace, b: Trace, observer: Observer | None = None, felt: tuple[Percept, Percept] | None = None
) -> tuple[DistanceComponent, ...]:
    """The five components of the distance of two simulated icons for a nominal person.

    Parameters
    ----------
    a, b
        Traces at one rate.
    observer
        The person (None: the nominal one).
    felt
        Their percepts, where they are known already.

    Returns
    -------
    tuple of DistanceComponent
        In the order of `COMPONENTS`; the root of their summed squares is the d′ of the pair by the norm `episodes`.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> icons, rig = load_library("six-icons"), Rig.load("thenar")
    >>> step, ramp = (simulate(icons[name], rig, tail_s=10) for name in ("cooling-step", "linear-cooling"))
    >>> max(distance_components(step, ramp), key=lambda component: component.value).name
    'rate'

    """
    person = Observer.load() if observer is None else observer
    percepts = (perceive(a, person), perceive(b, person)) if felt is None else felt
    return components_of(remembered(percepts, person), 0, 1, person)


def components_of(episodes: Episodes, i: int, j: int, observer: Observer) -> tuple[DistanceComponent, ...]:
    """The components of two of the first person's icons."""
    shares = distance_shares(episodes, i, episodes, j, observer, "episodes")
    one, other = (episodes.listed(0, place) for place in (i, j))
    return tuple(
        DistanceComponent(name, math.sqrt(max(shares[name], 0.0)), *most_different(one, other, name))
        for name in COMPONENTS
    )


def strongest(episodes: tuple[Episode, ...]) -> Episode | None:
    """The episode with the largest peak; None of none."""
    return max(episodes, key=lambda episode: episode.peak, default=None)


FIELDS = {"intensity": "peak", "rate": "rate_per_s", "duration": "length_s", "pause": "pause_s"}
"""Attribute of an episode behind each component; `direction` has none."""
NEAR_NOTHING = 0.1
"""Added to both values before their ratio is taken, so that a pause of 0 does not count as infinitely short."""


def most_different(one: Sequence[Episode], other: Sequence[Episode], name: str) -> tuple[float | None, float | None]:
    """A component's values of the two episodes at one place that differ most in it, or of the strongest."""
    if name not in FIELDS:
        return None, None
    pairs = [(x, y) for x, y in zip(one, other, strict=False) if x.channel == y.channel]
    if not pairs:
        first, second = (
            None if top is None else float(getattr(top, FIELDS[name]))
            for top in (strongest(tuple(one)), strongest(tuple(other)))
        )
        return first, second
    values = [(float(getattr(x, FIELDS[name])), float(getattr(y, FIELDS[name]))) for x, y in pairs]
    return max(values, key=lambda pair: abs(math.log((pair[0] + NEAR_NOTHING) / (pair[1] + NEAR_NOTHING))))
