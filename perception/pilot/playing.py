"""Naming of a set's icons by the people of many laboratories."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig
from thermicon.icons import IconSet

from ..identification.confusion import few_named, normalised
from ..identification.depths import rungs
from ..identification.laboratory_draws import EVERY, people_for_intervals
from ..identification.measures import felt_and_named, information_bits
from ..identification.pairs import pair_log_odds
from ..identification.population import RATE_HZ, ReceptorTemperatures, identify, respond, run_end_s
from ..kernels.parallel import in_order
from ..observer.channels import MEMORY_FORMS
from ..observer.people import draw_people
from .states import Laboratories, LaboratoryPrior

SAMPLES = 256
"""Presentations of an icon to a person with *episodes*: a cell of one person has a standard error of at most 0.03."""
LEAST_PROBABILITY = 1e-4
"""No answer is less likely than this, whatever the lapses of a person: one odd answer must not rule out a draw."""
MOST_CELLS = 30_000_000
"""Cells of all confusions together, eight bytes each and several copies: of larger sets fewer laboratories are
simulated."""
MOST_ICONS = 64
"""More names than this nobody learns for an experiment."""


@dataclass(frozen=True, slots=True)
class Confusions:
    """Confusions `probability` (laboratories, people, icons, icons) of announced icons; rows add up to 1.

    `reported` (laboratories, people, icons) is the probability of a report by the same people, where nothing announces.
    `spread` (laboratories,) is that of their pairs: SD of the ln odds of each.
    """

    icons: tuple[str, ...]
    probability: Array
    reported: Array
    spread: Array = field(default_factory=lambda: np.zeros(1))

    def __post_init__(self) -> None:
        object.__setattr__(self, "spread", np.broadcast_to(self.spread, len(self.probability)))

    @property
    def felt_and_named(self) -> Array:
        """Share felt and named of every laboratory: of each person and icon, before the mean over them."""
        each = felt_and_named(self.reported, self.probability)
        return np.asarray(each.mean(axis=(1, 2)))

    @property
    def correct(self) -> Array:
        """Proportion named of every laboratory, as the mean over its people."""
        each: Array = np.trace(self.probability, axis1=2, axis2=3) / len(self.icons)
        return np.asarray(each.mean(axis=1))

    @property
    def bits(self) -> Array:
        """Information of every laboratory, as the mean over its people."""
        return np.array([float(information_bits(each).mean()) for each in self.probability])

    @property
    def pooled(self) -> Array:
        """Mean over people (laboratories, icons, icons)."""
        return np.asarray(self.probability.mean(axis=1))

    def of(self, which: NDArray[np.int64]) -> Confusions:
        """Those of some laboratories."""
        return Confusions(self.icons, self.probability[which], self.reported[which], self.spread[which])

    def joined(self, other: Confusions) -> Confusions:
        """These and those of further laboratories."""
        both = ((getattr(self, name), getattr(other, name)) for name in ("probability", "reported", "spread"))
        return Confusions(self.icons, *map(np.concatenate, both))

    def with_scores(self, scores: Array) -> Confusions:
        """The same with pairs of scores (laboratories, icons, icons) in units of each laboratory's spread."""
        return self.with_log_odds(pair_log_odds(self.spread[:, None, None], scores))

    def without_scores(self, scores: Array) -> Confusions:
        """The same as before pairs of these scores were in it."""
        return self.with_log_odds(-pair_log_odds(self.spread[:, None, None], scores))

    def with_log_odds(self, log_odds: Array) -> Confusions:
        """The same with other odds of each answer (laboratories, icons, icons), for all people of a laboratory."""
        return replace(self, probability=normalised(self.probability * np.exp(log_odds[:, None])))


@dataclass(frozen=True, slots=True)
class Stage:
    """A set played to the skins of some people; `confusions` then asks people of any laboratory, by its constants."""

    icons: tuple[str, ...]
    played: ReceptorTemperatures
    prior: LaboratoryPrior
    skins: tuple[Array, Array]

    def confusions(self, some: Laboratories, step: Callable[[], None] | None = None) -> Confusions:
        """What the people of each laboratory feel, and call the icons; `step` is called after each."""
        values, prior, trials = self.prior.values(some), self.prior, few_named(len(self.icons))

        def one(k: int) -> tuple[Array, Array, float]:
            observer, offsets = prior.observer_of(values[k])
            people = draw_people(self.played.people, int(some.seed[k]), observer=observer, offsets=offsets)
            people = replace(people, contact_resistance=self.skins[0], outer_layer=self.skins[1])
            felt = respond(self.played, people, observer)
            form = MEMORY_FORMS[int(some.form[k])]
            samples = trials if form == "naming" else SAMPLES
            named = identify(felt, form, people, observer, int(some.seed[k]), samples).probability
            if form == "naming":
                named = without_chance(named, samples)
            reported = felt.detected.probability.clip(LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY)
            return normalised(np.maximum(named, LEAST_PROBABILITY)), reported, observer.pair_spread

        reported = np.empty((len(some), self.played.people, len(self.icons)))
        found, spread = np.empty((*reported.shape, len(self.icons))), np.empty(len(some))
        for k, each in enumerate(in_order(one, range(len(some)))):
            found[k], reported[k], spread[k] = each
            if step is not None:
                step()
        return Confusions(self.icons, found, reported, spread)


def without_chance(named: Array, trials: int) -> Array:
    """Confusions (people, icons, icons) of so many trials of an icon, with people as far apart as without chance.

    They are drawn towards their mean until they differ by what counts do not explain.
    """
    mean = named.mean(axis=0)
    apart = float(np.square(named - mean).sum()) / (len(named) - 1)
    chance = float((named * (1.0 - named)).sum()) / (trials - 1) / len(named)
    return np.asarray(mean + math.sqrt(max(1.0 - chance / apart, 0.0) if apart > 0.0 else 0.0) * (named - mean))


def stage(icons: IconSet, rig: Rig, prior: LaboratoryPrior, *, seed: int = 0, tracking: str | None = None) -> Stage:
    """Play a set of 2 to 64 icons to as many people as intervals need, each on skin and contact of their own."""
    from thermicon.circuit.solver.simulate import duration_s

    members = list(icons)
    if not 2 <= len(members) <= MOST_ICONS:
        raise ValueError(
            f"an identification experiment needs 2 to {MOST_ICONS} icons, not {len(members)}: put the icons that were "
            "presented into a set of their own"
        )
    crowd = draw_people(people_for_intervals(len(members)), seed)
    end = run_end_s(duration_s(icon, rig) for icon in members)
    depths_m = rungs(map(prior.draws.observer, range(len(prior.draws))), crowd.corneum_m(rig))
    played = ReceptorTemperatures.at_depths(members, crowd, rig, depths_m, end, RATE_HZ / EVERY, tracking)
    return Stage(played.names, played, prior, (crowd.contact_resistance, crowd.outer_layer))


def laboratories_for(icons: int, wanted: int) -> int:
    """How many of the wanted laboratories fit into memory for a set of this size."""
    return min(wanted, MOST_CELLS // (people_for_intervals(icons) * icons**2))
