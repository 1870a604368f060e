"""A ranking's work in chunks of people, each of which gives the same numbers wherever and whenever it is done.

A chunk has all icons, since they are compared within a person, and as many persons as keep it within a bounded
memory: that hangs on the icons and their length alone, not on how many work on it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.program import DRIVES
from thermicon.circuit.program import code_digest as digest_of

from ..arrays import Array
from ..identification.confusion import SAMPLES
from ..identification.intervals import EVERY, PEOPLE
from ..identification.measures import experiments_bits, information_bits
from ..identification.population import Played, feel, judge
from ..identification.task import USUAL, Task
from ..kernels.parallel import in_order
from ..observer.observer import NORMS, Norm, Observer
from ..observer.people import People, draw_people

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

RATE_HZ = 100.0
SAMPLES_AT_ONCE = 1_200_000
"""Instants × icons × people of a chunk, about 150 bytes each at the peak; one person's always fit."""
OTHER_SAMPLES = 512
EXPERIMENTS = 20
PROBES = ("cold_receptor_C", "warm_receptor_C")


@dataclass(frozen=True, slots=True)
class Found:
    """What the people of a chunk make of the icons, a row a person; p people, m icons, q = m(m − 1)/2 pairs.

    `detected` (p, m) and `confusion` (p, m, m) are probabilities, `d_prime` (p, q) from memory, `correct` (p, m) 0–1,
    `bits`, `plugin` (p,) information and what experiments report of it, `stress` (p,), `other_correct` (p, norms, m) by
    the other norms. `cold_C`, `warm_C` (p or 0, m, n) are thinned temperatures of the first people.
    """

    detected: Array
    d_prime: Array
    confusion: Array
    correct: Array
    bits: Array
    plugin: Array
    stress: Array
    other_correct: Array
    cold_C: Array
    warm_C: Array

    def __post_init__(self) -> None:
        for field in fields(self):
            held = np.asarray(getattr(self, field.name), dtype=np.float64)
            if not np.isfinite(held).all():
                raise ValueError(f"a chunk's {field.name} must be finite")


@dataclass(frozen=True, slots=True)
class Work:
    """What is to be found out: icons on a rig to one common end (s), for people drawn from a seed, by a norm."""

    icons: tuple[Icon, ...]
    rig: Rig
    end_s: float
    people: int
    seed: int
    trials: int
    tracking: str | None
    norm: Norm
    task: Task = USUAL

    @property
    def at_once(self) -> int:
        """People of a chunk."""
        rows = int(self.end_s * RATE_HZ) + 2
        return max(1, SAMPLES_AT_ONCE // (rows * len(self.icons)))

    @property
    def chunks(self) -> int:
        """How many chunks there are."""
        return -(-self.people // self.at_once)

    def span(self, number: int) -> tuple[int, int]:
        """First person of a chunk, and the one after its last."""
        return number * self.at_once, min(self.people, (number + 1) * self.at_once)

    @property
    def other_norms(self) -> tuple[Norm, ...]:
        """The norms that are compared with the chosen one."""
        return tuple(n for n in NORMS if n != self.norm)

    @property
    def key(self) -> str:
        """Hash of all that a chunk's numbers hang on, this version's code and data included."""
        told = [code_digest(), self.rig.document, *self.rig.changes, repr(self.end_s), str(self.people), str(self.seed)]
        told += [str(self.trials), str(self.tracking), self.norm, str(self.at_once), repr(self.task)]
        for icon in self.icons:
            corners = icon.corners(None if icon.context.control != "current" else 0.0)
            told += [icon.name, repr(icon.context), repr(corners.time_s), repr(corners.value), str(icon)]
        return hashlib.sha256("\0".join(told).encode("utf-8")).hexdigest()


def run(work: Work, number: int) -> Found:
    """Do one chunk."""
    from thermicon.circuit import simulate_many

    start, stop = work.span(number)
    crowd = _crowd(work.people, work.seed).part(start, stop)
    batch = simulate_many(
        work.icons,
        crowd.rigs(work.rig),
        nominal=work.rig,
        end_s=work.end_s,
        rate_Hz=RATE_HZ,
        tracking=work.tracking,
        probes=PROBES,
    )
    played = Played(batch.cold_C, batch.warm_C, batch.time_s, work.rig.site, work.rig.contact.area_m2)
    observer = Observer.load()
    felt = feel(played, crowd, observer)
    d_prime, confusion = judge(felt, work.norm, crowd, observer, work.seed, SAMPLES, start, work.task)
    others = [
        np.diagonal(
            judge(felt, n, crowd, observer, work.seed, OTHER_SAMPLES, start, work.task)[1].probability, axis1=1, axis2=2
        )
        for n in work.other_norms
    ]
    named = confusion.probability
    first, second = np.triu_indices(len(work.icons), 1)
    asked_again = played.thinned(max(0, min(stop, PEOPLE) - start), EVERY)
    return Found(
        detected=np.asarray(felt.probability),
        d_prime=d_prime[:, first, second],
        confusion=named,
        correct=np.diagonal(named, axis1=1, axis2=2).copy(),
        bits=information_bits(named),
        plugin=experiments_bits(named, work.trials, work.seed, EXPERIMENTS, start).mean(axis=1),
        stress=confusion.stress,
        other_correct=np.stack(others, axis=1),
        cold_C=asked_again.cold_C,
        warm_C=asked_again.warm_C,
    )


def locally(work: Work, numbers: list[int], workers: int | None = None) -> Iterator[tuple[int, Found]]:
    """Do some chunks in threads of this process, by default one a core; each is given as soon as its turn comes.

    No more than two chunks a worker are in memory.
    """
    from thermicon.circuit.solver.cores import cores

    each = in_order(lambda number: run(work, number), numbers, workers or cores())
    yield from zip(numbers, each, strict=True)


def time_s(work: Work, every: int) -> Array:
    """Clock of every k-th instant of the work."""
    from thermicon.circuit.solver.simulate import rows_until

    clock: Array = rows_until(work.end_s, RATE_HZ)[::every]
    return clock


@lru_cache(maxsize=2)
def _crowd(people: int, seed: int) -> People:
    return draw_people(people, seed)


def code_digest() -> str:
    """Hash of the version and of all that this version computes with: chunks of another are of no use to it."""
    return digest_of((*DRIVES, "thermicon.perception"))
