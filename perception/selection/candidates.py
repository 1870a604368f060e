"""Members of families as shares between 0 and 1 of their parameters: what a search moves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from thermicon.icons import Family, Icon
    from thermicon.icons.model.parameter import Parameter

MOVED = 0.5
FINE = 200
"""Parts of a span that a found value is rounded to, at least: 1 to 6 °C by 0.01 °C."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """One icon that is tried: its family and a share, 0–1, for each parameter; no family for a plain icon."""

    icon: Icon
    family: Family | None = None
    shares: tuple[float, ...] = ()

    def moved(self, rng: np.random.Generator, step: float) -> Candidate | None:
        """The same family about half of whose parameters moved by a random step; None where that cannot be run."""
        if self.family is None:
            return None
        which = rng.random(len(self.shares)) < MOVED
        which[rng.integers(len(self.shares))] = True
        jump = np.clip(np.array(self.shares) + which * step * rng.normal(size=len(self.shares)), 0.0, 1.0)
        fresh = rng.random(len(self.shares))
        # A list has no neighbours: half of the time a listed value is drawn anew.
        listed = np.array([p.span is None or not p.unit for p in self.family.parameters])
        anew = which & listed & (rng.random(len(self.shares)) < MOVED)
        return candidate_at(self.family, np.where(anew, fresh, jump).tolist())


def candidate_at(family: Family, shares: Sequence[float]) -> Candidate | None:
    """The candidate at these shares; None where the member cannot be run."""
    from thermicon.icons import CueErrors

    try:
        return Candidate(member(family, shares), family, tuple(shares))
    except (CueErrors, ValueError):
        return None


def sample_candidates(families: Sequence[Family], count: int, rng: np.random.Generator) -> list[Candidate]:
    """Members of the families, as many of each: all that they count out where these are few, else drawn at random."""
    found: list[Candidate | None] = []
    each = max(2, count // len(families))
    for family in families:
        some = rng.choice(len(family), each, replace=False) if len(family) > each else np.arange(len(family))
        for index in np.sort(some):
            places = np.unravel_index(index, [len(parameter) for parameter in family.parameters])
            found.append(
                candidate_at(family, [share_of(p, int(k)) for p, k in zip(family.parameters, places, strict=True)])
            )
    return [candidate for candidate in found if candidate is not None]


def member(family: Family, shares: Sequence[float]) -> Icon:
    """The icon of a family at shares of its parameters, spans taken as continuous between their ends.

    >>> from thermicon.icons import read_cue
    >>> member(read_cue("search-space").families[0], [0.5, 0.33, 0.0, 0.9]).name
    'dip_depth=3.5_rate=1.66_pause=0.5_times=2'
    """
    pairs = zip(family.parameters, shares, strict=False)
    return family.variant({parameter.name: value_at(parameter, share) for parameter, share in pairs})


def value_at(parameter: Parameter, share: float) -> float:
    """Value of a parameter at a share of its range, in its unit: continuous in a span, one of those listed or counted.

    >>> from thermicon.icons.model.parameter import Parameter
    >>> value_at(Parameter("rate", "°C/s", span=(1, 3, 0.5)), 0.33), value_at(Parameter("n", "", span=(1, 3, 1)), 0.99)
    (1.66, 3.0)
    """
    if parameter.span is None or not parameter.unit:
        return parameter.value(_place(share, len(parameter)))
    low, high, _ = parameter.span
    digits = math.ceil(math.log10(FINE / (high - low))) if high > low else 0
    return min(max(round(low + share * (high - low), digits), low), high)


def share_of(parameter: Parameter, place: int) -> float:
    """The share at which a parameter has the value that it counts at a place."""
    if parameter.span is None or not parameter.unit:
        return (place + 0.5) / len(parameter)
    low, high, _ = parameter.span
    return (parameter.value(place) - low) / (high - low) if high > low else 0.5


def _place(share: float, count: int) -> int:
    return min(int(share * count), count - 1)
