"""Made-up laboratories whose truth is known: participants drawn from the model itself, to try an analysis on.

Their answers are no measurement. The laboratory is one draw of the posterior with memory, an offset and people of its
own; a seed gives the same laboratory for every set.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..observer.channels import USUAL_NORM, check_norm
from ..observer.draws import PosteriorDraws
from .playing import Confusions, Stage, stage
from .states import Laboratories, LaboratoryPrior
from .trials import Trials

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

STREAM = 1000
"""Seeds of made-up laboratories begin here, away from those that predictions are made with."""


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
    if participants < 1 or trials < 1:
        raise ValueError(f"at least one participant and one trial are needed, not {participants} and {trials}")
    played = synthetic_laboratory(icons, rig, seed=seed, norm=norm)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 15]))
    invited = rng.integers(played.probability.shape[1], size=participants)
    counts = answers_of(played, invited, np.stack([spread(trials, len(played.icons), rng) for _ in invited]), rng)
    return Trials(played.icons, tuple(f"P{k + 1}" for k in range(participants)), counts)


def synthetic_laboratory(icons: IconSet, rig: Rig, *, seed: int = 0, norm: str = USUAL_NORM) -> Confusions:
    """Confusions of all people of one made-up laboratory: its truth."""
    prior = LaboratoryPrior(PosteriorDraws.load(), check_norm(norm))
    return laboratory_at(stage(icons, rig, prior, seed=STREAM + seed), prior, seed)


def laboratory_at(played: Stage, prior: LaboratoryPrior, seed: int) -> Confusions:
    """Confusions of the people of the made-up laboratory of a seed, on a set that is played."""
    place = int(np.random.default_rng(np.random.SeedSequence([seed, 16])).integers(len(prior.draws)))
    every = prior.first(len(prior.draws), STREAM + seed)
    return played.confusions(Laboratories(every.place[[place]], every.seed[[place]]))


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
