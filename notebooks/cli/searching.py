"""``thermicon search``: improve a set within its families, as a cue file and a table of before and after."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..files.outputs import STDOUT, check_output, check_separate, complete_or_absent
from ..text.choices import OBJECTIVES
from ..text.messages import check_changes, load_observer, load_rig, note, usage
from .options import Changes, NormName, ObserverFile, OneFile, RigName, Tracking, check_tracking

if TYPE_CHECKING:
    from thermicon.perception import SearchResult


def search_command(
    file: OneFile,
    choose: Annotated[
        int | None,
        typer.Option(
            "--choose", metavar="K", help="Number of icons to choose, from any family.  [default: one of each]"
        ),
    ] = None,
    objective: Annotated[
        str,
        typer.Option("--objective", metavar="NAME", help="What to improve: worst (pair), correct, bits or bits-per-s."),
    ] = "worst",
    evaluations: Annotated[
        int,
        typer.Option(
            "--evaluations", metavar="N", help="Number of icons to try; more take longer and may find a better set."
        ),
    ] = 2000,
    people: Annotated[
        int, typer.Option("--people", metavar="N", help="Number of virtual people for the final scores.")
    ] = 200,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the search and of the virtual people.")] = 0,
    tracking: Tracking = None,
    norm: NormName = "episodes",
    observer: ObserverFile = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT.cue",
            readable=False,
            help="Write the improved set to a cue file, or - for stdout.",
        ),
    ] = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Improve a set of icons over the continuous parameters of its families; all other icons stay as they are.

    The result is the best set for the model, with which it was searched: test it with people before you use it.
    """
    check_changes(changes or [])
    bounds = (
        ("--choose", choose if choose is not None else 2, 2, 64),
        ("--evaluations", evaluations, 10, 1_000_000),
        ("--people", people, 1, 100_000),
        ("--seed", seed, 0, 2**32 - 1),
    )
    for option, value, least, most in bounds:
        if not least <= value <= most:
            raise usage(f"{value} is outside {least} to {most}", option)
    if objective not in OBJECTIVES:
        raise usage(f"{objective!r} is not one of {', '.join(OBJECTIVES)}", "--objective")
    check_tracking(tracking)
    from thermicon.perception.observer.channels import NORMS

    if norm not in NORMS:
        raise usage(f"{norm!r} is not one of {', '.join(NORMS)}", "--norm")
    if output is not None:
        check_output(output, (".cue",), "a set of icons")
        check_separate([file], [output])
    from thermicon.perception import search

    from ..text.messages import progress_bar
    from .cues import read_set, warn_of_frames

    icons, where, model = read_set([file]), load_rig(rig, changes or []), load_observer(observer)
    warn_of_frames([file], icons, where)
    with progress_bar("searching") as progress:
        found = search(
            icons,
            where,
            count=choose,
            objective=objective,  # type: ignore[arg-type]
            evaluations=evaluations,
            people=people,
            seed=seed,
            tracking=tracking,
            norm=norm,
            observer=model,
            progress=progress,
        )
    if output == STDOUT:
        typer.echo(str(found.found), nl=False)
        return
    if output is not None:
        with complete_or_absent(output) as draft:
            draft.write_text(str(found.found), encoding="utf-8")
        note(f"wrote {output}")
    show_search(found, icons.title, people, where.name)


def show_search(found: SearchResult, title: str, people: int, rig: str) -> None:
    """Print the improved set, its scores next to those of the initial set, and the caveat."""
    from thermicon.icons.number_text import number, percent

    from ..text.tables import show, table

    made = table("", "before", "after", numbers=("before", "after"))
    for what, before, after in (
        ("worst pair, d′", number(found.before.d_prime), number(found.after.d_prime)),
        ("proportion correct", percent(found.before.proportion_correct), percent(found.after.proportion_correct)),
        ("information, bits", f"{found.before.information_bits:.2f}", f"{found.after.information_bits:.2f}"),
        ("information rate, bits/s", f"{found.before.bits_per_s:.2f}", f"{found.after.bits_per_s:.2f}"),
    ):
        made.add_row(what, before, after)
    crowd = "1 virtual person" if people == 1 else f"{people} virtual people"
    began = f"Before: {', '.join(icon.name for icon in found.start)}"
    icons = [
        f"  - {icon.name}: {icon.metadata.tags[-1]}" for icon in found.found if "found by search" in icon.metadata.tags
    ]
    show(
        *([title, ""] if title else []),
        "Found:",
        *icons,
        "",
        made,
        "",
        f"After: worst pair {' and '.join(found.after.worst_pair)}",
        began,
        "",
        f"{found.evaluations} icons were tried on a nominal person and {found.refined} on 24 people, with the "
        f"objective {found.objective} (seed {found.seed}). Before and after are for {crowd} on the {rig} rig.",
        "These are predictions of a model, not measurements, and the set was optimised for that same model: "
        "expect lower scores from people.",
    )
