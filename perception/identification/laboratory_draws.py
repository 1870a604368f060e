"""The prediction of each posterior draw for a set.

A draw brings its own spread between people and an offset of the laboratory. Memory is its own, or, since no published
posterior knows of it, drawn: one of two forms, and its constants from their intervals. Every pair has odds of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermicon.base.files.records import RecordTable
from thermicon.base.numbers.arrays import Array

from ..kernels.cluster import on_cluster
from ..kernels.parallel import in_order
from ..observer.channels import FORM, MEMORY_FORMS, MemoryChoice, MemoryForm, Variable, forms_in
from ..observer.constants import name_of
from ..observer.draws import PosteriorDraws
from ..observer.mechanisms.memory import MEMORY_NAMES, MISSING
from ..observer.observer import Observer, variant_records
from ..observer.observer_model import ObserverModel
from ..observer.people import People, draw_people
from ..sensation.detection import pooled
from .confusion import few_named
from .measures import felt_and_named, information_bits, proportion_correct
from .pairs import pair_scores, with_pairs
from .population import AnyTemperatures, identify, memory_dprime, respond
from .task import USUAL, Task

LOG_FROM = 1.5
"""An interval whose ends are in a larger ratio than this is drawn in its logarithm."""


@dataclass(frozen=True, slots=True)
class Uncertain:
    """A number, by its name, that may lie anywhere between `low` and `high`, in its unit."""

    name: str
    low: float
    high: float
    unit: str = ""

    def __post_init__(self) -> None:
        if not self.low < self.high:
            raise ValueError(f"{self.name}: {self.low:g} to {self.high:g} is not an interval")

    def at(self, share: float) -> float:
        """The value at a share (0–1) of the interval.

        >>> Uncertain("time", 1.0, 4.0).at(0.5), Uncertain("time", 1.0, 1.4).at(0.5)
        (2.0, 1.2)
        """
        if self._in_logs:
            return self.low * math.pow(self.high / self.low, share)
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """The share of the interval at which a value lies, as `at` takes it."""
        if self._in_logs:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    @property
    def _in_logs(self) -> bool:
        return self.low > 0.0 and self.high / self.low > LOG_FROM


def latin(parameters: int, draws: int, seed: int) -> Array:
    """Shares of shape (draws, parameters) in 0–1, one in each of `draws` equal strata of every parameter."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 3]))
    strata = np.array([rng.permutation(draws) for _ in range(parameters)]).reshape(parameters, draws).T
    return np.asarray((strata + rng.random(strata.shape)) / draws)


def memory_parameters(memory: MemoryChoice, records: RecordTable | None = None) -> tuple[Uncertain, ...]:
    """The uncertain constants of memory that some forms make use of, by the records of an observer (None: the shipped).

    >>> [parameter.name for parameter in memory_parameters("episodes")][:2]
    ['share of the scatter of ratings', 'bar of an episode']
    """
    found = []
    for record in variant_records() if records is None else records:
        name = name_of(record)
        low, high = record.interval
        if name in MEMORY_NAMES and (name != MISSING or "naming" in forms_in(memory)) and low < high:
            found.append(Uncertain(name, low, high, record.unit))
    return tuple(found)


OFFSETS = ("laboratory, cold", "laboratory, warm")


class DrawnLaboratory(NamedTuple):
    """The observer of a laboratory, its people, and the form of their memory."""

    observer: Observer
    people: People
    form: MemoryForm


def laboratory_forms(held: PosteriorDraws, chosen: Sequence[int], memory: MemoryChoice, seed: int) -> NDArray[np.int64]:
    """Places in `MEMORY_FORMS` of laboratories around draws: those of the draws, or by chance, half of each form."""
    if memory == "both" and held.forms is not None:
        return np.array([MEMORY_FORMS.index(held.forms[k]) for k in chosen])
    counted = [MEMORY_FORMS.index(form) for form in forms_in(memory)]
    chance = np.random.default_rng(np.random.SeedSequence([seed, 15]))
    return chance.permutation(np.resize(counted, len(chosen)))


