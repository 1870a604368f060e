"""The table of left-out predictions, and the run that makes it, which keeps each experiment as it is done.

A naive baseline knows no model: it predicts a row by the mean and spread of the same kind of number in the other
experiments. Rows of a kind that no two other experiments have are not compared with it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import lru_cache
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..observer.observer import load_thresholds
from .learning import Points, misses_at
from .left_out import Predictive, leave_out
from .posterior import Posterior
from .results import read_rows
from .rows import Row, load_rows
from .sampling import load_learned, load_vectors

LEFT_OUT = "left-out.csv"
PART = 25
SHARES = (0.025, 0.25, 0.5, 0.75, 0.975)
"""Shares of the quantiles: both ends of the 95 % interval, of the 50 % interval, and the median."""
LN10 = math.log(10.0)
KINDS: Mapping[str, tuple[str, float]] = {
    "threshold_gm": ("threshold", 1.0),
    "threshold50_gm_age30": ("threshold", 1.0),
    "cold_change_at_report_peak1_age_lt36": ("threshold", 1.0),
    "detection threshold": ("threshold", 1.0),
    "rt_between_sd_ln_5strip_onset_clock": ("between people", 1.0),
    "between_sd_log10_noise_removed": ("between people", LN10),
    "threshold_between_sd_log10_noise_removed": ("between people", LN10),
    "between_people_sd_peak1_age_lt36": ("between people", 1.0),
    "spread of detection thresholds": ("between people", 1.0),
    "rt_within_sd_ln_5strip_onset_clock": ("within people", 1.0),
    "within_sd_log10_median_person": ("within people", LN10),
    "within_sd_ln_peak1": ("within people", 1.0),
    "rt_cold_warm_correlation_5strip_onset_clock": ("correlation", 1.0),
    "cold_warm_correlation_log": ("correlation", 1.0),
    "cold_warm_threshold_correlation_person_fits": ("correlation", 1.0),
}
"""Kind of each statistic that several experiments have, and what its value is multiplied by to compare them."""
FEWEST = 2
"""Other experiments that a baseline needs: one has no spread."""


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

    @classmethod
    def of(cls, each: Predictive) -> LeftOutRow:
        """A prediction with its scores."""
        row = each.row
        low, lower, median, upper, high = (row.shown(each.quantile(share)) for share in SHARES)
        published, scores = row.shown(row.value), (each.probability, each.log_score, naive_log_score(row), each.k_hat)
        ends = (published, low, lower, median, upper, high)
        return cls(*row.key, row.label, row.unit, *ends, *scores, each.method)

    def covered(self, share: float) -> bool:
        """Whether the central interval of a share contains the published number."""
        return abs(self.probability - 0.5) <= 0.5 * share


@lru_cache(maxsize=1)
def load_left_out() -> tuple[LeftOutRow, ...]:
    """The shipped predictions of every row.

    >>> len(load_left_out()) == len(load_rows())
    True
    """
    return tuple(read_rows(LEFT_OUT, LeftOutRow))


def naive_log_score(row: Row) -> float:
    """Log density of a row under the mean and spread of its kind in the other experiments; NaN where there are few."""
    kind = KINDS.get(row.key[1])
    if kind is None:
        return math.nan
    others = [
        _comparable(other)
        for other in load_rows()
        if other.experiment != row.experiment
        and other.key[2] == row.key[2]
        and KINDS.get(other.key[1], ("", 1.0))[0] == kind[0]
    ]
    if len(others) < FEWEST:
        return math.nan
    spread = float(np.std(others, ddof=1)) * math.sqrt(1.0 + 1.0 / len(others))
    sd = math.hypot(spread, kind[1] * row.sd)
    miss = (_comparable(row) - float(np.mean(others))) / sd
    # A density on the comparable scale is the factor times smaller than on the row's own.
    return -0.5 * miss**2 - math.log(sd * math.sqrt(2.0 * math.pi)) + math.log(kind[1])


def _comparable(row: Row) -> float:
    """The published number where it can be compared with others of its kind."""
    value = KINDS[row.key[1]][1] * row.value
    if row.key[1] == "detection threshold":
        # The row holds a multiple of the published threshold, 1; the kind compares thresholds in K.
        value += math.log(load_thresholds().one("detection threshold", channel=row.key[2], site=row.key[0]).central)
    return value


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
        for done, experiment in enumerate(experiments):
            if progress is not None:
                progress(done, len(experiments), experiment)
            part = _part(keep, experiment)
            if not part.exists():
                left_out = leave_out(experiment, posterior, draws, reference, points, seed, evaluate)
                found = [asdict(LeftOutRow.of(each)) for each in left_out]
                part.write_text(json.dumps(found, indent=1), encoding="utf-8")
    return leave_each_out(keep, posterior)


def complete(keep: Path) -> bool:
    """Whether every experiment was left out in a folder."""
    return all(_part(keep, row.experiment).exists() for row in load_rows())


def _part(keep: Path, experiment: str) -> Path:
    return keep / f"left-out-{experiment}.json"


def _kept(keep: Path, experiment: str) -> list[LeftOutRow]:
    return [LeftOutRow(**each) for each in json.loads(_part(keep, experiment).read_text(encoding="utf-8"))]
