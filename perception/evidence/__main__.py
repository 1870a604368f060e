"""``python -m thermicon.perception.evidence``: make the shipped results of the inference again, step by step.

``fit`` infers the constants of every variant at the maximum of the posterior. ``sample`` writes 1,000 draws of the
posterior; chains that have not converged are refused. ``leave-out`` infers all constants again without each experiment
in turn and predicts it, from the chains that ``sample`` kept. ``observer`` writes the parameter file of the observer.
On one computer the same seed gives the same draws, however many workers there are; ``leave-out`` goes on where it was
interrupted.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from thermicon.circuit.cores import cores
from thermicon.circuit.records import RecordError
from thermicon.icons.atomic import complete_or_absent

from ..observer.channels import VARIABLES, Variable
from ..observer.draws_file import shipped_file, to_text
from .calibrate import write_observer
from .chains import CHAINS, require_extra
from .left_out import leave_each_out
from .posterior import Maximum, Posterior, maximise, summarise
from .results import CONSTANTS, LEFT_OUT, Constant, write_rows
from .sampling import LEAST_STEPS, Sampled, approximate_draws, sample

REFUSED = 3
LEAST_STEPS_ASKED, MOST_STEPS, USUAL_STEPS = 100, 100_000, 20_000
KEPT = "sampled.npz"
"""What `sample` keeps and `leave-out` goes on from."""


def main(words: Sequence[str] | None = None) -> int:
    """Run what the words ask for, and return the exit code: 3 where chains have not converged."""
    asked = parser().parse_args(words)
    if not LEAST_STEPS_ASKED <= asked.steps <= MOST_STEPS:
        parser().error(f"--steps {asked.steps} is outside {LEAST_STEPS_ASKED} to {MOST_STEPS:,}")
    if asked.what == "leave-out" and asked.keep is None:
        parser().error("leave-out needs --keep DIR, with the chains that sample kept there")
    if asked.what == "fit":
        write_fit()
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
    made.add_argument("--seed", type=int, default=0)
    made.add_argument("--keep", type=Path, metavar="DIR", help="folder of what sample found; needed by leave-out")
    made.add_argument("--steps", type=int, default=USUAL_STEPS, help=f"most steps of each chain, 100 to {MOST_STEPS:,}")
    made.add_argument("--workers", type=int, default=min(cores(), CHAINS))
    return made


def tell(done: int, total: int, words: str = "") -> None:
    """Say on stderr how far it has come."""
    sys.stderr.write(f"\r{done} of {total} {words}".ljust(78))


def write_fit() -> None:
    """Infer the constants of every variant, in minutes on one core, and write the tables of the package.

    Draws of the variant that is not sampled are those of the normal approximation at its maximum, and marked as such.
    """

    def fitted(variable: Variable) -> Maximum:
        return maximise(Posterior(variable), progress=lambda done: tell(done, 0, f"rounds, {variable}"))

    maxima = [fitted(variable) for variable in VARIABLES]
    write_rows([row for found in maxima for row in constants_of(found)], CONSTANTS, "fit")
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


def sample_posterior(asked: argparse.Namespace) -> int:
    """Sample the posterior and write its draws."""
    sampled = sample(
        Posterior(),
        asked.seed,
        workers=asked.workers,
        least_steps=min(LEAST_STEPS, asked.steps),
        most_steps=asked.steps,
        progress=tell,
    )
    sys.stderr.write("\n")
    draws = sampled.draws()
    for each in summarise(draws):
        remark = "at the edge of its prior" if each.at_edge else "not moved" if each.unmoved else ""
        spans = f"{each.median:10.3g} {each.low:10.3g} {each.high:10.3g} {each.unit:<12} SD left {each.narrowed:.2f}"
        sys.stdout.write(f"{each.name:<44} {spans} {remark}\n")
    sys.stdout.write(f"{draws.header.status}; worst: {worst_text(sampled)}\n")
    if not sampled.diagnostics.converged:
        sys.stderr.write("nothing was written: give more --steps\n")
        return REFUSED
    if asked.keep is not None:
        sampled.save(asked.keep / KEPT)
    if asked.output is not None:
        with complete_or_absent(asked.output) as draft:
            draft.write_text(to_text(draws.header, draws.names, draws.draws), encoding="utf-8")
    return 0


def worst_text(sampled: Sampled) -> str:
    """Diagnostics of the constant that has converged least."""
    found = sampled.diagnostics
    place = found.names.index(found.worst)
    return f"{found.worst}, R-hat {found.r_hat[place]:.3f}, effective sample size {found.ess[place]:.0f}"


def leave_out(asked: argparse.Namespace) -> int:
    """Leave every experiment out; what is done already is not done again."""
    if not (asked.keep / KEPT).exists():
        raise RecordError(f"there are no chains in {asked.keep}: run sample --keep {asked.keep} first")
    rows = leave_each_out(asked.keep / KEPT, asked.seed, asked.workers, tell)
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
