"""Judged on people who were left out: made-up laboratories, the next set predicted from a pilot with another one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.weights import weighted_quantile
from thermicon.circuit import Rig
from thermicon.circuit.cores import quiet_blas
from thermicon.icons import read_cue
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.pilot.conditioning import LEAST_EFFECTIVE, LEAST_SHARE
from thermicon.perception.pilot.likelihood import (
    PooledLikelihood,
    effective,
    log_likelihoods,
    normalised_weights,
)
from thermicon.perception.pilot.playing import Confusions, stage
from thermicon.perception.pilot.states import SEEDS, Laboratories, LaboratoryPrior
from thermicon.perception.pilot.synthetic import answers_of, spread

ENDS = (0.025, 0.975)


@dataclass(frozen=True)
class Bench:
    """Laboratories to predict with, and others to predict: their participants, and their people who were left out."""

    answered: Confusions
    predicted: tuple[Confusions, Confusions]
    participants: Confusions
    left_out: tuple[Confusions, Confusions]
    own: NDArray[np.int64]
    place: NDArray[np.float64]

    def judged(self, participants: int, trials: int, seed: int) -> dict[str, float]:
        """Coverage of both sets, and the median factor by which the interval of the first narrowed."""
        rng, rows = np.random.default_rng(seed), []
        for k in range(len(self.own)):
            place = np.array([k])
            presented = np.stack([spread(trials, 6, rng) for _ in range(participants)])
            invited = rng.integers(self.participants.probability.shape[1], size=participants)
            counts = answers_of(self.participants.of(place), invited, presented, rng)
            logs = log_likelihoods(self.answered.probability, counts).sum(axis=1)
            logs[self.own[k]] = -np.inf  # the draw that the laboratory was made from
            weights = normalised_weights(logs)
            row = [effective(weights)]
            if row[0] < min(LEAST_EFFECTIVE, LEAST_SHARE * len(weights)):  # as `condition` does, without fresh ones
                logs = PooledLikelihood.fit(self.place, self.answered, counts)(self.place)
                logs[self.own[k]] = -np.inf
                weights = normalised_weights(logs)
            for guess, truth in zip(self.predicted, self.left_out, strict=True):
                low, high = weighted_quantile(guess.correct, weights, ENDS)
                first, last = np.quantile(guess.correct, ENDS)
                row += [low <= truth.correct[k] <= high, (last - first) / (high - low)]
            rows.append(row)
        each = np.array(rows)
        return {
            "effective": float(np.median(each[:, 0])),
            "set": float(each[:, 1].mean()),
            "narrower": float(np.median(each[:, 2])),
            "next set": float(each[:, 3].mean()),
        }


def bench(laboratories: int, truths: int, other: str) -> Bench:
    rig, rng = Rig.load("thenar"), np.random.default_rng(8)
    prior = LaboratoryPrior(PosteriorDraws.load(), "episodes")
    first, second = (stage(read_cue(name), rig, prior) for name in ("six-icons", other))
    some = prior.first(laboratories, 1)
    people = Laboratories(some.place, rng.integers(SEEDS, size=laboratories))
    every = prior.first(laboratories, 77)
    own = rng.choice(laboratories, truths, replace=False)
    true = every.of(own)
    left = Laboratories(true.place, rng.integers(SEEDS, size=truths))
    return Bench(
        first.confusions(some),
        (first.confusions(people), second.confusions(people)),
        first.confusions(true),
        (first.confusions(left), second.confusions(left)),
        own,
        some.place,
    )


@pytest.mark.slow
def test_a_pilot_of_a_few_people_narrows_and_still_covers() -> None:
    pilot = bench(150, 50, "six-icons").judged(3, 20, 3)
    assert pilot["narrower"] > 1.05
    assert pilot["set"] >= 0.86
    assert pilot["effective"] > 20.0


@pytest.mark.slow
def test_intervals_cover_two_hundred_laboratories_and_twenty_trials_narrow_a_little() -> None:
    many = bench(1000, 200, "pulse-sequences")
    with quiet_blas():
        found = {size: many.judged(*size, 3) for size in ((1, 20), (4, 20))}
    for each in found.values():
        assert 0.90 <= each["set"] <= 0.995
        assert 0.90 <= each["next set"] <= 0.995
    assert 1.02 <= found[1, 20]["narrower"] <= 1.12  # docs/how-to/your-pilot.md says 1.06
    assert 1.12 <= found[4, 20]["narrower"] <= 1.3
    assert found[4, 20]["effective"] > 150
