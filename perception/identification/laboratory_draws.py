"""A set as every draw of the posterior predicts it: draws with their own people, laboratory and memory.

Every draw is one consistent set of constants. It brings its own spread between people, an offset of the laboratory
drawn from the spread between laboratories, and memory: its own, where the draws are those of one laboratory, otherwise
drawn from its intervals, which no published posterior knows of. Depths of receptors stay those of the rig.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..kernels.parallel import in_order
from ..observer.channels import Norm
from ..observer.observer import Observer
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from ..sensation.detection import pooled
from .drawn_laboratories import DrawnLaboratories
from .measures import information_bits, proportion_correct
from .population import ReceptorTemperatures, identify, respond
from .task import USUAL, Task

PEOPLE, FEWEST, PRESENTED = 24, 12, 768
"""Number of people: 24, of larger sets fewer, but at least 12, so that about 768 icons are judged."""
EVERY = 8
"""Draws are judged at 12.5 Hz: this changes the scores of shipped icons by less than 0.001, and the change cancels."""
MANY = 32
"""Larger sets are judged at half of these instants: this changes the ends of an interval by less than 0.002."""
SAMPLES, LEAST, NAMED = 512, 128, 8192
"""Presentations of an icon to a person: fewer, but at least 128, where more icons make up for it."""


@dataclass(frozen=True, slots=True)
class LaboratoryDraws:
    """Predictions of a set by every draw: what `sensitivity` reads and intervals are made of.

    `values` (draws, constants) belong to `names`; `proportion_correct` and `information_bits` (draws,) are means over
    the people of a draw, `detected` and `onset_s` (draws, icons; NaN where an icon is not felt), `d_prime` (draws,
    icons, icons) their medians. `persons_correct`, `persons_bits` (draws, people) and `persons_detected` (draws,
    people), of the icon that a person detects least, are those of the people of a draw one by one.
    """

    names: tuple[str, ...]
    values: Array
    proportion_correct: Array
    information_bits: Array
    detected: Array
    d_prime: Array
    onset_s: Array
    persons_correct: Array
    persons_bits: Array
    persons_detected: Array

    def __len__(self) -> int:
        return int(self.proportion_correct.size)


def laboratory_draws(
    played: Callable[[int], ReceptorTemperatures],
    persons: People,
    norm: Norm,
    model: ObserverModel,
    *,
    draws: int,
    seed: int = 0,
    task: Task = USUAL,
    invited: NDArray[np.int64] | None = None,
    step: Callable[[], None] | None = None,
) -> LaboratoryDraws:
    """Predictions by `draws` draws, evenly spaced; the same arguments give the same numbers.

    Parameters
    ----------
    played
        What the receptors of the persons go through in a draw, by its number.
    persons
        The people, of whom every draw has its own with the same seed.
    norm, task, seed
        As in `rank`.
    model
        The observer, which needs draws.
    draws
        How many.
    invited
        Places (draws, n) of the persons whom each draw invites; None: all of them, once.
    step
        Called after each draw.

    Raises
    ------
    ValueError
        For an observer without draws.

    """
    laboratories, count = DrawnLaboratories.of(model, norm, draws, seed), len(persons)
    everyone = np.arange(count)

    def one(place: int) -> tuple[Array, ...]:
        observer, people = laboratories.at(place, count)
        return scored(
            played(place), people, observer, norm, seed, task, everyone if invited is None else invited[place]
        )

    found = []
    for scores in in_order(one, list(range(draws))):
        found.append(scores)
        if step is not None:
            step()
    each = (np.stack([scores[k] for scores in found]) for k in range(8))
    return LaboratoryDraws(laboratories.names, laboratories.values, *each)


def scored(
    few: ReceptorTemperatures,
    people: People,
    observer: Observer,
    norm: Norm,
    seed: int,
    task: Task,
    invited: NDArray[np.int64],
) -> tuple[Array, ...]:
    """Proportion correct, bits, detected (icons,), d′ (icons, icons), onset (icons,) of those who are invited; and

    correct, bits and least detection (people,) of each of them.
    """
    samples = min(SAMPLES, max(LEAST, NAMED // few.cold_C.shape[1]))
    felt = respond(few, people, observer, [norm], times=True)
    d_prime, confusion = identify(felt, norm, people, observer, seed, samples, task=task)
    correct, bits = proportion_correct(confusion.probability), information_bits(confusion.probability)
    found = felt.detected
    reported = found.reported_sum() if found.reported is None else found.reported[invited].sum(axis=0)
    reports = pooled(felt.probability[invited], found.cold_share[invited], reported, found.dt_s)
    return (
        correct[invited].mean(),
        bits[invited].mean(),
        reports.probability,
        np.median(d_prime[invited], axis=0),
        reports.onset_s,
        correct[invited],
        bits[invited],
        felt.probability[invited].min(axis=1),
    )


def people_for_intervals(icons: int) -> int:
    """Largest number of people who judge a set of this size with every draw.

    >>> people_for_intervals(6), people_for_intervals(64)
    (24, 12)
    """
    return min(PEOPLE, max(FEWEST, PRESENTED // icons))
