"""What a new laboratory will find: a prediction repeated with draws from the posterior, people and laboratory included.

Every draw is one consistent set of constants. It brings its own spread between people, an offset of the laboratory
drawn from the spread between laboratories, and memory drawn from its intervals, which no posterior knows of; the same
few people are invited in a random sample of their number. Depths of receptors stay those of the rig.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..kernels.parallel import in_order
from ..observer.channels import Norm
from ..observer.draws import PosteriorDraws
from ..observer.observer import Observer
from ..observer.people import People, draw_people
from ..sensation.memory_parameters import memory_parameters, with_memory
from ..sensation.parameters import latin
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
DRAWS = 128
"""The ends of the interval scatter by one to two points of per cent correct from seed to seed."""
COVER = (2.5, 97.5)

Interval = tuple[float, float]


@dataclass(frozen=True, slots=True)
class LaboratoryDraws:
    """Predictions of a set by every draw: what `sensitivity` reads and intervals are made of.

    `values` (draws, constants) belong to `names`; `proportion_correct` and `information_bits` (draws,) are means over
    the people of a draw, `detected` (draws, icons), `d_prime` (draws, icons, icons) their medians.
    """

    names: tuple[str, ...]
    values: Array
    proportion_correct: Array
    information_bits: Array
    detected: Array
    d_prime: Array

    def __len__(self) -> int:
        return int(self.proportion_correct.size)


@dataclass(frozen=True, slots=True)
class NewLaboratory:
    """95 % intervals of what a new laboratory will find: people, constants and laboratory together.

    Proportion correct and bits of the set, as the mean over `people` invited, detected share of every icon in file
    order, and d′ of every pair (icons, icons), lower and upper.
    """

    draws: int
    people: int
    posterior: str
    proportion_correct: Interval
    information_bits: Interval
    detected: tuple[Interval, ...]
    d_prime: tuple[Array, Array]
    each: LaboratoryDraws

    def pair(self, i: int, j: int) -> Interval:
        """Interval of the d′ of one pair."""
        return float(self.d_prime[0][i, j]), float(self.d_prime[1][i, j])

    def __repr__(self) -> str:
        (low, high), (least, most) = self.proportion_correct, self.information_bits
        return (
            f"NewLaboratory({self.draws} draws, {self.people} people each: "
            f"{100 * low:.1f}–{100 * high:.1f} % correct, {least:.2f}–{most:.2f} bits)"
        )


@dataclass(frozen=True, slots=True)
class Nominal:
    """What intervals are laid about: the prediction for many people at the nominal constants."""

    proportion_correct: float
    information_bits: float
    detected: Array
    d_prime: Array


def new_laboratory(
    thin: ReceptorTemperatures,
    crowd: People,
    predicted: Nominal,
    norm: Norm,
    *,
    posterior: PosteriorDraws | None = None,
    draws: int = DRAWS,
    seed: int = 0,
    task: Task = USUAL,
    step: Callable[[], None] | None = None,
) -> NewLaboratory:
    """Intervals about `predicted`, from `draws` sets of constants; `step` is called after each.

    Parameters
    ----------
    thin
        Temperatures of the first PEOPLE of the crowd at every EVERY-th instant.
    crowd
        The people of the prediction.
    predicted
        The prediction; each draw adds what it changes against the nominal observer on the same people and noise.
    norm, task, seed
        As in `rank`.
    posterior
        Draws of the constants (None: the shipped ones).
    draws
        How many of them, evenly spaced.
    step
        Called after each draw.

    Raises
    ------
    ValueError
        For fewer than two draws, which have no interval.

    """
    if draws < 2:
        raise ValueError(f"an interval needs at least two draws of the constants, not {draws}")
    held = PosteriorDraws.load() if posterior is None else posterior
    icons = predicted.detected.size
    few = thin.thinned(people_for_intervals(icons), 1 if icons <= MANY else 2)
    persons = crowd.part(0, len(few.cold_C))
    samples = min(SAMPLES, max(LEAST, NAMED // icons))
    chosen = np.linspace(0, len(held) - 1, draws).round().astype(np.int64)
    offsets, memory = held.new_laboratory(seed), memory_parameters(norm)
    shares = latin(len(memory), draws, seed)
    chance = np.random.default_rng(np.random.SeedSequence([seed, 9]))
    invited = chance.integers(len(persons), size=(draws, len(persons)))
    # Means over all the people of the nominal observer: their sample belongs to the draw.
    centre = _scored(few, persons, Observer.load(), norm, seed, samples, task, np.arange(len(persons)))

    def one(place: int) -> tuple[Array, ...]:
        k = int(chosen[place])
        moved = {p.name: p.at(float(share)) for p, share in zip(memory, shares[place], strict=True)}
        observer = with_memory(held.observer(k), moved, norm)
        people = draw_people(len(persons), seed, spreads=held.draw(k)).less_sensitive(*(-offsets[k]))
        return _scored(few, people, observer, norm, seed, samples, task, invited[place])

    found = []
    for scores in in_order(one, list(range(draws))):
        found.append(scores)
        if step is not None:
            step()
    about = (predicted.proportion_correct, predicted.information_bits, predicted.detected, predicted.d_prime)
    most = (1.0, math.log2(icons), 1.0, math.inf)
    correct, bits, detected, apart = (
        np.clip(np.stack([scores[k] for scores in found]) + about[k] - centre[k], 0.0, most[k]) for k in range(4)
    )
    names = (*held.names, *(parameter.name for parameter in memory), "laboratory, cold", "laboratory, warm")
    moved = np.array([[p.at(float(s)) for p, s in zip(memory, row, strict=True)] for row in shares]).reshape(draws, -1)
    values = np.hstack([held.draws[chosen], moved, offsets[chosen]])
    each = LaboratoryDraws(names, values, correct, bits, detected, apart)
    low, high = np.percentile(apart, COVER, axis=0)
    return NewLaboratory(
        draws=draws,
        people=len(persons),
        posterior=held.header.status,
        proportion_correct=_ends(correct),
        information_bits=_ends(bits),
        detected=tuple(_ends(detected[:, icon]) for icon in range(icons)),
        d_prime=(low, high),
        each=each,
    )


def _scored(
    few: ReceptorTemperatures,
    people: People,
    observer: Observer,
    norm: Norm,
    seed: int,
    samples: int,
    task: Task,
    invited: NDArray[np.int64],
) -> tuple[Array, ...]:
    """Proportion correct, bits, detected (icons,) and d′ (icons, icons) of those who are invited."""
    felt = respond(few, people, observer, [norm])
    d_prime, confusion = identify(felt, norm, people, observer, seed, samples, task=task)
    correct, bits = proportion_correct(confusion.probability), information_bits(confusion.probability)
    return (
        correct[invited].mean(),
        bits[invited].mean(),
        felt.probability[invited].mean(axis=0),
        np.median(d_prime[invited], axis=0),
    )


def _ends(values: Array) -> Interval:
    low, high = np.percentile(values, COVER)
    return float(low), float(high)


def people_for_intervals(icons: int) -> int:
    """Largest number of people who judge a set of this size with every draw.

    >>> people_for_intervals(6), people_for_intervals(64)
    (24, 12)
    """
    return min(PEOPLE, max(FEWEST, PRESENTED // icons))
