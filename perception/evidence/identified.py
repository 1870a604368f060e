"""Icons named from memory, for every variant of the observer: confusions, and their dependence on parameters.

Six icons, and sequences of short pulses: published are the shares of the best 22 and 16 of 52 that are named correctly;
their levels, lengths, site and display are unknown, so that the sequences are this project's own, and the result is
shown and not judged.

The same chain as `rank`, on the same people; beyond it, receptors that go by heat flow, and
the laboratories of a new one's interval, whose observers stand behind the other experiments too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit import Rig

from ..arrays import Array
from ..identification.confusion import SAMPLES, normalised
from ..identification.laboratory_draws import EVERY, PEOPLE, people_for_intervals
from ..identification.laboratory_draws import SAMPLES as FEW_SAMPLES
from ..identification.measures import information_bits, plugin_bits, proportion_correct
from ..identification.population import RATE_HZ, ReceptorTemperatures, identify, respond, run_end_s
from ..kernels.parallel import in_order
from ..observer.channels import USUAL_NORM, VARIABLES, Variable, receptor_column
from ..observer.observer import DATA, Observer
from ..observer.people import People, draw_people
from ..ranking.batches import EXPERIMENTS
from ..selection.appraise import population_dprime
from ..selection.max_min_subset import max_min_subset
from .predicted import Predicted, plausible_laboratories

if TYPE_CHECKING:
    from thermicon.icons import Icon

Score = Callable[[Array], float]
"""One number from the confusions (people, icons, icons) of a crowd."""


@dataclass(frozen=True, slots=True)
class Identified:
    """Confusions of one variant: of every person, and of fewer people for the nominal observer and each laboratory."""

    variable: Variable
    labels: tuple[str, ...]
    probability: Array
    few: Array
    drawn: Array

    @property
    def pooled(self) -> Array:
        """Mean over people, rows sum to 1."""
        return normalised(self.probability.mean(axis=0))

    def predicted(
        self, experiment: str, quantity: str, unit: str, score: Score, *, conditions: str, top: float = math.inf
    ) -> Predicted:
        """A score with its interval: what each laboratory changes is added, and stays within 0 and `top`."""
        value, nominal = score(self.probability), score(self.few)
        each = tuple(float(np.clip(value + score(one) - nominal, 0.0, top)) for one in self.drawn)
        low, high = np.percentile(each, [2.5, 97.5]).tolist() if each else (None, None)
        return Predicted(experiment, quantity, "both", value, unit, low, high, self.variable, conditions, draws=each)


@dataclass(frozen=True, slots=True)
class Shown:
    """A set that was played to many people; `identify` then asks one variant of the observer."""

    labels: tuple[str, ...]
    crowd: People
    played: tuple[ReceptorTemperatures, ...]
    seed: int

    def identify(self, variable: Variable, draws: int) -> Identified:
        """Confusions of one variant from memory."""
        played = self.played[VARIABLES.index(variable)]
        few = self.crowd.part(0, people_for_intervals(len(self.labels)))
        thin = played.thinned(len(few), EVERY)
        nominal = Observer.load(variable=variable)

        def thinly(observer: Observer, people: People) -> Array:
            felt = respond(thin, people, observer, detection=False)
            return identify(felt, USUAL_NORM, people, observer, self.seed, FEW_SAMPLES)[1].probability

        felt = respond(played, self.crowd, nominal, detection=False)
        whole = identify(felt, USUAL_NORM, self.crowd, nominal, self.seed, SAMPLES)[1]
        kept = np.zeros((0, *whole.probability.shape))
        if draws:
            others = plausible_laboratories(draws, self.seed, variable)
            invited = others.invited(len(few))
            kept = np.stack(list(in_order(lambda k: thinly(*others.at(k, len(few)))[invited[k]], range(draws))))
        return Identified(variable, self.labels, whole.probability, thinly(nominal, few), kept)


def show(icons: Iterable[Icon], rig: Rig, people: int, seed: int) -> Shown:
    """Play icons to virtual people, each on their own skin and contact, as `rank` does."""
    from thermicon.circuit import simulate_many
    from thermicon.circuit.solver.simulate import duration_s

    members, crowd = list(icons), draw_people(people, seed)
    names = tuple(icon.name for icon in members)
    end = run_end_s(duration_s(icon, rig) for icon in members)
    columns = [[receptor_column(variable, channel) for channel in ("cold", "warm")] for variable in VARIABLES]
    probes = [probe for pair in columns for probe in pair]
    batch = simulate_many(members, crowd.rigs(rig), nominal=rig, end_s=end, rate_Hz=RATE_HZ, probes=probes)
    played = tuple(
        ReceptorTemperatures(batch[cold], batch[warm], batch.time_s, rig.site, rig.contact.area_m2, names)
        for cold, warm in columns
    )
    return Shown(names, crowd, played, seed)


def six_icons(found: Identified, trials: int, seed: int) -> tuple[Predicted, ...]:
    """Proportion correct, information (exact, and as the experiment would report it), each icon, spread of people."""
    said = f"named from memory, {found.probability.shape[0]} people, {USUAL_NORM}"
    most = math.log2(len(found.labels))

    def share_of_people(share: float) -> Score:
        return lambda p: float(np.percentile(proportion_correct(p), share))

    def bits(p: Array) -> float:
        return plugin_bits(p, trials, seed, EXPERIMENTS)

    asked: list[tuple[str, str, Score, float]] = [
        ("proportion correct", "proportion", lambda p: float(proportion_correct(p).mean()), 1.0),
        ("proportion correct, lower end of people", "proportion", share_of_people(2.5), 1.0),
        ("proportion correct, upper end of people", "proportion", share_of_people(97.5), 1.0),
        ("plug-in information", "bit", bits, most),
        ("information", "bit", lambda p: float(information_bits(p).mean()), most),
    ]
    asked += [(f"proportion correct, {name}", "proportion", named(k), 1.0) for k, name in enumerate(found.labels)]
    made = [
        found.predicted("six icons", name, unit, score, conditions=said, top=top) for name, unit, score, top in asked
    ]
    low, high = np.percentile(proportion_correct(found.probability), [16.0, 84.0]).tolist()
    made[0] = replace(made[0], people=(low, high))
    made[3] = replace(made[3], conditions=f"{said}; plug-in estimate of {trials} trials a person")
    return tuple(made)


@lru_cache(maxsize=64)
def named(k: int) -> Score:
    """Proportion correct of the k-th icon."""
    return lambda p: float(p[:, k, k].mean())


CUES, RIG, CHOSEN = DATA / "short-pulses.cue", "tcs2", (22, 16)


def show_pulses(people: int, seed: int) -> tuple[Shown, ...]:
    """Play the sequences of each choice to virtual people on a thermode; the nominal observer chooses, by median d′."""
    from thermicon.icons import read_cue

    icons, rig = list(read_cue(CUES)), Rig.load(RIG)
    middle = np.median(population_dprime(icons, rig, draw_people(PEOPLE, seed))[0], axis=0)
    best = [max_min_subset(middle, count) for count in CHOSEN]
    return tuple(show([icons[place] for place in one.chosen], rig, people, seed) for one in best if one is not None)


def named_pulses(each: Sequence[Identified]) -> tuple[Predicted, ...]:
    """Proportion correct of each choice."""
    return tuple(
        found.predicted(
            "short pulses", f"proportion correct of the best {len(found.labels)}", "proportion",
            lambda p: float(proportion_correct(p).mean()), top=1.0,
            conditions=f"named from memory, {found.probability.shape[0]} people, {RIG}, best by the worst pair of 52",
        )
        for found in each
    )  # fmt: skip
