"""The table of left-out predictions, and the run that makes it, which keeps each experiment as it is done."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import lru_cache
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from ..arrays import Array
from .learning import Points, misses_at
from .left_out import leave_out
from .posterior import Posterior
from .results import inputs_digest, read_rows, to_csv
from .rows import load_rows
from .sampling import load_learned, load_vectors
from .scores import Score, score

LEFT_OUT = "left-out.csv"
PART = 25


@dataclass(frozen=True, slots=True)
class LeftOutRow:
    """One row predicted by a posterior that never saw its experiment; numbers in the row's own unit.

    `probability` is that of a smaller number than the published one; `naive` is the log score of the naive baseline,
    NaN where there is none; `k_hat` the shape of the weights' tail, good below 0.7.
    """

    experiment: str
    statistic: str
    channel: str
    label: str
    unit: str
    published: float
    low: float
    lower: float
    median: float
    upper: float
    high: float
    probability: float
    log_score: float
    naive: float
    k_hat: float
    method: str


@lru_cache(maxsize=1)
def load_left_out() -> tuple[LeftOutRow, ...]:
    """The shipped predictions of every row.

    >>> len(load_left_out()) == len(load_rows())
    True
    """
    return tuple(read_rows(LEFT_OUT, LeftOutRow))


def row_of(each: Score) -> LeftOutRow:
    """A score in the row's own unit."""
    row = each.row
    low, lower, median, upper, high = (row.shown(place) for place in each.quantiles)
    return LeftOutRow(
        *row.key,
        row.label,
        row.unit,
        row.shown(row.value),
        low,
        lower,
        median,
        upper,
        high,
        each.probability,
        each.log_score,
        each.baseline,
        each.k_hat,
        each.method,
    )


def leave_each_out(
    keep: Path,
    posterior: Posterior,
    seed: int = 0,
    workers: int = 1,
    progress: Callable[[int, int, str], None] | None = None,
) -> tuple[LeftOutRow, ...]:
    """Every experiment left out in turn, from the chains in a folder; what is done already is read from there."""
    experiments = tuple(dict.fromkeys(row.experiment for row in load_rows()))
    if complete(keep):
        return tuple(row for experiment in experiments for row in _kept(keep, experiment))
    learned = load_learned(keep)
    if learned is None:
        raise ValueError(
            f"{keep}: there are no chains here: run python -m thermicon.perception.evidence sample --keep {keep} first"
        )
    reference, points, _ = learned
    vectors = load_vectors(keep, reference)
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:

        def evaluate(at: Array) -> Array:
            parts = np.array_split(at, max(1, len(at) // PART))
            return np.concatenate(list(pool.map(misses_at, [(posterior, part) for part in parts])))

        file = keep / "draws.npz"
        if not file.exists():
            np.savez(file, vectors=vectors, misses=evaluate(vectors))
        with np.load(file) as arrays:
            draws = Points(arrays["vectors"], arrays["misses"])
        rows: list[LeftOutRow] = []
        for done, experiment in enumerate(experiments):
            if progress is not None:
                progress(done, len(experiments), experiment)
            part = _part(keep, experiment)
            if not part.exists():
                scores = leave_out(posterior, draws, reference, points, seed, evaluate, (experiment,))
                found = [asdict(row_of(score(each))) for each in scores]
                part.write_text(json.dumps(found, indent=1), encoding="utf-8")
            rows += _kept(keep, experiment)
    return tuple(rows)


def complete(keep: Path) -> bool:
    """Whether every experiment was left out in a folder."""
    return all(_part(keep, row.experiment).exists() for row in load_rows())


def _part(keep: Path, experiment: str) -> Path:
    return keep / f"left-out-{experiment}.json"


def _kept(keep: Path, experiment: str) -> list[LeftOutRow]:
    return [LeftOutRow(**each) for each in json.loads(_part(keep, experiment).read_text(encoding="utf-8"))]


def write(rows: Iterable[LeftOutRow], path: Path) -> None:
    """Write the table with the digest of its inputs."""
    head = f"# written by thermicon validate --leave-out from inputs {inputs_digest()}\n"
    path.write_text(head + to_csv(list(rows)), encoding="utf-8")
