"""All batches of a ranking pooled in their order."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.cores import cores

from ..identification.confusion import NAMED_SAMPLES, SAMPLES, normalised, sampling_error
from ..kernels.parallel import in_order
from ..sensation.detection import pooled as pooled_detection
from ..sensation.detection import report_step
from .batches import DT_S, BatchResult, Job, PooledResult, run
from .cluster import on_cluster


def collect_batches(job: Job, workers: int | str | None, step: Callable[[], None]) -> PooledResult:
    """Compute every batch, as `rank` has the keywords; `step` is called after each.

    Place and order of work do not change the result.
    """
    each: Iterator[tuple[int, BatchResult]]
    parts: dict[int, BatchResult] = {}
    blur = 0.0
    if isinstance(workers, str):
        each = on_cluster(job, workers)
    else:
        # At most two batches per thread are in memory.
        each = enumerate(in_order(lambda number: run(job, number), range(job.batches), workers or cores()))
    for number, found in each:
        blur = max(blur, _sampling_error(job, found.confusion))
        # Confusions are most of a batch, and are needed only as their sum.
        parts[number] = replace(found, confusion=found.confusion.sum(axis=0))
        step()
    ordered = [parts[number] for number in range(job.batches)]

    def joined(name: str) -> Array:
        return np.concatenate([getattr(part, name) for part in ordered])

    # In order, so that the sums do not depend on which batch was ready first.
    mean = normalised(np.asarray(sum(part.confusion for part in ordered)) / job.people)
    reports = np.asarray(sum(part.reported[0] for part in ordered))
    return PooledResult(
        detection=pooled_detection(joined("detected"), joined("cold_share"), reports, report_step(DT_S)),
        reports=joined("detected"),
        pairs=joined("d_prime"),
        pooled=mean,
        each_correct=joined("correct"),
        bits=joined("bits"),
        plugin=joined("plugin"),
        other_correct=joined("other_correct").mean(axis=0),
        standard_error=_sampling_error(job, mean, job.people),
        person_standard_error=blur,
    )


def _sampling_error(job: Job, confusion: Array, people: int = 1) -> float:
    """Largest standard error of a cell to which so many people give answers; 0 where cells are exact."""
    direct = job.memory == "naming"
    if len(job.icons) <= (1 if direct else 2):
        return 0.0
    return sampling_error(confusion, people * (NAMED_SAMPLES if direct else SAMPLES))