@dataclass(frozen=True, slots=True)
class DrawnLaboratories:
    """One laboratory for each of some evenly spaced draws.

    `values` (n, constants) of `names`: constants, memory with its form, and offsets in ln.
    """

    variable: Variable
    names: tuple[str, ...]
    values: Array
    seed: int
    age_years: float | None

    @classmethod
    def of(cls, model: ObserverModel, memory: MemoryChoice, draws: int, seed: int) -> DrawnLaboratories:
        """As many laboratories of a model as `draws`; a ValueError for an observer without draws."""
        held = model.drawn
        chosen = held.spaced(draws)
        free = [p for p in memory_parameters(memory, records=model.records) if p.name not in held.memory_names]
        shares = latin(len(free), draws, seed).tolist()
        drawn = [[p.at(share) for p, share in zip(free, row, strict=True)] for row in shares]
        forms = laboratory_forms(held, chosen, memory, seed)
        own = [k for k, name in enumerate(held.memory_names) if name != FORM]
        parts = (held.draws[chosen], held.memory[np.ix_(chosen, own)], np.reshape(drawn, (draws, len(free))))
        values = np.hstack([*parts, forms[:, None], held.new_laboratory(seed)[chosen]])
        memory_names = (*(held.memory_names[k] for k in own), *(p.name for p in free), FORM)
        names = (*held.names, *memory_names, *OFFSETS)
        return cls(held.variable, names, values, seed, model.age_years)

    def __len__(self) -> int:
        return len(self.values)

    def at(self, place: int, people: int) -> DrawnLaboratory:
        """One laboratory with so many people."""
        return self.with_values(self.values[place], people)

    def with_values(self, values: Array, people: int) -> DrawnLaboratory:
        """A laboratory with these values of the constants (constants,)."""
        named = dict(zip(self.names, values.tolist(), strict=True))
        offsets = named[OFFSETS[0]], named[OFFSETS[1]]
        observer = Observer.from_values(named, self.variable)
        crowd = draw_people(people, self.seed, age_years=self.age_years, observer=observer, offsets=offsets)
        return DrawnLaboratory(observer, crowd, MEMORY_FORMS[round(named[FORM])])

    def invited(self, people: int) -> NDArray[np.int64]:
        """Places (n, people) of the people whom each laboratory invites: a random sample of its own."""
        chance = np.random.default_rng(np.random.SeedSequence([self.seed, 9]))
        return chance.integers(people, size=(len(self), people))


PEOPLE, FEWEST, PRESENTED = 24, 12, 768
"""Number of people: 24, of larger sets fewer, but at least 12, so that about 768 icons are judged."""
EVERY = 8
"""Draws are judged at 12.5 Hz: this changes the scores of shipped icons by less than 0.001, and the change cancels."""
MANY = 32
"""Larger sets are judged at half of these instants: this changes the ends of an interval by less than 0.002."""
FEW = 4
"""Number of people whom a constant changes, or not."""
SAMPLES, LEAST, NAMED = 512, 128, 8192
"""Presentations of an icon to a person: fewer, but at least 128, where more icons make up for it."""


@dataclass(frozen=True)
class TakingPart:
    """Which constants take part in how a set is named, with what computes it."""

    compute: Callable[[], NDArray[np.bool_]]

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """One for each of (constants,), kept once it was asked for."""
        return self.compute()

    def __call__(self) -> NDArray[np.bool_]:
        """See `acting`."""
        return self.acting


@dataclass(frozen=True, slots=True)
class LaboratoryDraws:
    """Predictions of a set by every draw: what `sensitivity` reads and intervals are made of.

    `values` (draws, constants) belong to `names`; `acting` says, when asked, which (constants,) take part in how
    the set is named.
    Scores (draws,), `felt_and_named` too, are means over the people of a draw, so are `detected` and
    `each_felt_and_named` (draws, icons); `onset_s` (draws, icons; NaN: not felt) and `d_prime` (draws, icons, icons)
    are medians, `confused` the mean of both ways; `persons_…` (draws, people) are those of single people, detection by
    the icon that a person detects least.
    """

    names: tuple[str, ...]
    values: Array
    acting: Callable[[], NDArray[np.bool_]]
    proportion_correct: Array
    information_bits: Array
    detected: Array
    d_prime: Array
    onset_s: Array
    confused: Array
    each_felt_and_named: Array
    felt_and_named: Array
    persons_correct: Array
    persons_bits: Array
    persons_detected: Array
    persons_felt_and_named: Array

    def __len__(self) -> int:
        return int(self.proportion_correct.size)


