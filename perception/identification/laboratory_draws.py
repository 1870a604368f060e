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
FEW = 4
"""Number of people whom a constant changes, or not."""
SAMPLES, LEAST, NAMED = 512, 128, 8192
"""Presentations of an icon to a person: fewer, but at least 128, where more icons make up for it."""


@dataclass(frozen=True, slots=True)
class LaboratoryDraws:
    """Predictions of a set by every draw: what `sensitivity` reads and intervals are made of.

    `values` (draws, constants) belong to `names`, and `acts` (constants,) says which of them take part in how the set
    is named on its rig; `proportion_correct` and `information_bits` (draws,) are means over
    the people of a draw, `detected` and `onset_s` (draws, icons; NaN where an icon is not felt), `d_prime` (draws,
    icons, icons) their medians. `persons_correct`, `persons_bits` (draws, people) and `persons_detected` (draws,
    people), of the icon that a person detects least, are those of the people of a draw one by one.
    """

    names: tuple[str, ...]
    values: Array
    acts: NDArray[np.bool_]
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
    resampled: bool = False,
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
    resampled
        Whether each draw invites a random sample of the persons, and not all of them once.
    step
        Called after each draw.

    Raises
    ------
    ValueError
        For an observer without draws.

    """
    laboratories, count = DrawnLaboratories.of(model, norm, draws, seed), len(persons)
    invited = laboratories.invited(count) if resampled else np.tile(np.arange(count), (draws, 1))

    def one(place: int) -> tuple[Array, ...]:
        observer, people = laboratories.at(place, count)
        return scored(played(place), people, observer, norm, seed, task, invited[place])

    found = []
    for scores in in_order(one, list(range(draws))):
        found.append(scores)
        if step is not None:
            step()
    each = (np.stack([scores[k] for scores in found]) for k in range(8))
    acts = _acting(laboratories, played(0), min(count, FEW), norm, seed, task)
    return LaboratoryDraws(laboratories.names, laboratories.values, acts, *each)


def _acting(
    laboratories: DrawnLaboratories, played: ReceptorTemperatures, count: int, norm: Norm, seed: int, task: Task
) -> NDArray[np.bool_]:
    """Whether each constant (constants,) changes what a few people remember or say if it alone is another draw's.

    Of the first draw, each constant in turn takes the value that lies farthest from its own.
    """
    few, values = played.thinned(count, 1), laboratories.values

    def named(constants: Array) -> Array:
        observer, people = laboratories.with_values(constants, count)
        felt = respond(few, people, observer, detection=False)
        d_prime, confusion = identify(felt, norm, people, observer, seed, LEAST, task=task)
        return np.stack([d_prime, confusion.probability])

    def acts(k: int) -> bool:
        moved, column = values[0].copy(), values[:, k]
        moved[k] = column[np.abs(column - moved[k]).argmax()]
        return not np.array_equal(named(moved), usual)

    usual = named(values[0])
    return np.array(list(in_order(acts, range(values.shape[1]))))


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
    felt = respond(few, people, observer, times=True)
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
