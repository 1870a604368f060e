"""All batches of a ranking pooled in their order."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.cores import cores

from ..identification.confusion import normalised, sampling_error
from ..identification.population import form_samples
from ..kernels.cluster import on_cluster
from ..kernels.parallel import in_order
from ..sensation.detection import pooled as pooled_detection
from ..sensation.detection import report_step
from .batches import DT_S, BatchResult, Job, PooledResult, run


def collect_batches(job: Job, workers: int | str | None, step: Callable[[], None]) -> PooledResult:
    """Compute every batch, as `rank` has the keywords; `step` is called after each.

    Place and order of work do not change the result.
    """
    each: Iterator[tuple[int, BatchResult]]
    parts, correct = dict[int, BatchResult](), dict[int, Array]()
    blur = 0.0
    if isinstance(workers, str):
        each = on_cluster(partial(run, job), job.batches, workers, job.key)
    else:
        # At most two batches per thread are in memory.
        each = enumerate(in_order(partial(run, job), range(job.batches), workers or cores()))
    for number, found in each:
        blur = max(blur, _sampling_error(job, found.confusion.swapaxes(0, 1)))
        correct[number] = np.diagonal(found.confusion, axis1=2, axis2=3).swapaxes(0, 1).copy()
        # Confusions are most of a batch, and are needed only as their sum.
        parts[number] = replace(found, confusion=found.confusion.sum(axis=0))
        step()
    ordered = [parts[number] for number in range(job.batches)]

    def joined(name: str) -> Array:
        return np.concatenate([getattr(part, name) for part in ordered])

    # In order, so that the sums do not depend on which batch was ready first.
    shares = np.array([share for _, share in job.shares])
    by_form = normalised(np.asarray(sum(part.confusion for part in ordered)) / job.people)
    reports = np.asarray(sum(part.reported[0] for part in ordered))
    return PooledResult(
        detection=pooled_detection(joined("detected"), joined("cold_share"), reports, report_step(DT_S)),
        reports=joined("detected"),
        pairs=joined("d_prime"),
        pooled=normalised(np.average(by_form, axis=0, weights=shares)),
        shares=shares,
        by_form=np.concatenate([correct[number] for number in range(job.batches)], axis=1),
        bits=joined("bits"),
        plugin=joined("plugin"),
        standard_error=_sampling_error(job, by_form, job.people),
        person_standard_error=blur,
    )


def _sampling_error(job: Job, confusions: Array, people: int = 1) -> float:
    """Largest standard error of a cell of the mean over forms, of (forms, …), to which so many people give answers."""
    icons = len(job.members)
    samples = form_samples(job.forms, icons, len(job.tracks.surfaces))
    exact = {"episodes": icons <= 2, "naming": icons == 1}
    errors = [
        0.0 if exact[form] else share * sampling_error(named, people * samples[form])
        for (form, share), named in zip(job.shares, confusions, strict=True)
    ]
    return float(np.linalg.norm(errors))
