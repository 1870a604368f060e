"""``python -m thermicon.perception.evidence``: make the shipped results of the inference again.

``fit`` infers the constants of every variant, and again without each experiment in turn to predict it (``--shipped``:
predictions at the constants there are); ``sample`` writes draws of the posterior; ``observer`` the parameter file, and
the spans of what the experiments varied.
"""

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from thermicon.base.files.atomic import complete_or_absent
from thermicon.base.files.records import RecordError, dump_records
from thermicon.base.numbers.cores import cores

from ..observer.channels import VARIABLES
from ..observer.draws_file import shipped_file, to_text
from ..observer.observer import DATA
from ..observer.priors import WITHIN_95
from .calibrate import COMMENT, calibrate
from .chains import CHAINS, require_extra
from .posterior import LeftOut, Maximum, Posterior, leave_each_out, maximise
from .results import CONSTANTS, PREDICTIONS, SPANS, Constant, PredictedRow, write_rows
from .sampling import LEAST_STEPS, approximate_draws, at_shipped, sample
from .spans import spans_of

REFUSED = 3
LEAST_STEPS_ASKED, MOST_STEPS, USUAL_STEPS = 100, 100_000, 20_000


def main(words: Sequence[str] | None = None) -> int:
    """Run what the words ask for, and return the exit code: 3 where chains have not converged."""
    asked = parser().parse_args(words)
    if not LEAST_STEPS_ASKED <= asked.steps <= MOST_STEPS:
        parser().error(f"--steps {asked.steps} is outside {LEAST_STEPS_ASKED} to {MOST_STEPS:,}")
    if asked.what == "sample":
        require_extra()
        return sample_posterior(asked)
    if asked.what == "observer":
        (DATA / "observer.toml").write_text(dump_records(calibrate(), comment=COMMENT), encoding="utf-8")
        write_rows(spans_of(), SPANS)
    elif asked.shipped:
        found = [at_shipped(Posterior(variable)) for variable in VARIABLES]
        write_rows(predictions_of(found, leave_each_out(found[0], tell)), PREDICTIONS)
    else:
        write_fit()
    return 0


def parser() -> argparse.ArgumentParser:
    """The words that this program reads."""
    made = argparse.ArgumentParser(
        "python -m thermicon.perception.evidence", description=(__doc__ or "").split("\n")[0]
    )
    made.add_argument("what", choices=("fit", "sample", "observer"))
    made.add_argument("--shipped", action="store_true", help="fit: keep the constants, write predictions at them")
    made.add_argument("-o", "--output", type=Path, help="the file of draws")
    made.add_argument("--seed", type=int, default=0)
    made.add_argument("--steps", type=int, default=USUAL_STEPS, help=f"most steps of each chain, 100 to {MOST_STEPS:,}")
    made.add_argument("--workers", type=int, default=min(cores(), CHAINS))
    return made


def tell(done: int, total: int, words: str = "") -> None:
    """Say on stderr how far it has come."""
    sys.stderr.write(f"\r{done} of {total} {words}".ljust(78))


def write_fit() -> None:
    """Infer the constants of every variant, in minutes on one core, and write the tables of the package.

    Draws of the variant that is not sampled are those of the normal approximation, and marked as such.
    """
    maxima = [
        maximise(Posterior(variable), progress=partial(tell, total=0, words=f"rounds, {variable}"))
        for variable in VARIABLES
    ]
    write_rows([row for found in maxima for row in constants_of(found)], CONSTANTS)
    write_rows(predictions_of(maxima, leave_each_out(maxima[0], tell)), PREDICTIONS)
    for found in maxima[1:]:
        drawn = approximate_draws(found)
        text = to_text(drawn.header, drawn.names, drawn.draws)
        shipped_file(found.posterior.variable).write_text(text, encoding="utf-8")


def constants_of(whole: Maximum) -> list[Constant]:
    """The constants of one variant."""
    rows, variant = [], whole.posterior.variable
    for prior, sd in zip(whole.posterior.priors.each, whole.sd.tolist(), strict=True):
        ends = (*whole.interval(prior.name), *prior.interval)
        value = whole.values[prior.name]
        rows.append(Constant(variant, prior.name, prior.unit, value, *ends, sd, prior.mechanism, prior.source))
    return rows


def predictions_of(maxima: Sequence[Maximum], left_out: Sequence[LeftOut]) -> list[PredictedRow]:
    """The table of rows: published, fitted by each variant, predicted when left out."""
    table = []
    for out in left_out:
        row = out.row
        published, low, high = (row.shown(row.value + side * WITHIN_95 * row.sd) for side in (0.0, -1.0, 1.0))
        fitted, heat_flow = (row.shown(found.predictions[row.key]) for found in maxima)
        middle, least, most = map(row.shown, (out.predicted, *out.interval))
        numbers = (low, high, fitted, heat_flow, middle, least, most, out.score, out.log_score)
        table.append(PredictedRow(*row.key, row.label, row.unit, published, *numbers))
    return table


def sample_posterior(asked: argparse.Namespace) -> int:
    """Sample the posterior and write its draws."""
    steps = {"least_steps": min(LEAST_STEPS, asked.steps), "most_steps": asked.steps}
    sampled = sample(Posterior(), asked.seed, workers=asked.workers, progress=tell, **steps)
    sys.stderr.write("\n")
    sys.stdout.write(f"{sampled.diagnostics}\n")
    if not sampled.diagnostics.converged:
        sys.stderr.write("nothing was written: give more --steps\n")
        return REFUSED
    if asked.output is not None:
        draws = sampled.draws()
        with complete_or_absent(asked.output) as draft:
            draft.write_text(to_text(draws.header, draws.names, draws.draws), encoding="utf-8")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (RecordError, OSError) as problem:
        sys.exit(str(problem))
