"""Answers or measurements of made-up laboratories with a known truth."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from thermicon.circuit import Rig
from thermicon.icons import IconSet
from thermicon.perception.experiments.measure import ADAPTIVE, Condition, Setting, logs_of
from thermicon.perception.observer.channels import CHANNELS, MemoryForm
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.pilot.measurement_likelihood import measuring
from thermicon.perception.pilot.measurements_file import Measurements
from thermicon.perception.pilot.playing import Confusions, stage
from thermicon.perception.pilot.states import SEEDS, Laboratories, LaboratoryPrior
from thermicon.perception.pilot.trials import Trials

CROWD = 256
"""People of a made-up laboratory, of whom participants are drawn."""
USUAL = tuple(
    [Condition("threshold", "limits", channel, 32.0, 12.0, 1.0, 0.0) for channel in CHANNELS]
    + [Condition("reaction_time", "choice", channel, 32.0, 6.0, 5.0, 0.0) for channel in CHANNELS]
)


STREAM = 1000
"""Seeds of made-up laboratories begin here, away from those that predictions are made with."""


def synthetic_trials(
    icons: IconSet, rig: Rig, *, participants: int, trials: int, seed: int, memory: MemoryForm = "episodes"
) -> Trials:
    """Answers of people of a made-up laboratory to a set, its icons presented as evenly as possible."""
    prior = LaboratoryPrior(PosteriorDraws.load(), memory)
    played = stage(icons, rig, prior, seed=STREAM + seed).confusions(made_up_laboratory(prior, seed))
    rng = np.random.default_rng(np.random.SeedSequence([seed, 15]))
    invited = rng.integers(played.probability.shape[1], size=participants)
    counts = answers_of(played, invited, np.stack([spread(trials, len(played.icons), rng) for _ in invited]), rng)
    return Trials(played.icons, tuple(f"P{k + 1}" for k in range(participants)), counts)


def made_up_laboratory(prior: LaboratoryPrior, seed: int) -> Laboratories:
    place = np.random.default_rng(np.random.SeedSequence([seed, 16])).integers(len(prior.draws), size=1)
    return prior.first(len(prior.draws), STREAM + seed).of(place)


def spread(trials: int, icons: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Presentations (icons,) of so many trials, as even as possible; chance decides who gets the rest."""
    shown = np.full(icons, trials // icons, dtype=np.float64)
    shown[rng.permutation(icons)[: trials % icons]] += 1.0
    return shown


def answers_of(
    played: Confusions, invited: NDArray[np.int64], presented: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Answers (participants, icons, icons) of some people of the first laboratory to their presentations."""
    chances = played.probability[0, invited].astype(np.float64)
    counts = rng.multinomial(presented.astype(np.int64), chances / chances.sum(axis=-1, keepdims=True))
    return counts.astype(np.float64)


def synthetic_measurements(
    rig: Rig,
    *,
    participants: int = 8,
    trials: int = 10,
    seed: int = 0,
    conditions: Sequence[Condition] = USUAL,
) -> Measurements:
    """Measurements in a made-up laboratory."""
    prior = LaboratoryPrior(PosteriorDraws.load(), "episodes")
    row = prior.values(made_up_laboratory(prior, seed))[0]
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
