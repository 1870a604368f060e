"""Made-up laboratories whose truth is known: participants drawn from the model itself, to try an analysis on.

Their answers were not given by anybody. The laboratory is one draw of the posterior with memory, an offset and people
of its own; a seed gives the same laboratory for every set.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..observer.channels import USUAL_NORM, check_norm
from ..observer.draws import PosteriorDraws
from .playing import Confusions, stage
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
    """Answers of made-up participants to a set, its icons presented as evenly as possible; all alike for a seed."""
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
    return stage(icons, rig, prior, seed=STREAM + seed).confusions(made_up_laboratory(prior, seed))


def made_up_laboratory(prior: LaboratoryPrior, seed: int) -> Laboratories:
    """The made-up laboratory of a seed."""
    place = np.random.default_rng(np.random.SeedSequence([seed, 16])).integers(len(prior.draws), size=1)
    return prior.first(len(prior.draws), STREAM + seed).of(place)


def spread(trials: int, icons: int, rng: np.random.Generator) -> Array:
    """Presentations (icons,) of so many trials, as even as possible; chance decides who gets the rest."""
    shown = np.full(icons, trials // icons, dtype=np.float64)
    shown[rng.permutation(icons)[: trials % icons]] += 1.0
    return shown


def answers_of(played: Confusions, invited: NDArray[np.int64], presented: Array, rng: np.random.Generator) -> Array:
    """Answers (participants, icons, icons) of some people of the first laboratory to their presentations."""
    chances = played.probability[0, invited].astype(np.float64)
    counts = rng.multinomial(presented.astype(np.int64), chances / chances.sum(axis=-1, keepdims=True))
    return counts.astype(np.float64)


def trials_text(trials: Trials, seed: int = 0) -> str:
    """The answers as a CSV file that `read_trials` reads, in random order; times are not made up."""
    rng, lines = np.random.default_rng(np.random.SeedSequence([seed, 17])), ["participant,trial,presented,responded"]
    for name, counts in zip(trials.participants, trials.counts, strict=True):
        cells = [cell for cell in np.argwhere(counts > 0.0).tolist() for _ in range(int(counts[tuple(cell)]))]
        for number, k in enumerate(rng.permutation(len(cells)), 1):
            lines.append(f"{name},{number},{trials.icons[cells[k][0]]},{trials.icons[cells[k][1]]}")
    return "\n".join(lines) + "\n"
