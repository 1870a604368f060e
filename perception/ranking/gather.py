"""All chunks of a ranking put together: those that are kept already, and the others done here or on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..identification.confusion import SAMPLES, normalised, sampling_error
from ..identification.intervals import EVERY
from ..identification.population import ReceptorTemperatures
from ..observer.observer import Norm
from .chunk_store import BatchStore
from .chunks import BatchResult, Job, locally, time_s


@dataclass(frozen=True, slots=True)
class Execution:
    """Where the work is done and kept: threads here (None: one a core), or a cluster; a folder for finished chunks.

    Raises `ValueError` for fewer than one worker.
    """

    workers: int | None = None
    cluster: str | None = None
    keep: Path | None = None

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 1:
            raise ValueError(f"at least one worker is needed, not {self.workers}")


@dataclass(frozen=True, slots=True)
class PooledResult:
    """What all people made of m icons.

    `detected` (m,) means; `pairs` (people, m(m − 1)/2) d′ from memory; `pooled` (m, m); `each_correct` (people, m);
    `bits`, `plugin`, `stress` (people,); `by_norm` (m,) proportion correct of each icon by the other norms.
    `standard_error` and `person_standard_error` are the most by which sampling blurs a cell, pooled and of one person.
    """

    detected: Array
    pairs: Array
    pooled: Array
    each_correct: Array
    bits: Array
    plugin: Array
    stress: Array
    by_norm: dict[Norm, Array]
    standard_error: float
    person_standard_error: float
    thin: ReceptorTemperatures

    @property
    def correct(self) -> Array:
        """Proportion correct of every person, (people,)."""
        found: Array = self.each_correct.mean(axis=1)
        return found

    @property
    def middle(self) -> Array:
        """Median d′ of every pair over people, (m, m)."""
        found: Array = self._square(np.median(self.pairs, axis=0)[None])[0]
        return found

    @property
    def d_prime(self) -> Array:
        """d′ of every pair for every person, (people, m, m)."""
        return self._square(self.pairs)

    def _square(self, pairs: Array) -> Array:
        icons = len(self.detected)
        first, second = np.triu_indices(icons, 1)
        matrix = np.zeros((len(pairs), icons, icons))
        matrix[:, first, second] = pairs
        matrix[:, second, first] = pairs
        return matrix


def collect_batches(work: Job, where: Execution, step: Callable[[], None]) -> PooledResult:
    """Do or read every chunk; `step` is called after each. Where and in what order they are done changes no bit."""
    icons, people = len(work.icons), work.people
    parts: dict[int, BatchResult] = {}
    pooled: dict[int, Array] = {}
    blur = 0.0
    for number, found in _each(work, where):
        pooled[number] = found.confusion.sum(axis=0)
        blur = max(blur, sampling_error(found.confusion, SAMPLES))
        parts[number] = _light(found)
        step()
    ordered = [parts[number] for number in range(work.chunks)]

    def joined(name: str) -> Array:
        found: Array = np.concatenate([getattr(part, name) for part in ordered])
        return found

    total = np.zeros((icons, icons))
    for number in range(work.chunks):
        total += pooled[number]
    mean, other = normalised(total / people), joined("other_correct").mean(axis=0)
    return PooledResult(
        detected=joined("detected").mean(axis=0),
        pairs=joined("d_prime"),
        pooled=mean,
        each_correct=joined("correct"),
        bits=joined("bits"),
        plugin=joined("plugin"),
        stress=joined("stress"),
        by_norm=dict(zip(work.other_norms, other, strict=True)),
        standard_error=sampling_error(mean, SAMPLES * people) if icons > 2 else 0.0,
        person_standard_error=blur if icons > 2 else 0.0,
        thin=ReceptorTemperatures(
            joined("cold_C"), joined("warm_C"), time_s(work, EVERY), work.rig.site, work.rig.contact.area_m2
        ),
    )


def _each(work: Job, where: Execution) -> Iterator[tuple[int, BatchResult]]:
    shelf = None if where.keep is None else BatchStore.of(work, where.keep)
    missing = []
    for number in range(work.chunks):
        found = None if shelf is None else shelf.get(work, number)
        if found is None:
            missing.append(number)
        else:
            yield number, found
    if not missing:
        return
    if where.cluster is None:
        made = locally(work, missing, where.workers)
    else:
        from .cluster import on_cluster

        made = on_cluster(work, missing, where.cluster)
    for number, found in made:
        if shelf is not None:
            shelf.put(work, number, found)
        yield number, found


def _light(found: BatchResult) -> BatchResult:
    """A chunk without the confusions of every person, which are the bulk of it and needed only summed up."""
    return replace(found, confusion=np.empty((0, 0, 0)))
