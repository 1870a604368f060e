"""Designed and delivered: how far two traces of one cue differ, and from which deviation on that is a loss."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np

from ..records import Table, load_records
from ..solver.trace import Trace

PLACES = {"skin": "skin_C", "cold receptor": "cold_receptor_C", "warm receptor": "warm_receptor_C"}


@dataclass(frozen=True, slots=True)
class Deviation:
    """Delivered minus designed at one place: largest difference in K (signed) and its time in s, rms in K."""

    place: str
    largest_K: float
    at_s: float
    rms_K: float


@dataclass(frozen=True, slots=True)
class DeliveryDeviation:
    """How far a delivered trace deviates from the designed one, at the skin and at both receptors."""

    places: tuple[Deviation, ...]

    def __repr__(self) -> str:
        places = ", ".join(
            f"{place.place} {place.largest_K * 1e3:+.3g} mK (rms {place.rms_K * 1e3:.3g})" for place in self.places
        )
        return f"DeliveryDeviation({places})"

    @property
    def lost(self) -> tuple[Deviation, ...]:
        """The deviation at each receptor where its rms is over the stated loss."""
        limit = loss_limit("receptor difference")
        return tuple(place for place in self.places if "receptor" in place.place and place.rms_K > limit)


def delivery_deviation(designed: Trace, delivered: Trace) -> DeliveryDeviation:
    """Return how far the delivered trace deviates from the designed one; both have the same rows.

    >>> from thermicon.circuit import Drive, Rig, simulate_current
    >>> low, high = (simulate_current(Drive([0, 1], [a, a]), Rig.load("thenar")) for a in (0.08, 0.081))
    >>> [round(one.largest_K, 3) for one in delivery_deviation(low, high).places]
    [-0.082, -0.078, -0.078]
    """
    if len(designed.time_s) != len(delivered.time_s):
        raise ValueError(f"traces of {len(designed.time_s)} and {len(delivered.time_s)} rows cannot be compared")
    deviations = []
    for place, column in PLACES.items():
        deviation_K = getattr(delivered, column) - getattr(designed, column)
        most = int(np.argmax(np.abs(deviation_K)))
        rms = float(np.sqrt(np.mean(deviation_K**2)))
        deviations.append(Deviation(place, float(deviation_K[most]), float(designed.time_s[most]), rms))
    return DeliveryDeviation(tuple(deviations))


@cache
def loss_table() -> Table:
    """The stated losses, each with its source."""
    return load_records(resources.files("thermicon.circuit") / "data" / "loss.toml")


def loss_limit(quantity: str) -> float:
    """Return the limit of one kind of loss.

    >>> loss_limit("detection drop")
    0.05
    """
    return loss_table().one(quantity).central
