"""``thermicon validate --leave-out``: every experiment predicted by a posterior that never saw it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.userfolder import cache_folder, private_folder

from ..files.outputs import check_folder, complete_or_absent
from ..messages import fail, note, progress_bar
from ..report.tables import show, table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from thermicon.perception.evidence.left_out_file import LeftOutRow

FOLDER = "leave-out"


def leave_out_files(output: Path | None, keep: Path | None, seed: int) -> None:
    """Sample the posterior, leave every experiment out, score the variants; what is done already is not done again."""
    from thermicon.circuit.cores import cores
    from thermicon.perception.evidence import left_out_file, variant_scores
    from thermicon.perception.evidence.diagnostics import require_extra
    from thermicon.perception.evidence.learning import CHAINS
    from thermicon.perception.evidence.posterior import Posterior
    from thermicon.perception.evidence.posterior_tables import scores_sentence, variants_sentence
    from thermicon.perception.evidence.sampling import sample

    require_extra()
    if output is not None:
        check_folder(output)
    folder = _folder(keep)
    note(f"finished parts are kept in {folder}: the same command goes on from there")
    posterior, workers = Posterior(), min(cores(), CHAINS)
    if not left_out_file.complete(folder):
        with progress_bar("sampling") as bar:
            sampled = sample(
                posterior,
                seed,
                keep=folder,
                workers=workers,
                progress=None if bar is None else lambda done, total, _: bar(done, total),
            )
        if not sampled.diagnostics.converged:
            fail(
                f"the chains in {folder} have not converged: run thermicon calibrate --keep {folder} with more --steps"
            )
    with progress_bar("leaving out") as bar:
        rows = left_out_file.leave_each_out(
            folder, posterior, seed, workers, None if bar is None else lambda done, total, _: bar(done, total)
        )
    note("scoring the variants: temperature, heat flow")
    variants = variant_scores.score_variants(folder, workers)
    if output is not None:
        output.mkdir(exist_ok=True)
        with complete_or_absent(output / left_out_file.LEFT_OUT) as draft:
            left_out_file.write(rows, draft)
        with complete_or_absent(output / variant_scores.SCORES) as draft:
            variant_scores.write(variants, draft)
        note(f"wrote {left_out_file.LEFT_OUT} and {variant_scores.SCORES} to {output}")
    show("Experiments predicted by a posterior that never saw them", _by_experiment(rows), "")
    show(scores_sentence(rows), "", variants_sentence(variants))


def _folder(keep: Path | None) -> Path:
    if keep is not None:
        check_folder(keep)
        keep.mkdir(exist_ok=True)
        return keep
    from thermicon.perception.evidence.results import inputs_digest

    own = cache_folder() / FOLDER / inputs_digest()
    try:
        private_folder(own)
    except OSError as error:
        fail(f"{own} cannot be used for finished parts ({error.strerror or error}): give a folder with --keep DIR")
    return own


def _by_experiment(rows: Sequence[LeftOutRow]) -> Table:
    numbers = ("rows", "in 50 %", "in 95 %", "log score", "k-hat")
    made = table("experiment", *numbers, numbers=numbers)
    for experiment in dict.fromkeys(row.experiment for row in rows):
        own = [row for row in rows if row.experiment == experiment]
        inside = [sum(abs(row.probability - 0.5) <= 0.5 * share for row in own) for share in (0.5, 0.95)]
        mean = sum(row.log_score for row in own) / len(own)
        made.add_row(
            experiment, str(len(own)), *map(str, inside), f"{mean:+.2f}", f"{max(row.k_hat for row in own):.2f}"
        )
    return made
