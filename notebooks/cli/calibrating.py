"""``thermicon calibrate``: sample the posterior of all constants from the shipped evidence, and write its draws."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ..files.outputs import STDOUT, check_folder, check_output, complete_or_absent
from ..text.messages import REFUSED, note, progress_bar, usage

if TYPE_CHECKING:
    from thermicon.perception.posterior.sampling import Sampled

VariantName = Literal["temperature", "heat-flow", "ring-de-dear"]
MOST_STEPS = 100_000


def calibrate_command(
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FILE", readable=False, help="Write the draws to this .csv file."),
    ] = Path("posterior.csv"),
    variant: Annotated[VariantName, typer.Option("--variant", help="What receptors respond to.")] = "temperature",
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the chains.")] = 0,
    keep: Annotated[
        Path | None,
        typer.Option(
            "--keep", metavar="DIR", readable=False, help="Keep the chains here; a later run goes on from them."
        ),
    ] = None,
    steps: Annotated[int, typer.Option("--steps", metavar="N", help="Most steps of each of the 4 chains.")] = 20_000,
    workers: Annotated[
        int | None,
        typer.Option("--workers", metavar="N", help="Number of processes.  [default: the cores there are, up to 4]"),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write draws of chains that have not converged; the file is marked.")
    ] = False,
) -> None:
    """Infer all constants of the observer together: sample their posterior and write 1,000 draws as a table.

    Evidence and priors are the shipped ones. Chains run until every constant has converged (R-hat below 1.01, bulk
    effective sample size above 600) or --steps is reached. What did not converge is refused without --force. The same
    seed gives the same draws, however many workers there are and however often the run was interrupted.
    """
    for option, value, least, most in (
        ("--seed", seed, 0, 2**32 - 1),
        ("--steps", steps, 100, MOST_STEPS),
        ("--workers", workers if workers is not None else 1, 1, 8),
    ):
        if not least <= value <= most:
            raise usage(f"{value} is outside {least} to {most}", option)
    check_output(output, (".csv",), "a table of draws")
    if keep is not None:
        check_folder(keep)
    from thermicon.circuit.solver.cores import cores
    from thermicon.perception.inference.posterior import Posterior
    from thermicon.perception.observer.draws_file import to_text, variant_named
    from thermicon.perception.posterior.diagnostics import require_extra
    from thermicon.perception.posterior.learning import CHAINS
    from thermicon.perception.posterior.sampling import LEAST_STEPS, sample

    require_extra()
    with progress_bar("sampling") as bar:

        def progress(done: int, total: int, words: str) -> None:
            if bar is not None:
                bar(done, total)

        sampled = sample(
            Posterior(*variant_named(variant)),
            seed,
            keep=keep,
            workers=min(cores(), CHAINS) if workers is None else workers,
            least_steps=min(LEAST_STEPS, steps),
            most_steps=steps,
            progress=progress,
        )
    if output != STDOUT:
        _report(sampled)
    if not sampled.diagnostics.converged and not force:
        note(
            f"{output} was not written: {sampled.diagnostics.worst} has not converged "
            f"({_worst(sampled)}). Give more --steps{'' if keep else ' and --keep DIR'}, or --force to write it marked."
        )
        raise typer.Exit(REFUSED)
    draws = sampled.draws()
    text = to_text(draws.header, draws.names, draws.draws)
    if output == STDOUT:
        typer.echo(text, nl=False)
        return
    with complete_or_absent(output) as draft:
        draft.write_text(text, encoding="utf-8")
    note(f"wrote {output}")


def _report(sampled: Sampled) -> None:
    """Print diagnostics and every constant: median, 95 % interval, and what the evidence left of its prior."""
    from thermicon.perception.posterior.summaries import summarise

    from ..text.tables import show, table

    draws = sampled.draws()
    rows = table(
        "constant", "median", "low", "high", "unit", "SD left", "", numbers=("median", "low", "high", "SD left")
    )
    for each in summarise(draws):
        remark = "at the edge of its prior" if each.at_edge else "not moved" if each.unmoved else ""
        numbers = (f"{each.median:.3g}", f"{each.low:.3g}", f"{each.high:.3g}")
        rows.add_row(each.name, *numbers, each.unit, f"{each.narrowed:.2f}", remark)
    show(
        f"Posterior of {len(draws.names)} constants, {', '.join(draws.variant)}",
        rows,
        f"{draws.header.status}; {sampled.likelihoods} likelihoods, {100.0 * sampled.acceptance:.0f} % accepted. "
        "SD left is the SD over the prior's: near 1 the evidence did not move the constant. Offsets of laboratories "
        "(E1 cold …) are in SDs of the spread between laboratories.",
    )


def _worst(sampled: Sampled) -> str:
    found = sampled.diagnostics
    place = found.names.index(found.worst)
    return f"R-hat {found.r_hat[place]:.3f}, limit 1.01; effective sample size {found.ess[place]:.0f}, limit 400"
