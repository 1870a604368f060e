"""The maximum of the posterior as shipped tables: constants, predictions in and out of the fit, and draws around it.

Draws are those of the variant that is not sampled, from the normal approximation at its maximum, and marked as such.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ..observer.draws_file import shipped_file, to_text
from ..observer.priors import WITHIN_95
from ..observer.variants import VARIABLES, Variable
from .maximum import LeftOut, Maximum, leave_each_out, maximise
from .posterior import Posterior
from .results import CONSTANTS, PREDICTIONS, Constant, PredictedRow, write_rows
from .sampling import approximate_draws


def write_fit(progress: Callable[[int, int, str], None]) -> None:
    """Infer the constants of every variant, in minutes on one core, and write the tables of the package.

    `progress` gets (done, all, what).
    """

    def fitted(variable: Variable) -> Maximum:
        return maximise(Posterior(variable), progress=lambda done, _: progress(done, 0, f"rounds, {variable}"))

    maxima = {variable: fitted(variable) for variable in VARIABLES}
    left_out = leave_each_out(maxima[VARIABLES[0]], progress)
    write_rows([row for found in maxima.values() for row in constants_of(found)], CONSTANTS, "fit")
    write_rows(predictions_of(maxima, left_out), PREDICTIONS, "fit")
    for variable in VARIABLES[1:]:
        drawn = approximate_draws(maxima[variable])
        shipped_file(variable).write_text(to_text(drawn.header, drawn.names, drawn.draws), encoding="utf-8")


def constants_of(whole: Maximum) -> list[Constant]:
    """The constants of one variant."""
    rows, variant = [], whole.posterior.variable
    for prior, sd in zip(whole.posterior.priors.each, whole.sd.tolist(), strict=True):
        ends = (*whole.interval(prior.name), *prior.interval)
        value = whole.values[prior.name]
        rows.append(Constant(variant, prior.name, prior.unit, value, *ends, sd, prior.mechanism, prior.source))
    return rows


def predictions_of(maxima: Mapping[Variable, Maximum], left_out: Sequence[LeftOut]) -> list[PredictedRow]:
    """The table of rows: published, fitted by each variant, predicted when left out."""
    table = []
    for out in left_out:
        row = out.row
        ends = [row.shown(row.value + side * WITHIN_95 * row.sd) for side in (-1.0, 1.0)]
        fitted = [row.shown(maxima[variable].predictions[row.key]) for variable in VARIABLES]
        predicted = [row.shown(place) for place in (out.predicted, *out.interval)]
        numbers = (row.shown(row.value), *ends, *fitted, *predicted, out.score, out.log_score)
        table.append(PredictedRow(*row.key, row.label, row.unit, *numbers))
    return table
