"""Which variant predicts experiments that it never saw best: left-out log scores and stacking weights.

`python -m thermicon.perception.posterior.variant_scores` writes the table, in tens of minutes; each variant is refitted
at its own maximum without each experiment, and predicts by the normal approximation there.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing import get_context

import numpy as np

from ..arrays import Array
from ..inference.evidence import DATA
from ..inference.leave_out import leave_each_out
from ..inference.maximum import maximise
from ..inference.posterior import Posterior
from ..inference.results import inputs_digest, read_rows, to_csv
from ..inference.rows import load_rows
from ..kernels.parallel import quiet_blas
from ..observer.variants import VARIANTS, Model, Variable
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
    ring_de_dear: float


@lru_cache(maxsize=1)
def load_variant_scores() -> tuple[VariantScores, ...]:
    """The shipped scores.

    >>> len(load_variant_scores()) == len(load_rows())
    True
    """
    return tuple(read_rows(SCORES, VariantScores))


def variant_log_scores() -> Array:
    """Log scores (variants, rows) of the shipped table."""
    rows = load_variant_scores()
    return np.array([[getattr(row, name) for row in rows] for name in ("temperature", "heat_flow", "ring_de_dear")])


def variant_weights() -> dict[tuple[Variable, Model], float]:
    """Weights of the variants that predict the left-out rows best as a mixture.

    >>> round(sum(variant_weights().values()), 6)
    1.0
    """
    return dict(zip(VARIANTS, stacking_weights(variant_log_scores()).tolist(), strict=True))


def log_scores_of(variant: tuple[Variable, Model]) -> list[float]:
    """Log scores of all rows by one variant, each by a fit without its experiment."""
    posterior = Posterior(*variant)
    with quiet_blas():
        whole = maximise(posterior, shipped_vector(posterior))
        return [out.log_score for out in leave_each_out(whole)]


def main() -> None:
    """Write the table of the package."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        scores = list(pool.map(log_scores_of, VARIANTS))
    rows = [VariantScores(*row.key, *(each[k] for each in scores)) for k, row in enumerate(load_rows())]
    head = f"# written by python -m thermicon.perception.posterior.variant_scores from inputs {inputs_digest()}\n"
    (DATA / SCORES).write_text(head + to_csv(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
