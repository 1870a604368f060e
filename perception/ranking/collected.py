"""All batches of a ranking pooled in their order."""

from collections.abc import Callable, Iterator
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

ROWS = ("detected", "cold_share", "d_prime", "bits", "plugin")
"""Fields of a batch that have a row for each person."""


def collect_batches(job: Job, workers: int | str | None, step: Callable[[], None]) -> PooledResult:
    """Compute every batch, as `rank` has the keywords; `step` is called after each.

    Place and order of work do not change the result.
    """
    each: Iterator[tuple[int, BatchResult]]
    rows, waiting = dict[int, dict[str, Array]](), dict[int, tuple[Array, Array]]()
    confusions: Array | float = 0.0
    reports: Array | float = 0.0
    added, blur = 0, 0.0
    if isinstance(workers, str):
        each = on_cluster(partial(run, job), job.batches, workers, job.key)
    else:
        # At most two batches per thread are in memory.
        each = enumerate(in_order(partial(run, job), range(job.batches), workers or cores()))
    for number, found in each:
        blur = max(blur, _sampling_error(job, found.confusion.swapaxes(0, 1)))
        rows[number] = {name: getattr(found, name) for name in ROWS}
        rows[number]["correct"] = np.diagonal(found.confusion, axis1=2, axis2=3).copy()
        # Confusions and reports are most of a batch, and are needed only as their sums.
        waiting[number] = found.confusion.sum(axis=0), found.reported[0]
        while added in waiting:  # in order, so that sums do not depend on which batch was ready first
            confusion, reported = waiting.pop(added)
            confusions, reports, added = confusions + confusion, reports + reported, added + 1
        step()

    def joined(name: str) -> Array:
        return np.concatenate([rows[number].pop(name) for number in range(job.batches)])

    shares, detected = np.array([share for _, share in job.shares]), joined("detected")
    by_form = normalised(np.asarray(confusions) / job.people)
    return PooledResult(
        detection=pooled_detection(detected, joined("cold_share"), np.asarray(reports), report_step(DT_S)),
        reports=detected,
        pairs=joined("d_prime"),
        pooled=normalised(np.average(by_form, axis=0, weights=shares)),
        shares=shares,
        by_form=np.ascontiguousarray(joined("correct").swapaxes(0, 1)),
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
