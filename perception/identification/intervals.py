"""How far a prediction moves when the observer's parameters lie elsewhere in their intervals.

Observers are drawn from within the intervals (Latin hypercube, one seed), each judges the icons with the
same few people on the same noise, and what it changes against the shipped observer is added to the
prediction. The interval covers 95 % of the draws. It is not a spread between people.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..kernels.parallel import in_order
from ..observer.observer import Norm
from ..observer.people import People
from ..sensation.parameters import latin, observer_at, observer_parameters
from .population import ReceptorTemperatures, Scores, score
from .task import USUAL, Task

PEOPLE, FEWEST, PRESENTED = 24, 12, 768
"""Asked again are the first 24 people; of larger sets fewer, but at least 12, so that about 768 icons are felt."""
EVERY = 8
"""Draws are judged at 12.5 Hz: it moves the scores of shipped icons by less than 0.001, and what it does cancels."""
MANY = 32
"""Larger sets are judged at half of these instants: it moves the ends of an interval by less than 0.002."""
SAMPLES, LEAST, NAMED = 512, 128, 8192
"""Presentations of an icon to a person: fewer, but at least 128, where more icons make up for it."""
DRAWS = 128
"""The ends of the interval scatter by one to two points of per cent correct from seed to seed."""
COVER = (2.5, 97.5)

Interval = tuple[float, float]


@dataclass(frozen=True, slots=True)
class ParameterIntervals:
    """Intervals from parameters: proportion correct and bits of the set, detected share of every icon in file order.

    `draws` observers were drawn over `parameters`, the names of what was varied.
    """

    draws: int
    parameters: tuple[str, ...]
    proportion_correct: Interval
    information_bits: Interval
    detected: tuple[Interval, ...]

    def __repr__(self) -> str:
        (low, high), (least, most) = self.proportion_correct, self.information_bits
        return (
            f"ParameterIntervals({self.draws} draws of {len(self.parameters)} parameters: "
            f"{100 * low:.1f}–{100 * high:.1f} % correct, {least:.2f}–{most:.2f} bits)"
        )


def parameter_intervals(
    thin: ReceptorTemperatures,
    crowd: People,
    predicted: Scores,
    norm: Norm,
    *,
    draws: int = DRAWS,
    seed: int = 0,
    task: Task = USUAL,
    step: Callable[[], None] | None = None,
) -> ParameterIntervals:
    """Intervals about `predicted`, from `draws` observers; `step` is called after each.

    `thin` is what the first PEOPLE of the crowd went through, at every EVERY-th instant: they are asked again.
    Raises `ValueError` for fewer than two draws, which have no interval.
    """
    if draws < 2:
        raise ValueError(f"an interval needs at least two draws of the parameters, not {draws}")
    free = observer_parameters(norm, thin.site)
    icons = predicted.detected.size
    thin = thin.thinned(people_for_intervals(icons), 1 if icons <= MANY else 2)
    few = crowd.part(0, len(thin.cold_C))
    samples = min(SAMPLES, max(LEAST, NAMED // icons))
    centre = score(thin, few, observer_at({}), norm, seed, samples, task)

    def drawn(shares: Array) -> Scores:
        person = observer_at({p.name: p.at(float(share)) for p, share in zip(free, shares, strict=True)})
        return score(thin, few, person, norm, seed, samples, task)

    moved = []
    for found in in_order(drawn, list(latin(len(free), draws, seed))):
        moved.append(found)
        if step is not None:
            step()

    def about(value: float, each: Array, middle: float, most: float) -> Interval:
        low, high = np.percentile(value + each - middle, COVER)
        return float(np.clip(low, 0.0, most)), float(np.clip(high, 0.0, most))

    return ParameterIntervals(
        draws=draws,
        parameters=tuple(parameter.name for parameter in free),
        proportion_correct=about(
            float(predicted.proportion_correct.mean()),
            np.array([m.proportion_correct.mean() for m in moved]),
            float(centre.proportion_correct.mean()),
            1.0,
        ),
        information_bits=about(
            float(predicted.information_bits.mean()),
            np.array([m.information_bits.mean() for m in moved]),
            float(centre.information_bits.mean()),
            math.log2(icons),
        ),
        detected=tuple(
            about(
                float(predicted.detected[k]),
                np.array([m.detected[k] for m in moved]),
                float(centre.detected[k]),
                1.0,
            )
            for k in range(icons)
        ),
    )


def people_for_intervals(icons: int) -> int:
    """How many people, at most, judge a set of so many icons with every observer.

    >>> people_for_intervals(6), people_for_intervals(64)
    (24, 12)
    """
    return min(PEOPLE, max(FEWEST, PRESENTED // icons))
