"""What a sampled posterior says of each constant: median, interval, and how far it is from its prior."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..observer.draws import PosteriorDraws
from .posterior import Posterior
from .results import UNMOVED_SD

UNMOVED_SHIFT = 0.3
"""A constant that keeps more than `UNMOVED_SD`, with its median moved by fewer SDs of the prior, was not moved."""
EDGE = 1.96
"""A median so many SDs of the prior away from its middle lies at the edge of the prior."""


@dataclass(frozen=True, slots=True)
class Summary:
    """One constant in its own unit: median and 95 % interval; `narrowed` and `shift` are in SDs of its prior."""

    name: str
    unit: str
    median: float
    low: float
    high: float
    narrowed: float
    shift: float

    @property
    def unmoved(self) -> bool:
        """Whether the posterior is the prior, as good as."""
        return self.narrowed > UNMOVED_SD and abs(self.shift) < UNMOVED_SHIFT

    @property
    def at_edge(self) -> bool:
        """Whether evidence and prior disagree so much that the median lies at the end of the prior's 95 %."""
        return abs(self.shift) > EDGE


def summarise(draws: PosteriorDraws) -> tuple[Summary, ...]:
    """Every constant of a posterior, in the order of the table."""
    priors = Posterior(draws.variable).priors
    rows = []
    for prior in priors.each:
        values = draws.values(prior.name)
        places = (np.array([prior.to_place(value) for value in values.tolist()]) - prior.middle) / prior.sd
        low, median, high = draws.interval(prior.name)
        rows.append(Summary(prior.name, prior.unit, median, low, high, float(places.std()), float(np.median(places))))
    return tuple(rows)
