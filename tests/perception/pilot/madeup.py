"""Measurements of made-up laboratories, whose truth is known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from thermicon.circuit import Rig
from thermicon.perception.experiments.measure import ADAPTIVE, Condition, Setting, logs_of
from thermicon.perception.observer.channels import CHANNELS
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.pilot.measurement_likelihood import measuring
from thermicon.perception.pilot.measurements_file import Measurements
from thermicon.perception.pilot.playing import made_up_laboratory
from thermicon.perception.pilot.states import OFFSETS, SEEDS, LaboratoryPrior

CROWD = 256
"""People of a made-up laboratory, of whom participants are drawn."""
USUAL = tuple(
    [Condition("threshold", "limits", channel, 32.0, 12.0, 1.0, 0.0) for channel in CHANNELS]
    + [Condition("reaction_time", "choice", channel, 32.0, 6.0, 5.0, 0.0) for channel in CHANNELS]
)


def synthetic_measurements(
    rig: Rig,
    *,
    participants: int = 8,
    trials: int = 10,
    seed: int = 0,
    conditions: Sequence[Condition] = USUAL,
    numb: float = 1.0,
) -> Measurements:
    """Measurements in a made-up laboratory; `numb` is a factor of all its thresholds."""
    prior = LaboratoryPrior(PosteriorDraws.load(), "episodes")
    row = prior.values(made_up_laboratory(prior, seed))[0]
    for offset in OFFSETS:
        row[prior.names.index(offset)] -= np.log(numb)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 33]))
    return measurements_of(prior, row, Setting.of(rig), conditions, participants, trials, rng)


def measurements_of(
    prior: LaboratoryPrior,
    row: NDArray[np.float64],
    setting: Setting,
    conditions: Sequence[Condition],
    participants: int,
    trials: int,
    rng: np.random.Generator,
) -> Measurements:
    """Measurements in the laboratory of a row of values."""
    place = measuring(prior, row, setting, CROWD, int(rng.integers(SEEDS)))
    invited = rng.integers(CROWD, size=participants)
    values = np.empty((participants, len(conditions)))
    for k, condition in enumerate(conditions):
        logs, within = logs_of(place, setting, condition)
        # What has no trials of its own, such as a staircase, has the error that is assumed of it.
        error = within if condition.method in ADAPTIVE else within / np.sqrt(trials)
        values[:, k] = np.exp(logs[invited] + error * rng.standard_normal(participants))
    by_trial = [condition.method not in ADAPTIVE for condition in conditions]
    return Measurements(
        tuple(conditions),
        tuple(f"P{k + 1}" for k in range(participants)),
        values,
        np.full(values.shape, np.nan),
        np.where(by_trial, float(trials), np.nan) * np.ones(values.shape),
    )
