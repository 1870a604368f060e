"""Infer the constants again and write the shipped tables: ``python -m thermicon.perception.evidence.run``.

Minutes on one core: the maximum of each variant, refits without each experiment, and the ablation.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tqdm import tqdm

from ..observer.priors import WITHIN_95
from .ablation import Ablated, ablate
from .leave_out import LeftOut, leave_each_out
from .maximum import Maximum, maximise
from .posterior import Posterior
from .results import (
    ABLATION,
    CONSTANTS,
    PREDICTIONS,
    AblatedRow,
    Constant,
    PredictedRow,
    inputs_digest,
    to_csv,
)
from .rows import load_rows
from .statistics import DATA


def main() -> None:
    """Write the three tables of the package."""
    with _bar("maximum", " rounds") as bar:
        whole = maximise(Posterior(), progress=lambda done, _: _show(bar, done))
    with _bar("left out", " experiments") as bar:
        left_out = leave_each_out(whole, lambda done, all_, name: _show(bar, done, all_, name))
    with _bar("ablation", " runs") as bar:
        ablated = ablate(progress=lambda done, all_, name: _show(bar, done, all_, name))
    head = f"# written by python -m thermicon.perception.evidence.run from inputs {inputs_digest()}\n"
    for name, rows in (
        (CONSTANTS, [row for run in ablated if not run.name for row in constants_of(run.maximum)]),
        (PREDICTIONS, predictions_of(whole, left_out, ablated)),
        (ABLATION, ablation_of(ablated)),
    ):
        (DATA / name).write_text(head + to_csv(rows), encoding="utf-8")


def constants_of(whole: Maximum) -> list[Constant]:
    """The constants of one variant."""
    rows, variant = [], whole.posterior.variable
    for prior, sd in zip(whole.posterior.priors.each, whole.sd.tolist(), strict=True):
        ends = (*whole.interval(prior.name), *prior.interval)
        value = whole.values[prior.name]
        rows.append(Constant(variant, prior.name, prior.unit, value, *ends, sd, prior.mechanism, prior.source))
    return rows


def predictions_of(whole: Maximum, left_out: Sequence[LeftOut], ablated: Sequence[Ablated]) -> list[PredictedRow]:
    """The table of rows: published, fitted by each variant, predicted when left out."""
    variants = {run.variant: run.maximum.predictions for run in ablated if not run.name}
    table = []
    for out in left_out:
        row = out.row
        ends = [row.shown(row.value + side * WITHIN_95 * row.sd) for side in (-1.0, 1.0)]
        predicted = [row.shown(place) for place in (out.predicted, *out.interval)]
        table.append(
            PredictedRow(
                *row.key,
                row.label,
                row.unit,
                row.shown(row.value),
                published_low=ends[0],
                published_high=ends[1],
                fitted=row.shown(whole.predictions[row.key]),
                heat_flow=row.shown(variants["heat flow"][row.key]),
                left_out=predicted[0],
                left_out_low=predicted[1],
                left_out_high=predicted[2],
                score=out.score,
                log_score=out.log_score,
            )
        )
    return table


def ablation_of(ablated: Sequence[Ablated]) -> list[AblatedRow]:
    """The table of runs."""
    labels = {row.key: row.label for row in load_rows()}
    whole = {run.variant: run.maximum.log_evidence for run in ablated if not run.name}
    table = []
    for run in ablated:
        missed, evidence = run.maximum.missed(), run.maximum.log_evidence
        worst = max(missed, key=lambda key: abs(missed[key]))
        gain = evidence - whole[run.variant if run.name else ablated[0].variant]
        table.append(AblatedRow(run.variant, run.name, evidence, gain, run.squares, labels[worst], missed[worst]))
    return table


def _bar(what: str, unit: str) -> tqdm[Any]:
    return tqdm(desc=what, unit=unit)


def _show(bar: tqdm[Any], done: int, total: int | None = None, name: str = "") -> None:
    bar.total = total
    bar.update(done - bar.n)
    bar.set_postfix_str(name)


if __name__ == "__main__":
    main()
