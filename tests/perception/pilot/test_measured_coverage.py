"""Judged on made-up laboratories: what measurements of a few participants say of a set, and of other people."""

from __future__ import annotations

import numpy as np
import pytest

from tests.weights import weighted_quantile
from thermicon.circuit import Rig
from thermicon.circuit.cores import quiet_blas
from thermicon.icons import read_cue
from thermicon.perception.experiments.measure import Setting
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.pilot.likelihood import effective, normalised_weights
from thermicon.perception.pilot.measurement_likelihood import log_likelihood, predicted
from thermicon.perception.pilot.playing import stage
from thermicon.perception.pilot.states import SEEDS, Laboratories, LaboratoryPrior
from thermicon.perception.pilot.synthetic import USUAL, measurements_of

ENDS = (0.025, 0.975)


def judged(laboratories: int, truths: int, participants: int) -> dict[str, float]:
    """Coverage of the set and of the mean limits, and by how much their intervals narrow (medians)."""
    rig, rng = Rig.load("thenar"), np.random.default_rng(9)
    prior = LaboratoryPrior(PosteriorDraws.load(), "episodes")
    some, every = prior.first(laboratories, 1), prior.first(laboratories, 77)
    own = rng.choice(laboratories, truths, replace=False)
    true = Laboratories(every.of(own).place, rng.integers(SEEDS, size=truths))
    setting, values = Setting.of(rig), prior.values(true)
    each, other = (predicted(prior, which, setting, USUAL) for which in (some, true))
    icons = stage(read_cue("six-icons"), rig, prior)
    fresh = Laboratories(some.place, rng.integers(SEEDS, size=laboratories))
    guess, truth = icons.confusions(fresh).correct, icons.confusions(true).correct
    rows = []
    with quiet_blas():
        for k in range(truths):
            found = measurements_of(prior, values[k], setting, USUAL, participants, 10, rng)
            logs = log_likelihood(found, each)
            logs[own[k]] = -np.inf  # the draw that the laboratory was made from
            weights = normalised_weights(logs)
            row = [effective(weights)]
            for predictions, real in ((guess, truth[k]), (each.mean[:, 0], other.mean[k, 0])):
                low, high = weighted_quantile(predictions, weights, ENDS)
                first, last = np.quantile(predictions, ENDS)
                row += [float(low <= real <= high), float((last - first) / (high - low))]
            rows.append(row)
    means, middle = np.mean(rows, axis=0), np.median(rows, axis=0)
    return {
        "effective": float(middle[0]),
        "set": float(means[1]),
        "set narrower": float(middle[2]),
        "limits": float(means[3]),
        "limits narrower": float(middle[4]),
    }


@pytest.mark.slow
def test_intervals_cover_two_hundred_laboratories_of_measurements() -> None:
    found = judged(1000, 200, 4)
    assert found["effective"] > 40.0
    assert 0.90 <= found["set"] <= 0.995
    assert 0.90 <= found["limits"] <= 0.995
    assert 1.15 <= found["limits narrower"] <= 1.35  # docs/how-to/your-pilot.md says 1.24
    assert 1.03 <= found["set narrower"] <= 1.16  # and 1.09
