"""The worth of data about a laboratory before anything is measured."""

from __future__ import annotations

import math
from dataclasses import dataclass

from thermicon.base.numbers.arrays import Array

from ..observer.channels import CHANNELS
from ..ranking.assumptions import explained_together
from ..ranking.sensitivity import load_measurements
from .states import Laboratories, LaboratoryPrior

MOST_KNOWN = 0.99
"""A regression on some hundred draws cannot claim more of a variance."""


@dataclass(frozen=True, slots=True)
class Worth:
    """Data, and how many times narrower the interval of a wanted number becomes with it, at most (1: no narrower)."""

    data: str
    narrower: float


def worth_of(prior: LaboratoryPrior, laboratories: Laboratories, wanted: Array) -> tuple[Worth, ...]:
    """What measurements could narrow a number of each laboratory (laboratories,), the most first.

    At most so much, since a measurement tells no more than all constants on which it depends.

    >>> prior = LaboratoryPrior.of(None, "episodes")
    >>> laboratories = prior.first(200, 0)
    >>> decision_s = prior.values(laboratories)[:, prior.names.index("decision time")]
    >>> first, *_ = worth_of(prior, laboratories, decision_s)
    >>> first.data, round(first.narrower)
    ('reaction times and false alarms to changes well above threshold', 10)
    """
    values = prior.values(laboratories)
    names = [*prior.names[: -len(CHANNELS)], *(f"laboratory, {channel}" for channel in CHANNELS)]
    kinds = []
    for data, constants in load_measurements(of_pilots=True).items():
        columns = [place for place, name in enumerate(names) if name in constants]
        kinds.append(Worth(data, narrower(explained_together(values[:, columns], wanted))))
    return tuple(sorted(kinds, key=lambda kind: -kind.narrower))


def narrower(share: float) -> float:
    """How many times narrower an interval becomes when so large a share of the variance is known.

    >>> narrower(0.0), narrower(0.75)
    (1.0, 2.0)
    """
    return 1.0 / math.sqrt(1.0 - min(max(share, 0.0), MOST_KNOWN))