def laboratory_draws(
    played: Callable[[int], AnyTemperatures],
    persons: People,
    memory: MemoryChoice,
    model: ObserverModel,
    *,
    draws: int,
    seed: int = 0,
    task: Task = USUAL,
    resampled: bool = False,
    step: Callable[[], None] | None = None,
    cluster: tuple[str, str] | None = None,
) -> LaboratoryDraws:
    """Predictions by `draws` draws, evenly spaced; the same arguments give the same numbers.

    `played` says what the receptors of the persons go through in a draw, by its number. Every draw has its own people
    with the same seed, and invites a random sample of them (`resampled`), or all of them once. `cluster` has the
    address of a scheduler and a key, as `on_cluster`.
    """
    laboratories, count = DrawnLaboratories.of(model, memory, draws, seed), len(persons)
    invited = laboratories.invited(count) if resampled else np.tile(np.arange(count), (draws, 1))
    pairs, apart_by = pair_scores(len(played(0).names), draws, seed), next(iter(model.form_shares(memory)))

    def one(place: int) -> tuple[Array, ...]:
        laboratory = laboratories.at(place, count)
        return scored(played(place), laboratory, apart_by, pairs[place], seed, task, invited[place])

    computed = on_cluster(one, draws, *cluster) if cluster else enumerate(in_order(one, list(range(draws))))
    found = dict[int, tuple[Array, ...]]()
    for place, scores in computed:
        found[place] = scores
        if step is not None:
            step()
    each = (np.stack(scores) for scores in zip(*map(found.__getitem__, range(draws)), strict=True))
    acting = TakingPart(partial(_acting, laboratories, played(0), pairs[0], min(count, FEW), seed, task))
    return LaboratoryDraws(laboratories.names, laboratories.values, acting, *each)


def _acting(
    laboratories: DrawnLaboratories, played: AnyTemperatures, pairs: Array, count: int, seed: int, task: Task
) -> NDArray[np.bool_]:
    """Whether each constant (constants,), moved alone as far as the draws go, changes what a few people say.

    What acts with one form of memory acts.
    """
    few, drawn, names = played.first(count), laboratories.values, laboratories.names

    def named(constants: Array) -> Array:
        observer, people, form = laboratories.with_values(constants, count)
        felt = respond(few, people, observer, detection=False)
        d_prime = memory_dprime(felt, form, people.memory, observer, task)
        confusion = identify(felt, form, people, observer, seed, LEAST, task=task, d_prime=d_prime)
        return np.stack([d_prime, with_pairs(confusion.probability, observer.pair_spread, pairs)])

    def acts(k: int) -> bool:
        column = drawn[:, k]
        for values, usual in zip(places, usually, strict=True):
            moved = values.copy()
            moved[k] = column[np.abs(column - moved[k]).argmax()]
            if not np.array_equal(named(moved), usual):
                return True
        return False

    forms = np.unique(drawn[:, names.index(FORM)])
    places = [np.where(np.array(names) == FORM, form, drawn[0]) for form in forms.tolist()]
    usually = [named(values) for values in places]
    return np.array(list(in_order(acts, range(drawn.shape[1]))))


def scored(
    few: AnyTemperatures,
    laboratory: DrawnLaboratory,
    apart_by: MemoryForm,
    pairs: Array,
    seed: int,
    task: Task,
    invited: NDArray[np.int64],
) -> tuple[Array, ...]:
    """Scores of the invited people (correct, bits, detected, d′, onset, confusions, felt and named), and of each.

    d′ are by the form `apart_by`; `pairs` (icons, icons) are scores of the laboratory.
    """
    observer, people, form = laboratory
    icons = len(few.names)
    felt = respond(few, people, observer, times=True)
    samples = few_named(icons, felt.surfaces) if form == "naming" else min(SAMPLES, max(LEAST, NAMED // icons))
    d_prime = memory_dprime(felt, apart_by, people.memory, observer, task)
    known = d_prime if form == apart_by else None
    confusion = identify(felt, form, people, observer, seed, samples, task=task, d_prime=known)
    probability = with_pairs(confusion.probability, observer.pair_spread, pairs)
    correct, bits = proportion_correct(probability), information_bits(probability)
    named, found = probability[invited].mean(axis=0), felt.detected
    reported = found.courses[invited].sum(axis=0)
    reports = pooled(found.probability[invited], found.cold_share[invited], reported, found.dt_s)
    correct, bits, apart = correct[invited], bits[invited], np.median(d_prime[invited], axis=0)
    alert = felt_and_named(found.probability, probability)[invited]
    of_set = correct.mean(), bits.mean(), reports.probability, apart, reports.onset_s, 0.5 * (named + named.T)
    single = correct, bits, found.probability[invited].min(axis=1), alert.mean(axis=1)
    return *of_set, alert.mean(axis=0), alert.mean(), *single


def people_for_intervals(icons: int) -> int:
    """Largest number of people who judge a set of this size with every draw."""
    return min(PEOPLE, max(FEWEST, PRESENTED // icons))
