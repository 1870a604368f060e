"""Log posterior of the constants: rows and priors as residuals, for one variant with some mechanisms off.

What sampled draws say of each constant is a `Summary`: median, interval, and how far it is from its prior.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..experiments.laboratory import Laboratory
from ..experiments.published import Predictions, predict
from ..observer.channels import CHANNELS, Variable
from ..observer.draws import PosteriorDraws
from ..observer.mechanisms import Without, find_mechanism
from ..observer.priors import LABORATORIES, Priors, load_priors, priors_of
from .results import UNMOVED_SD
from .rows import Row, load_rows

BoolArray = NDArray[np.bool_]
FARTHEST = 30.0
"""A row that is missed by more standard deviations counts as this many, so that a wild step is not fatal."""


@dataclass(frozen=True)
class Posterior:
    """What is inferred, from which rows: vectors are in SDs of the prior, 0 at its middle.

    >>> posterior = Posterior()
    >>> len(posterior.priors), len(posterior.rows)
    (52, 54)
    """

    variable: Variable = "temperature"
    without: Without = frozenset()
    left_out: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        for name in self.without:
            find_mechanism(name)
        known = {row.experiment for row in load_rows()}
        if unknown := sorted(self.left_out - known):
            raise ValueError(
                f"there is no experiment {unknown[0]!r} to leave out: choose of {', '.join(sorted(known))}"
            )

    @cached_property
    def fixed(self) -> Mapping[str, float]:
        """Parameters that are not inferred here, with their values."""
        fixed: dict[str, float] = {}
        for name in sorted(self.without):
            fixed.update(find_mechanism(name).fixed)
        if self.variable == "heat flow":
            middle = load_priors().values(load_priors().middle)
            fixed.update({name: middle[name] for name in ("cold limit", "warm limit", "softness of the limits")})
        return fixed

    @cached_property
    def priors(self) -> Priors:
        """Priors of what is inferred: the constants and an offset for each laboratory and channel."""
        off = set(self.fixed)
        if "laboratories" in self.without:
            off |= {f"{place} {channel}" for place in LABORATORIES for channel in CHANNELS}
        return priors_of(self.variable).without(tuple(off))

    @cached_property
    def rows(self) -> tuple[Row, ...]:
        """The rows that count."""
        return tuple(row for row in load_rows() if row.experiment not in self.left_out)

    def values(self, vector: Array) -> dict[str, float]:
        """Constants by name from a vector in SDs of the prior."""
        return {**self.fixed, **self.priors.values(self.priors.middle + self.priors.sd * vector)}

    def predictions(self, vector: Array) -> Predictions:
        """Predictions of every row, left out or not."""
        return predict(Laboratory(self.values(vector), self.variable, self.without))

    def residuals(self, vector: Array) -> Array:
        """Misses of rows and distances from the priors' middles, in SDs: half their squares are −log posterior."""
        return np.concatenate([self.misses(vector)[self.counted], vector])

    def misses(self, vector: Array) -> Array:
        """Misses of all rows, left out or not, in their SDs."""
        predictions = self.predictions(vector)
        missed = np.array([(predictions[row.key] - row.value) / row.sd for row in load_rows()])
        clipped: Array = np.clip(np.nan_to_num(missed, nan=FARTHEST), -FARTHEST, FARTHEST)
        return clipped

    @cached_property
    def counted(self) -> BoolArray:
        """Which of all rows count."""
        return np.array([row.experiment not in self.left_out for row in load_rows()])


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
