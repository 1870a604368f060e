"""Identification from memory by every variant of the observer.

Six icons, and waves that differ in shape alone, shipped as `wave-confusions`, since published ones were not available
in numbers. The same chain as `rank`, on the same people.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig
from thermicon.icons import Icon

from ..identification.confusion import SAMPLES, few_named, normalised
from ..identification.depths import rungs
from ..identification.laboratory_draws import EVERY, DrawnLaboratories, DrawnLaboratory, people_for_intervals
from ..identification.laboratory_draws import SAMPLES as FEW_SAMPLES
from ..identification.measures import information_bits, plugin_bits, proportion_correct
from ..identification.pairs import pair_scores, with_pairs
from ..identification.population import RATE_HZ, ReceptorTemperatures, identify, respond, run_end_s
from ..identification.skin_alone import confused_by_skin
from ..kernels.parallel import in_order
from ..observer.channels import CHANNELS, MEMORY_FORMS, Variable, receptor_column
from ..observer.observer import Observer
from ..observer.people import People, draw_people
from ..ranking.batches import EXPERIMENTS
from .predicted import Predicted, interval_of, plausible_laboratories

FORMS = "both forms of memory"
Score = Callable[[Array], float]
"""One number from the confusions (people, icons, icons) of a crowd."""


@dataclass(frozen=True, slots=True)
class VariantConfusions:
    """Confusions of a variant: of every person, of `few` (the nominal observer, each laboratory), by skin alone."""

    variable: Variable
    labels: tuple[str, ...]
    probability: Array
    few: Array
    drawn: Array
    baseline: Array

    @property
    def pooled(self) -> Array:
        """Mean over people, rows sum to 1."""
        return normalised(self.probability.mean(axis=0))

    @property
    def said(self) -> str:
        """The conditions of its predictions."""
        return f"named from memory, {self.probability.shape[0]} people, {FORMS}"

    def predicted(
        self, experiment: str, quantity: str, unit: str, score: Score, *, conditions: str = "", top: float = math.inf
    ) -> Predicted:
        """A score with its interval: what each laboratory changes is added, and stays within 0 and `top`."""
        value, nominal = score(self.probability), score(self.few)
        each = tuple(float(np.clip(value + score(one) - nominal, 0.0, top)) for one in self.drawn)
        ends, said = interval_of(each), conditions or self.said
        about = (experiment, quantity, "both", value, unit, *ends, self.variable, said)
        return Predicted(*about, draws=each, baseline=score(self.baseline))


@dataclass(frozen=True, slots=True)
class ShownSet:
    """A set that is shown to many people; `identify` asks one variant of the observer."""

    icons: tuple[Icon, ...]
    rig: Rig
    end_s: float
    crowd: People
    seed: int
    baseline: Array

    def played(self, variable: Variable) -> ReceptorTemperatures:
        """Receptor temperatures of every person, with the nominal observer of a variant."""
        cold, warm = (receptor_column(variable, channel) for channel in CHANNELS)
        how = self.rig, Observer.load(variable=variable), self.end_s, RATE_HZ, None
        return ReceptorTemperatures.simulated(self.icons, self.crowd, *how, (cold, warm))

    def identify(self, variable: Variable, draws: int) -> VariantConfusions:
        """Confusions of one variant from memory, the mean over both forms; each draw has one of them, and own pairs."""
        labels, nominal = tuple(icon.name for icon in self.icons), Observer.load(variable=variable)
        others = plausible_laboratories(max(draws, 2), self.seed, variable)

        def by_both(at: ReceptorTemperatures, people: People, samples: int) -> Array:
            laboratories = (DrawnLaboratory(nominal, people, form) for form in MEMORY_FORMS)
            return np.asarray(np.mean([self._named(at, each, samples) for each in laboratories], axis=0))

        few = self._few(others, variable)
        alone = by_both(few, self._first, FEW_SAMPLES)
        scores, kept = pair_scores(len(labels), len(others), self.seed), np.zeros((draws, *alone.shape))
        for k, named in enumerate(self.named_in(others, variable) if draws else ()):
            kept[k] = with_pairs(named, others.at(k, 1).observer.pair_spread, scores[k])
        whole = by_both(self.played(variable), self.crowd, SAMPLES)
        return VariantConfusions(variable, labels, whole, alone, kept, self.baseline)

    def named_in(self, laboratories: DrawnLaboratories, variable: Variable) -> Iterator[Array]:
        """Confusions (people, icons, icons) of the people whom each laboratory invites, without pairs of its own."""
        few = self._few(laboratories, variable)
        people = few.people
        invited = laboratories.invited(people)

        def named(k: int) -> Array:
            return np.asarray(self._named(few, laboratories.at(k, people), FEW_SAMPLES)[invited[k]])

        return in_order(named, range(len(laboratories)))

    @property
    def _first(self) -> People:
        return self.crowd.part(0, min(len(self.crowd), people_for_intervals(len(self.icons))))

    def _few(self, laboratories: DrawnLaboratories, variable: Variable) -> ReceptorTemperatures:
        """Receptor temperatures of the first people, for the observers of laboratories and the nominal one."""
        observers = (laboratories.at(k, 1).observer for k in range(len(laboratories)))
        cold, warm = (receptor_column(variable, channel) for channel in CHANNELS)
        depths_m = rungs([Observer.load(variable=variable), *observers], self._first.corneum_m(self.rig))
        how = self.end_s, RATE_HZ / EVERY, None, (cold, warm)
        return ReceptorTemperatures.at_depths(self.icons, self._first, self.rig, depths_m, *how)

    def _named(self, at: ReceptorTemperatures, laboratory: DrawnLaboratory, samples: int) -> Array:
        """Confusions of all people of a laboratory (people, icons, icons)."""
        observer, people, form = laboratory
        felt = respond(at, people, observer, detection=False)
        trials = few_named(len(self.icons)) if form == "naming" else samples
        return identify(felt, form, people, observer, self.seed, trials).probability


def show(icons: Iterable[Icon], rig: Rig, people: int, seed: int) -> ShownSet:
    """Icons to play to virtual people, each on their own skin and contact, as `rank` does."""
    from thermicon.circuit.solver.simulate import duration_s

    members, crowd = tuple(icons), draw_people(people, seed)
    end = run_end_s(duration_s(icon, rig) for icon in members)
    return ShownSet(members, rig, end, crowd, seed, confused_by_skin(members, rig, crowd, seed))


def correct(probability: Array) -> float:
    """Proportion correct, the mean over people."""
    return float(proportion_correct(probability).mean())


def correct_of(places: Sequence[int], probability: Array) -> float:
    """Proportion correct of some icons, the mean of theirs."""
    return float(np.mean([probability[:, k, k].mean() for k in places]))


def six_icons(confused: VariantConfusions, trials: int, seed: int) -> tuple[Predicted, ...]:
    """Proportion correct, information (exact, and as the experiment would report it), each icon, spread of people."""
    most = math.log2(len(confused.labels))

    def share_of_people(share: float) -> Score:
        return lambda p: float(np.percentile(proportion_correct(p), share))

    scores: list[tuple[str, str, Score, float]] = [
        ("proportion correct", "proportion", correct, 1.0),
        ("proportion correct, lower end of people", "proportion", share_of_people(2.5), 1.0),
        ("proportion correct, upper end of people", "proportion", share_of_people(97.5), 1.0),
        ("plug-in information", "bit", lambda p: plugin_bits(p, trials, seed, EXPERIMENTS), most),
        ("information", "bit", lambda p: float(information_bits(p).mean()), most),
    ]
    scores += [
        (f"proportion correct, {name}", "proportion", partial(correct_of, [k]), 1.0)
        for k, name in enumerate(confused.labels)
    ]
    results = [confused.predicted("six icons", name, unit, score, top=top) for name, unit, score, top in scores]
    results[3] = replace(results[3], conditions=f"{confused.said}; plug-in estimate of {trials} trials a person")
    return tuple(results)


WAVES = "wave-confusions"
SHAPES = ("square", "sine", "triangle")
GROUPS = tuple((poles, period) for poles in ("bipolar", "unipolar") for period in (4, 8))
"""About baseline or below it, and period in s."""
TAIL_S = 2.0
PAIRS = tuple(combinations(SHAPES, 2))


@dataclass(frozen=True, slots=True)
class Likeness:
    """Similarity of two shapes at the skin: differences over the swing, largest and root mean square."""

    group: str
    pair: tuple[str, str]
    largest: float
    rms: float


def wave_name(shape: str, poles: str, period: int) -> str:
    """Name of an icon of the set, such as sine-bipolar-4s."""
    return f"{shape}-{poles}-{period}s"


def likeness(rig: Rig) -> tuple[Likeness, ...]:
    """Differences at the skin of every pair of shapes in every group, over the swing of the display."""
    from thermicon.circuit import simulate
    from thermicon.circuit.solver.simulate import duration_s
    from thermicon.icons import load_library

    icons, similar = load_library(WAVES), []
    for poles, period in GROUPS:
        own = {shape: icons[wave_name(shape, poles, period)] for shape in SHAPES}
        end = max(duration_s(icon, rig) for icon in own.values()) + TAIL_S
        traces = {shape: simulate(icon, rig, tail_s=end - duration_s(icon, rig)) for shape, icon in own.items()}
        last_s = min(float(trace.time_s[-1]) for trace in traces.values())
        swing = float(np.ptp(traces["triangle"].display_C[traces["triangle"].time_s <= last_s]))
        skin = {shape: trace.skin_C[trace.time_s <= last_s - TAIL_S] for shape, trace in traces.items()}
        for first, second in PAIRS:
            apart = (skin[first] - skin[second]) / swing
            rms = float(np.sqrt((apart**2).mean()))
            similar.append(Likeness(f"{poles}, {period} s", (first, second), float(np.abs(apart).max()), rms))
    return tuple(similar)


def wave_shapes(confused: VariantConfusions, alike: Sequence[Likeness]) -> tuple[Predicted, ...]:
    """Similarity of shapes at the skin, and whether they are each other's main confusions."""
    places = {shape: [confused.labels.index(wave_name(shape, *group)) for group in GROUPS] for shape in SHAPES}
    results, skin = [], "skin temperature over the swing, largest of four groups"
    how = f"named from memory, {len(confused.labels)} icons, {confused.probability.shape[0]} people, {FORMS}"
    for pair in PAIRS:
        both = " and ".join(pair)
        largest = max(one.largest for one in alike if one.pair == pair)
        name, ends = f"largest difference of {both}", (None, None)
        results.append(Predicted("wave shapes", name, "both", largest, "1", *ends, confused.variable, skin))
        main, mixed = partial(_main, places, pair), partial(_mixed, places, pair)
        for name, unit, score, top in (
            (f"confusion of {both} over any other", "1", main, math.inf),
            (f"confusion of {both} over the mean of others", "1", partial(_main, places, pair, mean=True), math.inf),
            (f"confusion of {both}", "proportion", mixed, 1.0),
        ):
            results.append(confused.predicted("wave shapes", name, unit, score, conditions=how, top=top))
    for shape in SHAPES:
        name, score = f"proportion correct, {shape}", partial(correct_of, places[shape])
        results.append(confused.predicted("wave shapes", name, "proportion", score, conditions=how, top=1.0))
    return tuple(results)


def _main(places: dict[str, list[int]], pair: tuple[str, str], probability: Array, *, mean: bool = False) -> float:
    """Confusion of a pair of shapes over that of either with others: of the least group, or the `mean` of groups."""
    pooled = normalised(probability.mean(axis=0))
    mixed, pairs, others = 0.5 * (pooled + pooled.T), [], []
    for group in range(len(GROUPS)):
        own = [places[shape][group] for shape in SHAPES]
        first, second = (places[shape][group] for shape in pair)
        pairs.append(mixed[first, second])
        others.append(np.delete(mixed[[first, second]], own, axis=1))
    if mean:
        return float(np.mean(pairs) / np.mean(others))
    return float(min(one / bystanders.max() for one, bystanders in zip(pairs, others, strict=True)))


def _mixed(places: dict[str, list[int]], pair: tuple[str, str], probability: Array) -> float:
    """Mean confusion of a pair of shapes over the groups."""
    pooled = normalised(probability.mean(axis=0))
    mixed = 0.5 * (pooled + pooled.T)
    return float(np.mean([mixed[first, second] for first, second in zip(*(places[s] for s in pair), strict=True)]))
