"""``python -m thermicon.perception.evidence``: make the shipped results of the inference again, step by step.

``fit`` infers the constants of every variant at the maximum of the posterior. ``sample`` writes 1,000 draws of the
posterior; chains that have not converged are refused without ``--force``. ``leave-out`` infers all constants again
without each experiment in turn and predicts it. ``observer`` writes the parameter file of the observer.
``sample`` and ``leave-out`` keep chains in a folder and go on from there; on one computer the same seed gives the same
draws, however many workers there are and however often the run was interrupted.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from thermicon.circuit.cores import cores
from thermicon.circuit.records import RecordError
from thermicon.icons.atomic import complete_or_absent

from ..observer.channels import VARIABLES, Variable
from ..observer.draws_file import shipped_file, to_text, variant_named
from ..observer.priors import WITHIN_95
from .calibrate import write_observer
from .chains import require_extra
from .learning import CHAINS
from .left_out_table import LEFT_OUT, complete, leave_each_out
from .maximum import LeftOut, Maximum, maximise
from .maximum import leave_each_out as refit_without_each
from .posterior import Posterior, summarise
from .results import CONSTANTS, PREDICTIONS, Constant, PredictedRow, write_rows
from .sampling import LEAST_STEPS, Sampled, approximate_draws, sample

REFUSED = 3
LEAST_STEPS_ASKED, MOST_STEPS, USUAL_STEPS = 100, 100_000, 20_000


def main(words: Sequence[str] | None = None) -> int:
    """Run what the words ask for, and return the exit code: 3 where chains have not converged."""
    asked = parser().parse_args(words)
    if not LEAST_STEPS_ASKED <= asked.steps <= MOST_STEPS:
        parser().error(f"--steps {asked.steps} is outside {LEAST_STEPS_ASKED} to {MOST_STEPS:,}")
    if asked.what == "fit":
        write_fit(tell)
    elif asked.what == "observer":
        write_observer()
    else:
        require_extra()
        if asked.keep is not None:
            asked.keep.mkdir(exist_ok=True)
        return leave_out(asked) if asked.what == "leave-out" else sample_posterior(asked)
    return 0


def parser() -> argparse.ArgumentParser:
    """The words that this program reads."""
    made = argparse.ArgumentParser(
        "python -m thermicon.perception.evidence", description=(__doc__ or "").split("\n")[0]
    )
    made.add_argument("what", choices=("fit", "sample", "leave-out", "observer"))
    made.add_argument("-o", "--output", type=Path, help="the file of draws, or the folder of left-out predictions")
    made.add_argument("--variant", default="temperature", help="what receptors respond to: temperature or heat-flow")
    made.add_argument("--seed", type=int, default=0)
    made.add_argument("--keep", type=Path, metavar="DIR", help="folder of chains; needed by leave-out")
    made.add_argument("--steps", type=int, default=USUAL_STEPS, help=f"most steps of each chain, 100 to {MOST_STEPS:,}")
    made.add_argument("--workers", type=int, default=min(cores(), CHAINS))
    made.add_argument("--force", action="store_true", help="write draws of chains that have not converged, marked")
    return made


def tell(done: int, total: int, words: str = "") -> None:
    """Say on stderr how far it has come."""
    sys.stderr.write(f"\r{done} of {total} {words}".ljust(78))


def write_fit(progress: Callable[[int, int, str], None]) -> None:
    """Infer the constants of every variant, in minutes on one core, and write the tables of the package.

    Draws of the variant that is not sampled are those of the normal approximation at its maximum, and marked as such.
    `progress` gets (done, all, what).
    """

    def fitted(variable: Variable) -> Maximum:
        return maximise(Posterior(variable), progress=lambda done, _: progress(done, 0, f"rounds, {variable}"))

    maxima = {variable: fitted(variable) for variable in VARIABLES}
    left_out = refit_without_each(maxima[VARIABLES[0]], progress)
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


def sample_posterior(asked: argparse.Namespace) -> int:
    """Sample the posterior and write its draws."""
    sampled = sample(
        Posterior(variant_named(asked.variant)),
        asked.seed,
        keep=asked.keep,
        workers=asked.workers,
        least_steps=min(LEAST_STEPS, asked.steps),
        most_steps=asked.steps,
        progress=tell,
    )
    sys.stderr.write("\n")
    draws, found = sampled.draws(), sampled.diagnostics
    for each in summarise(draws):
        remark = "at the edge of its prior" if each.at_edge else "not moved" if each.unmoved else ""
        spans = f"{each.median:10.3g} {each.low:10.3g} {each.high:10.3g} {each.unit:<12} SD left {each.narrowed:.2f}"
        sys.stdout.write(f"{each.name:<44} {spans} {remark}\n")
    sys.stdout.write(f"{draws.header.status}; worst: {found.worst}, {worst_text(sampled)}\n")
    if not found.converged and not asked.force:
        sys.stderr.write("nothing was written: give more --steps and --keep DIR, or --force to write it marked\n")
        return REFUSED
    if asked.output is not None:
        with complete_or_absent(asked.output) as draft:
            draft.write_text(to_text(draws.header, draws.names, draws.draws), encoding="utf-8")
    return 0


def worst_text(sampled: Sampled) -> str:
    """Diagnostics of the constant that has converged least."""
    found = sampled.diagnostics
    place = found.names.index(found.worst)
    return f"R-hat {found.r_hat[place]:.3f}, effective sample size {found.ess[place]:.0f}"


def leave_out(asked: argparse.Namespace) -> int:
    """Leave every experiment out; what is done already is not done again."""
    if asked.keep is None:
        sys.stderr.write("leave-out needs --keep DIR for finished parts\n")
        return 2
    posterior = Posterior()
    if not complete(asked.keep):
        sampled = sample(posterior, asked.seed, keep=asked.keep, workers=asked.workers, progress=tell)
        if not sampled.diagnostics.converged:
            sys.stderr.write(f"\nthe chains in {asked.keep} have not converged: sample with more --steps first\n")
            return REFUSED
    rows = leave_each_out(asked.keep, posterior, asked.seed, asked.workers, tell)
    if asked.output is not None:
        asked.output.mkdir(exist_ok=True)
        write_rows(rows, LEFT_OUT, "leave-out", asked.output)
    inside = sum(each.covered(0.95) for each in rows)
    sys.stdout.write(f"\n{inside} of {len(rows)} rows lie inside their 95 % interval\n")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (RecordError, OSError) as problem:
        sys.exit(str(problem))
