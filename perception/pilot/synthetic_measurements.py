"""Made-up thresholds and reaction times of a laboratory whose truth is known, to try an analysis on.

They are no measurement: the laboratory is one draw of the posterior with an offset, its participants are drawn from the
model's own people.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..observer.channels import CHANNELS, USUAL_NORM, check_norm
from ..observer.draws import PosteriorDraws
from .measurements import ADAPTIVE, Condition, Measurements
from .simulated_measurements import Setting, measuring
from .states import OFFSETS, SEEDS, LaboratoryPrior
from .synthetic import STREAM

if TYPE_CHECKING:
    from thermicon.circuit import Rig

CROWD = 256
"""People of a made-up laboratory, of whom participants are drawn."""
USUAL = tuple(
    [Condition("threshold", "limits", channel, 32.0, 12.0, 1.0, 0.0) for channel in CHANNELS]
    + [Condition("reaction_time", "choice", channel, 32.0, 6.0, 5.0, 0.0) for channel in CHANNELS]
)
"""Limits at 1 K/s and choice reaction times to 6 K at 5 K/s."""


def synthetic_measurements(
    rig: Rig,
    *,
    participants: int = 8,
    trials: int = 10,
    seed: int = 0,
    norm: str = USUAL_NORM,
    conditions: Sequence[Condition] = USUAL,
    numb: float = 1.0,
) -> Measurements:
    """Measurements in a made-up laboratory.

    Parameters
    ----------
    rig
        The rig they were measured on.
    participants, trials
        Participants, and trials of each under every condition.
    seed
        Which laboratory, and all chance.
    norm
        As in `observed`.
    conditions
        What is measured.
    numb
        Factor of all thresholds: above 1, a laboratory of numb people.

    Raises
    ------
    ValueError
        For fewer than one participant or trial.

    """
    if participants < 1 or trials < 1:
        raise ValueError(f"at least one participant and one trial are needed, not {participants} and {trials}")
    prior = LaboratoryPrior(PosteriorDraws.load(), check_norm(norm))
    every = prior.first(len(prior.draws), STREAM + seed)
    place = int(np.random.default_rng(np.random.SeedSequence([seed, 16])).integers(len(prior.draws)))
    row = prior.values(every.of(np.array([place])))[0]
    for offset in OFFSETS:
        row[prior.names.index(offset)] -= np.log(numb)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 33]))
    return measurements_of(prior, row, Setting.of(rig), conditions, participants, trials, rng)


def measurements_of(
    prior: LaboratoryPrior,
    row: Array,
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
        logs, within = place.measure(setting, condition)
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
