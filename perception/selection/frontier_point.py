"""One choice of a frontier, and how it is judged: by people who know it alone, and by a goal."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..identification.laboratory import Nominal, new_laboratory
from ..identification.measures import information_bits, proportion_correct
from ..observer.observer import Norm
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from ..ranking.batches import PooledResult
from .goal import Goal
from .goal_result import GoalResult, judge_goal
from .outcome import SetOutcome
from .pick import SubsetChoice
from .request import UsableIcons

REACHED_BY = 0.95
"""Share of people who reach what a choice is also judged by."""


@dataclass(frozen=True, slots=True)
class FrontierPoint:
    """The best choice of one size.

    Attributes
    ----------
    icons
        Names of the chosen.
    proportion_correct, low
        Mean over people, and what 95 % of them reach at the nominal constants, 0–1.
    low_with_model
        What 95 % of people reach, people and uncertainty of the model together, as in a goal, 0–1; None without draws.
    information_bits
        Information, bits.
    d_prime
        Median d′ of the worst pair.
    total_s, total_J
        Time and energy of all of them; NaN on a thermode, which states no energy.
    optimal
        Whether no other choice of the size is better by the objective.
    amber
        Names of the chosen that pass a soft limit of safety.
    goal
        The goal judged for the choice; None without one.
    """

    icons: tuple[str, ...]
    proportion_correct: float
    low: float
    information_bits: float
    d_prime: float
    total_s: float
    total_J: float
    optimal: bool
    low_with_model: float | None = None
    amber: tuple[str, ...] = ()
    goal: GoalResult | None = None

    @property
    def reached(self) -> float:
        """What 95 % of people reach: with the uncertainty of the model, where there are draws of it."""
        return self.low if self.low_with_model is None else self.low_with_model

    def __repr__(self) -> str:
        return (
            f"FrontierPoint({len(self.icons)} icons: {100 * self.proportion_correct:.0f} % correct, {self.total_s:g} s)"
        )


@dataclass(frozen=True, slots=True)
class PointJudge:
    """Scores of a choice by people who know it alone.

    `named` returns the confusions (people, n, n) of icons at some places of the pool.
    """

    pooled: PooledResult
    crowd: People
    pool: UsableIcons
    names: Sequence[str]
    amber: set[str]
    norm: Norm
    model: ObserverModel
    draws: int
    seed: int
    goal: Goal | None
    named: Callable[[Sequence[int]], Array]

    def point(self, picked: SubsetChoice) -> FrontierPoint:
        """The choice with its scores, and the goal judged for it."""
        places, pooled, pool = list(picked.chosen), self.pooled, self.pool
        own = pooled.d_prime[:, places][:, :, places]
        named = self.named(places)
        each, middle = proportion_correct(named), np.median(own, axis=0)
        first, second = np.triu_indices(len(places), 1)
        at = int(middle[first, second].argmin())
        names = tuple(self.names[k] for k in places)
        nearest = names[first[at]], names[second[at]]
        correct, bits = float(each.mean()), float(information_bits(named).mean())
        detected, onset_s = pooled.detected[places], pooled.detection.onset_s[places]
        persons: dict[str, Array] = {}
        if self.draws:
            predicted = Nominal(correct, bits, detected, middle, onset_s)
            persons = new_laboratory(
                pooled.thin.of(places), self.crowd, predicted, self.norm, model=self.model, draws=self.draws,
                seed=self.seed,
            ).persons  # fmt: skip
        amber = tuple(name for name in names if name in self.amber)
        outcome = SetOutcome(
            names=names,
            correct=correct,
            bits=bits,
            d_prime=float(middle[first, second].min()),
            detected=detected,
            onset_s=onset_s,
            durations_s=pool.durations_s[places],
            energies_J=pool.energies_J[places],
            worst_pair=nearest,
            nearest_pair=nearest,
            amber=amber,
            red=(),
            persons=persons,
        )
        return FrontierPoint(
            icons=names,
            proportion_correct=correct,
            low=float(np.quantile(each, 1.0 - REACHED_BY)),
            information_bits=bits,
            d_prime=outcome.d_prime,
            total_s=math.fsum(outcome.durations_s),
            total_J=math.fsum(outcome.energies_J),
            optimal=picked.optimal,
            low_with_model=float(np.quantile(persons["correct"], 1.0 - REACHED_BY)) if persons else None,
            amber=amber,
            goal=None if self.goal is None else judge_goal(self.goal, outcome),
        )
