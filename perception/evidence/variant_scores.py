"""Which variant predicts experiments that it never saw best: left-out log scores and stacking weights.

Each variant is refitted at its own maximum without each experiment, in tens of minutes, and predicts by the normal
approximation there.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from thermicon.circuit.cores import quiet_blas

from ..arrays import Array
from ..observer.variants import VARIABLES, Variable
from .leave_out import leave_each_out
from .maximum import maximise
from .posterior import Posterior
from .results import inputs_digest, read_rows, to_csv
from .rows import load_rows
from .sampling import shipped_vector
from .scores import stacking_weights

SCORES = "variant-scores.csv"


@dataclass(frozen=True, slots=True)
class VariantScores:
    """Log scores of one left-out row by each variant: log densities of the published number on the row's scale."""

    experiment: str
    statistic: str
    channel: str
    temperature: float
    heat_flow: float


@lru_cache(maxsize=1)
def load_variant_scores() -> tuple[VariantScores, ...]:
    """The shipped scores.

    >>> len(load_variant_scores()) == len(load_rows())
    True
    """
    return tuple(read_rows(SCORES, VariantScores))


def variant_log_scores(rows: Sequence[VariantScores] | None = None) -> Array:
    """Log scores (variants, rows) of a table (None: the shipped one)."""
    rows = load_variant_scores() if rows is None else rows
    return np.array([[getattr(row, name) for row in rows] for name in ("temperature", "heat_flow")])


def variant_weights(rows: Sequence[VariantScores] | None = None) -> dict[Variable, float]:
    """Weights of the variants that predict the left-out rows best as a mixture.

    >>> round(sum(variant_weights().values()), 6)
    1.0
    """
    return dict(zip(VARIABLES, stacking_weights(variant_log_scores(rows)).tolist(), strict=True))


def log_scores_of(variant: Variable) -> list[float]:
    """Log scores of all rows by one variant, each by a fit without its experiment."""
    posterior = Posterior(variant)
    with quiet_blas():
        whole = maximise(posterior, shipped_vector(posterior))
        return [out.log_score for out in leave_each_out(whole)]


def score_variants(keep: Path, workers: int = 1) -> tuple[VariantScores, ...]:
    """Log scores of every row by every variant; those of a variant that is done are read from the folder."""
    todo = [variant for variant in VARIABLES if not _part(keep, variant).exists()]
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for variant, scores in zip(todo, pool.map(log_scores_of, todo), strict=True):
            _part(keep, variant).write_text(json.dumps(scores), encoding="utf-8")
    each = [json.loads(_part(keep, variant).read_text(encoding="utf-8")) for variant in VARIABLES]
    return tuple(VariantScores(*row.key, *(scores[k] for scores in each)) for k, row in enumerate(load_rows()))


def write(rows: Sequence[VariantScores], path: Path) -> None:
    """Write the table with the digest of its inputs."""
    head = f"# written by thermicon validate --leave-out from inputs {inputs_digest()}\n"
    path.write_text(head + to_csv(rows), encoding="utf-8")


def _part(keep: Path, variant: Variable) -> Path:
    return keep / f"scores-{variant.replace(' ', '-')}.json"
