"""How people of many laboratories name the icons of a set: confusions of every person of every laboratory.

In a made-up laboratory, one draw of the posterior with memory, an offset and people of its own, participants answer as
the model says: nobody gave these answers, but the truth behind them is known, to try an analysis on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..identification.laboratory_draws import EVERY, people_for_intervals
from ..identification.measures import information_bits
from ..identification.population import RATE_HZ, ReceptorTemperatures, identify, respond, run_end_s
from ..kernels.parallel import in_order
from ..observer.channels import USUAL_NORM, check_norm
from ..observer.draws import PosteriorDraws
from ..observer.people import draw_people
from .states import Laboratories, LaboratoryPrior
from .trials import Trials

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

Small = NDArray[np.float32]
SAMPLES = 256
"""Presentations of an icon to a person; a cell of one person has a standard error of at most 0.03."""
LEAST_PROBABILITY = 1e-4
"""No answer is less likely than this, whatever the lapses of a person: one odd answer must not rule out a draw."""
MOST_CELLS = 60_000_000
"""Cells of all confusions together, four bytes each; of larger sets fewer laboratories are simulated."""
MOST_ICONS = 64
"""More names than this nobody learns for an experiment."""
STREAM = 1000
"""Seeds of made-up laboratories begin here, away from those that predictions are made with."""


@dataclass(frozen=True, slots=True)
class Confusions:
    """Confusions `probability` (laboratories, people, icons, icons) in single precision, and the names of the icons."""

    icons: tuple[str, ...]
    probability: Small

    @property
    def correct(self) -> Array:
        """Proportion correct of every laboratory, as the mean over its people."""
        found: Array = self.each_correct.mean(axis=1)
        return found

    @property
    def each_correct(self) -> Array:
        """Proportion correct of every person (laboratories, people)."""
        found: Array = np.trace(self.probability, axis1=2, axis2=3, dtype=np.float64) / len(self.icons)
        return found

    @property
    def bits(self) -> Array:
        """Information of every laboratory, as the mean over its people."""
        return np.array([float(information_bits(each).mean()) for each in self.probability])

    @property
    def pooled(self) -> Array:
        """Mean over people (laboratories, icons, icons)."""
        found: Array = self.probability.mean(axis=1, dtype=np.float64)
        return found

    def of(self, which: NDArray[np.int64]) -> Confusions:
        """Those of some laboratories."""
        return replace(self, probability=self.probability[which])

    def joined(self, other: Confusions) -> Confusions:
        """These and those of further laboratories."""
        return replace(self, probability=np.concatenate([self.probability, other.probability]))


@dataclass(frozen=True, slots=True)
class Stage:
    """A set played to the skins of some people; `confusions` then asks people of any laboratory."""

    icons: tuple[str, ...]
    played: ReceptorTemperatures
    prior: LaboratoryPrior
    skins: tuple[Array, Array]

    @property
    def people(self) -> int:
        """Number of virtual people of each laboratory."""
        return len(self.played.cold_C)

    def confusions(self, some: Laboratories, step: Callable[[], None] | None = None) -> Confusions:
        """How the people of each laboratory name the icons; `step` is called after each."""
        values, prior = self.prior.values(some), self.prior

        def one(k: int) -> Small:
            observer, people = prior.observer_and_people(values[k], int(some.seed[k]), self.people)
            people = replace(people, contact_resistance=self.skins[0], outer_layer=self.skins[1])
            felt = respond(self.played, people, observer, detection=False)
            named = identify(felt, prior.norm, people, observer, int(some.seed[k]), SAMPLES)[1].probability
            return np.maximum(named, LEAST_PROBABILITY).astype(np.float32)

        found = np.empty((len(some), self.people, len(self.icons), len(self.icons)), dtype=np.float32)
        for k, each in enumerate(in_order(one, range(len(some)))):
            found[k] = each
            if step is not None:
                step()
        found /= found.sum(axis=-1, keepdims=True)
        return Confusions(self.icons, found)


def stage(icons: IconSet, rig: Rig, prior: LaboratoryPrior, *, seed: int = 0, tracking: str | None = None) -> Stage:
    """Play a set to as many people as the intervals need, each on skin and contact of their own.

    Raises ValueError for fewer than two icons and for more than 64.
    """
    from thermicon.circuit.solver.simulate import duration_s

    members = list(icons)
    if not 2 <= len(members) <= MOST_ICONS:
        raise ValueError(
            f"an identification experiment needs 2 to {MOST_ICONS} icons, not {len(members)}: put the icons that were "
            "presented into a set of their own"
        )
    crowd = draw_people(people_for_intervals(len(members)), seed)
    end = run_end_s(duration_s(icon, rig) for icon in members)
    played = ReceptorTemperatures.simulated(members, crowd.rigs(rig), rig, end, RATE_HZ / EVERY, tracking)
    return Stage(played.names, played, prior, (crowd.contact_resistance, crowd.outer_layer))


def laboratories_for(icons: int, wanted: int) -> int:
    """How many of the wanted laboratories fit into memory for a set of this size."""
    return min(wanted, MOST_CELLS // (people_for_intervals(icons) * icons**2))


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
