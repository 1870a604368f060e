"""Made-up laboratories whose truth is known: participants drawn from the model itself, to try an analysis on.

Neither their answers nor their thresholds were measured. The laboratory is one draw of the posterior with memory, an
offset and people of its own; a seed gives the same laboratory for every set.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..experiments.measure import ADAPTIVE, Condition, Setting, logs_of
from ..observer.channels import CHANNELS, USUAL_NORM, check_norm
from ..observer.draws import PosteriorDraws
from .measurement_likelihood import measuring
from .measurements import Measurements
from .playing import Confusions, stage
from .states import OFFSETS, SEEDS, Laboratories, LaboratoryPrior
from .trials import Trials

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

STREAM = 1000
"""Seeds of made-up laboratories begin here, away from those that predictions are made with."""
CROWD = 256
"""People of a made-up laboratory, of whom participants are drawn."""
USUAL = tuple(
    [Condition("threshold", "limits", channel, 32.0, 12.0, 1.0, 0.0) for channel in CHANNELS]
    + [Condition("reaction_time", "choice", channel, 32.0, 6.0, 5.0, 0.0) for channel in CHANNELS]
)
"""Limits at 1 K/s and choice reaction times to 6 K at 5 K/s."""


def synthetic_trials(
    icons: IconSet, rig: Rig, *, participants: int = 4, trials: int = 24, seed: int = 0, norm: str = USUAL_NORM
) -> Trials:
    """Answers of made-up participants to a set, its icons presented as evenly as possible.

    Parameters
    ----------
    icons, rig, norm
        As in `observed`.
    participants
        How many of the laboratory's people take part.
    trials
        Trials of each.
    seed
        Which laboratory, and all chance.

    Raises
    ------
    ValueError
        For fewer than one participant or trial.

    """
    _check(participants, trials)
    played = synthetic_laboratory(icons, rig, seed=seed, norm=norm)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 15]))
    invited = rng.integers(played.probability.shape[1], size=participants)
    counts = answers_of(played, invited, np.stack([spread(trials, len(played.icons), rng) for _ in invited]), rng)
    return Trials(played.icons, tuple(f"P{k + 1}" for k in range(participants)), counts)


def synthetic_laboratory(icons: IconSet, rig: Rig, *, seed: int = 0, norm: str = USUAL_NORM) -> Confusions:
    """Confusions of all people of one made-up laboratory: its truth."""
    prior = LaboratoryPrior(PosteriorDraws.load(), check_norm(norm))
    return stage(icons, rig, prior, seed=STREAM + seed).confusions(_made_up(prior, seed))


def _made_up(prior: LaboratoryPrior, seed: int) -> Laboratories:
    """The made-up laboratory of a seed."""
    place = np.random.default_rng(np.random.SeedSequence([seed, 16])).integers(len(prior.draws), size=1)
    return prior.first(len(prior.draws), STREAM + seed).of(place)


def _check(participants: int, trials: int) -> None:
    if participants < 1 or trials < 1:
        raise ValueError(f"at least one participant and one trial are needed, not {participants} and {trials}")


def spread(trials: int, icons: int, rng: np.random.Generator) -> Array:
    """Presentations (icons,) of so many trials, as even as possible; chance decides who gets the rest.

    >>> sorted(spread(8, 6, np.random.default_rng(0)).tolist())
    [1.0, 1.0, 1.0, 1.0, 2.0, 2.0]
    """
    shown = np.full(icons, trials // icons, dtype=np.float64)
    shown[rng.permutation(icons)[: trials % icons]] += 1.0
    return shown


def answers_of(played: Confusions, invited: NDArray[np.int64], presented: Array, rng: np.random.Generator) -> Array:
    """Answers (participants, icons, icons) of some people of the first laboratory to their presentations."""
    chances = played.probability[0, invited].astype(np.float64)
    counts = rng.multinomial(presented.astype(np.int64), chances / chances.sum(axis=-1, keepdims=True))
    return counts.astype(np.float64)


def trials_text(trials: Trials, seed: int = 0) -> str:
    """The answers as a CSV file that `read_trials` reads, in random order; times are not made up.

    >>> print(trials_text(Trials(("a", "b"), ("P1",), np.array([[[0.0, 1.0], [0.0, 0.0]]]))))
    participant,trial,presented,responded
    P1,1,a,b
    <BLANKLINE>
    """
    rng, lines = np.random.default_rng(np.random.SeedSequence([seed, 17])), ["participant,trial,presented,responded"]
    for name, counts in zip(trials.participants, trials.counts, strict=True):
        cells = [cell for cell in np.argwhere(counts > 0.0).tolist() for _ in range(int(counts[tuple(cell)]))]
        for number, k in enumerate(rng.permutation(len(cells)), 1):
            lines.append(f"{name},{number},{trials.icons[cells[k][0]]},{trials.icons[cells[k][1]]}")
    return "\n".join(lines) + "\n"


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
    _check(participants, trials)
    prior = LaboratoryPrior(PosteriorDraws.load(), check_norm(norm))
    row = prior.values(_made_up(prior, seed))[0]
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
