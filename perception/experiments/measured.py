"""What a simulated procedure measured, and the persons it was run on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, own_arrays
from ..observer.channels import Channel
from ..observer.observer import Observer
from ..observer.people import People


@dataclass(frozen=True, slots=True)
class Measurement:
    """One number for each person, in `unit`; inf where the strongest stimulus was not felt.

    Thresholds are changes from the baseline at the surface where the stimulus was prescribed, K,
    without sign. Without people there is one person, the nominal one.
    """

    procedure: str
    channel: Channel
    unit: str
    each: Array
    conditions: str

    def __post_init__(self) -> None:
        own_arrays(self, "each")
        if self.each.ndim != 1 or self.each.size == 0 or np.isnan(self.each).any():
            raise ValueError(f"{self.procedure}: one number is needed for each person, not {self.each.shape}")

    @property
    def value(self) -> float | None:
        """Median over people; None where half of them felt nothing."""
        return self.quantile(0.5)

    @property
    def unfelt(self) -> float:
        """Share of people who did not feel the strongest stimulus."""
        return float(np.isinf(self.each).mean())

    def quantile(self, share: float) -> float | None:
        """Value that a share of people lies below; None where so many felt nothing."""
        return quantile_felt(np.sort(self.each), share)

    def __repr__(self) -> str:
        value = "not felt" if self.value is None else f"{self.value:.3g} {self.unit}"
        low, high = self.quantile(0.025), self.quantile(0.975)
        spread = "" if self.each.size == 1 or low is None or high is None else f" [{low:.3g}, {high:.3g}]"
        crowd = "1 person" if self.each.size == 1 else f"{self.each.size} people"
        return f"Measurement({self.procedure}, {self.channel}: {value}{spread}, {crowd}; {self.conditions})"


def quantile_felt(ordered: Array, share: float) -> float | None:
    """Value that a share of numbers (n,), in rising order, lies below; None where it lies among those not felt (inf).

    >>> quantile_felt(np.array([1.0, 2.0, np.inf]), 0.25), quantile_felt(np.array([1.0, 2.0, np.inf]), 0.75)
    (1.5, None)
    """
    place = share * (ordered.size - 1)
    low, high = float(ordered[int(np.floor(place))]), float(ordered[int(np.ceil(place))])
    found = low if low == high else low + (place - np.floor(place)) * (high - low)
    return float(found) if np.isfinite(found) else None


@dataclass(frozen=True, slots=True)
class Crowd:
    """Columns (n,) of people: multipliers of thresholds and criteria, conduction of each channel s, decision s."""

    threshold_cold: Array
    threshold_warm: Array
    criterion: tuple[Array, Array]
    conduction_s: tuple[Array, Array]
    decision_s: Array

    def __len__(self) -> int:
        return int(self.decision_s.size)

    def part(self, which: NDArray[np.bool_]) -> Crowd:
        """Some of the people."""
        return Crowd(
            self.threshold_cold[which],
            self.threshold_warm[which],
            (self.criterion[0][which], self.criterion[1][which]),
            (self.conduction_s[0][which], self.conduction_s[1][which]),
            self.decision_s[which],
        )


def crowd_of(observer: Observer, site: str, people: People | None) -> Crowd:
    """The people at a site, or the nominal person when there are none.

    >>> len(crowd_of(Observer.load(), "thenar", None))
    1
    """
    path = observer.path_m(site)
    if people is None:
        one = np.ones(1)
        conduction = observer.delay_s("cold", path) * one, observer.delay_s("warm", path) * one
        return Crowd(one, one, (one, one), conduction, observer.decision_s * one)
    own = path * people.path
    return Crowd(
        people.threshold_cold,
        people.threshold_warm,
        (people.criterion_cold, people.criterion_warm),
        (observer.delays_s("cold", own), observer.delays_s("warm", own)),
        people.decision_s,
    )
