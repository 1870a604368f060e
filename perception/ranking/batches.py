"""A ranking in batches of people that give the same numbers wherever they are computed.

A batch has all icons, since they are compared within a person, and as many people as fit into a bounded memory. That
depends only on the icons and their length, not on the number of workers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from hashlib import sha256

import numpy as np

from thermicon.base.numbers.arrays import Array, own_arrays
from thermicon.base.numbers.cores import cores
from thermicon.circuit import Rig
from thermicon.circuit.rig.layout import AnyLayout, Layout
from thermicon.icons import Icon, SpatialIcon
from thermicon.icons.model.iconset import SeveralElements

from ..identification.measures import experiments_bits
from ..identification.population import (
    RATE_HZ,
    PopulationResponse,
    ReceptorTemperatures,
    TrackTemperatures,
    identify_by,
    memory_dprime,
    respond,
)
from ..identification.task import USUAL, Task
from ..identification.tracks import Members, Tracks
from ..kernels.cluster import code_digest
from ..kernels.parallel import in_order
from ..observer.channels import MemoryChoice, MemoryForm
from ..observer.observer import Observer
from ..observer.observer_model import Crowd, ObserverModel, Tracking
from ..observer.people import People
from ..sensation.detection import Detection, report_step
from ..sensation.detection import pooled as pooled_detection

DT_S = 1.0 / RATE_HZ
SAMPLES_AT_ONCE = 1_200_000
"""Instants × icons × people of a batch, about 150 bytes each at the peak; a batch has at least one person."""
TRIALS = 48
"""Trials of an experiment, unless it is another."""
EXPERIMENTS = 20


@dataclass(frozen=True, slots=True)
class BatchResult:
    """Responses of the people of a batch, one row per person; p people, m icons, q = m(m − 1)/2 pairs.

    `detected` (p, m), `cold_share` (p, m) of the reports and `confusion` (p, forms, m, m), by every form of memory
    that counts, are probabilities, `reported` (1, m, n) is the number of people who have reported by each time,
    `d_prime` (p, q) from memory, `bits`, `plugin` (p,) information and what experiments report of it, the mean over
    forms.
    """

    detected: Array
    cold_share: Array
    reported: Array
    d_prime: Array
    confusion: Array
    bits: Array
    plugin: Array

    def __post_init__(self) -> None:
        for field in fields(self):
            values = np.asarray(getattr(self, field.name), dtype=np.float64)
            if not np.isfinite(values).all():
                raise ValueError(f"{field.name} of a batch must be finite")


@dataclass(frozen=True, slots=True)
class Job:
    """Icons on a layout, simulated to one common end (s), for people drawn from a seed, with forms of memory.

    `shares` are those of laboratories with each form that counts; distances and reasons are those of the first.
    `observer` is another than the shipped one. Its draws of the posterior do not travel with the job.
    """

    members: Members
    layout: Layout
    end_s: float
    people: int
    seed: int
    trials: int
    tracking: Tracking | None
    memory: MemoryChoice
    shares: tuple[tuple[MemoryForm, float], ...]
    task: Task = USUAL
    observer: ObserverModel | None = None

    @classmethod
    def of(
        cls, icons: Members, rig: AnyLayout, crowd: Crowd, end_s: float, trials: int = TRIALS, task: Task = USUAL
    ) -> Job:
        """The job of ranking icons by a crowd."""
        # Batches need no draws, and of the shipped model nothing, which every worker has.
        other = replace(crowd.model, posterior=None) if crowd.model.key else None
        shares = tuple(crowd.model.form_shares(crowd.memory).items())
        own = crowd.people, crowd.seed, trials, crowd.tracking, crowd.memory, shares
        return cls(icons, Layout.of(rig), end_s, *own, task, other)

    def crowd(self, model: ObserverModel) -> Crowd:
        """The people who feel and remember the icons."""
        return Crowd(self.people, self.seed, self.tracking, self.memory, model)

    @property
    def icons(self) -> tuple[Icon, ...]:
        """The icons, which are on one element; SeveralElements, with a cure, for others."""
        if isinstance(self.members[0], SpatialIcon):
            told = "icons on several elements are ranked, and not yet chosen or edited"
            raise SeveralElements(f"{told}; change them in their file, and rank them again")
        return self.members

    @property
    def rig(self) -> Rig:
        """The rig of the only element; RigError, with a cure, where there are several."""
        return self.layout.alone

    @property
    def tracks(self) -> Tracks:
        """What the elements play."""
        return Tracks.of(self.members, self.layout)

    @property
    def at_once(self) -> int:
        """Number of people in a batch."""
        rows = int(self.end_s * RATE_HZ) + 2
        return max(1, SAMPLES_AT_ONCE // (rows * self.tracks.count))

    @property
    def batches(self) -> int:
        """Number of batches."""
        return -(-self.people // self.at_once)

    def span(self, number: int) -> tuple[int, int]:
        """First person of a batch, and the one after its last."""
        return number * self.at_once, min(self.people, (number + 1) * self.at_once)

    @property
    def key(self) -> str:
        """Hash of all that decides what the batches are, and of the code."""
        model = self.observer.digest if self.observer else None
        how = self.end_s, self.people, self.seed, self.trials, self.tracking, self.memory, self.shares, self.task, model
        return sha256(
            "\0".join([code_digest(), self.layout.document, repr(how), *map(str, self.members)]).encode()
        ).hexdigest()

    @property
    def forms(self) -> tuple[MemoryForm, ...]:
        """The forms of memory that count; distances and reasons are those of the first."""
        return tuple(form for form, _ in self.shares)


def _respond(job: Job, number: int) -> tuple[People, Observer, PopulationResponse]:
    """The people of one batch, the nominal observer, and what these people feel."""
    model = ObserverModel.of(job.observer)
    crowd, observer = model.people(job.people, job.seed).part(*job.span(number)), model.nominal

    def played(icons: Sequence[Icon], rig: Rig) -> ReceptorTemperatures:
        return ReceptorTemperatures.simulated(icons, crowd, rig, observer, job.end_s, RATE_HZ, job.tracking)

    return crowd, observer, respond(TrackTemperatures.of(job.tracks, played), crowd, observer, times=True)


def run(job: Job, number: int) -> BatchResult:
    """Compute one batch."""
    start, _ = job.span(number)
    crowd, observer, felt = _respond(job, number)
    found = identify_by(felt, dict(job.shares), crowd, observer, job.seed, start, job.task)
    named = [each.probability for each in found.by_form.values()]
    reported = [experiments_bits(each, job.trials, job.seed, EXPERIMENTS, start).mean(axis=1) for each in named]
    first, second = np.triu_indices(len(job.members), 1)
    return BatchResult(
        detected=felt.detected.probability,
        cold_share=felt.detected.cold_share,
        reported=felt.detected.reported_sum(),
        d_prime=found.d_prime[:, first, second],
        confusion=np.stack(named, axis=1),
        bits=found.bits,
        plugin=np.average(reported, axis=0, weights=[share for _, share in job.shares]),
    )


@dataclass(frozen=True, slots=True)
class FeltResult:
    """Percepts of m icons: `detection` (m,) by one person drawn at random, probability `reports` (people, m) of a
    report, `pairs` (people, m(m − 1)/2) of d′.
    """

    detection: Detection
    reports: Array
    pairs: Array

    @property
    def detected(self) -> Array:
        """Probability that a person drawn at random reports each icon, (m,)."""
        return self.detection.probability

    @property
    def middle(self) -> Array:
        """Median d′ of every pair over people, (m, m)."""
        return np.asarray(self.square(np.median(self.pairs, axis=0)[None])[0])

    @property
    def d_prime(self) -> Array:
        """d′ of every pair for every person, (people, m, m)."""
        return self.square(self.pairs)

    def square(self, pairs: Array) -> Array:
        """Pairs (people, m(m − 1)/2) as matrices (people, m, m)."""
        icons = len(self.detected)
        first, second = np.triu_indices(icons, 1)
        matrix = np.zeros((len(pairs), icons, icons))
        matrix[:, first, second] = pairs
        matrix[:, second, first] = pairs
        return matrix


@dataclass(frozen=True, slots=True)
class PooledResult(FeltResult):
    """Responses of all people to m icons.

    `pooled` (m, m); `by_form` (forms, people, m) of an announced icon named by each form of memory, `shares` (forms,)
    of laboratories with it; `bits`, `plugin` (people,). `standard_error` and `person_standard_error` are the largest
    sampling errors of a cell, pooled and of one person. What is not by a form is the mean over those that count.
    """

    pooled: Array
    by_form: Array
    shares: Array
    bits: Array
    plugin: Array
    standard_error: float
    person_standard_error: float

    def __post_init__(self) -> None:
        own_arrays(self, "pooled")

    @property
    def each_correct(self) -> Array:
        """Proportion of every icon that every person names correctly, (people, m)."""
        return np.asarray(np.average(self.by_form, axis=0, weights=self.shares))

    @property
    def correct(self) -> Array:
        """Proportion named correctly by every person, (people,)."""
        return np.asarray(self.each_correct.mean(axis=1))

    @property
    def each_felt_and_named(self) -> Array:
        """Share of plays that every person reports and names correctly, (people, m)."""
        return self.reports * self.each_correct

    @property
    def felt_and_named(self) -> Array:
        """The same of the whole set, (people,)."""
        return np.asarray(self.each_felt_and_named.mean(axis=1))


def felt_by_people(job: Job, first: int, step: Callable[[], None]) -> Iterator[FeltResult]:
    """Percepts of about as many people as `first`, where they are fewer batches than all, and then of all.

    Icons are not named, which takes most of the time of many icons; `step` is called after each batch.
    """
    one, other = np.triu_indices(len(job.members), 1)

    def felt_in(number: int) -> tuple[Array, ...]:
        crowd, observer, felt = _respond(job, number)
        d_prime, found = memory_dprime(felt, job.forms[0], crowd.memory, observer, job.task), felt.detected
        return found.probability, found.cold_share, d_prime[:, one, other], found.reported_sum()[0]

    held: list[tuple[Array, ...]] = []
    reports = np.zeros(())
    for number, (*each, reported) in enumerate(in_order(felt_in, range(job.batches), cores()), 1):
        held.append(tuple(each))
        reports = reports + reported
        step()
        if number in (-(-first // job.at_once), job.batches):
            detected, cold, pairs = (np.concatenate(values) for values in zip(*held, strict=True))
            yield FeltResult(pooled_detection(detected, cold, reports, report_step(DT_S)), detected, pairs)
