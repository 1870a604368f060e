"""The commands for studies of rig and model: ``netlist``, ``sweep``, ``compare``, ``sensitivity``, ``calibrate``.

``main`` registers them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..figures.figure_look import FigureFile, FigureStyle, FigureWidth, NoTitle, figure_look
from ..files.outputs import (
    NETLIST_SUFFIXES,
    STDOUT,
    SUBCIRCUIT_SUFFIXES,
    check_folder,
    check_output,
    check_separate,
    complete_or_absent,
)
from ..messages import REFUSED, check_bounds, check_changes, load_rig, note, progress_bar, usage
from ..report.options import Changes, DrawsFile, IconName, OneFile, RigName, Tail, check_tail
from .cues import only, read_set, warn_of_site

if TYPE_CHECKING:
    from thermicon.circuit import Rig

VARIANT_NAMES = ("temperature", "heat-flow")
"""As in `thermicon.perception.observer.draws_file`, repeated here to avoid its imports."""

MOST_STEPS = 100_000


def netlist_command(
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT.cir",
            readable=False,
            help="Write the netlist to a .cir, .net or .sp file, or - for stdout.",
        ),
    ],
    file: Annotated[
        str | None,
        typer.Argument(metavar="FILE", help="A cue file, or the name of a shipped set; none with --subckt."),
    ] = None,
    icon: IconName = None,
    tail: Tail = 0.0,
    record: Annotated[
        str | None,
        typer.Option(
            "--ngspice", metavar="OUT.txt", help="Make ngspice -b write all probes to this file; not for LTspice."
        ),
    ] = None,
    subckt: Annotated[
        bool, typer.Option("--subckt", help="Write module and skin of the rig as .subckt with parameters, no drive.")
    ] = False,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Write driver, module and skin as a SPICE netlist for LTspice and ngspice, driven by the current of an icon."""
    check_changes(changes or [])
    check_tail(tail)
    if subckt:
        if file is not None or icon is not None or record is not None or tail:
            raise usage("writes the rig alone: leave out FILE, --icon, --tail and --ngspice", "--subckt")
        subcircuit_file(load_rig(rig, changes or []), output)
    elif file is None:
        raise usage("is missing: name a cue file or a shipped set, or add --subckt for the rig alone", "FILE")
    else:
        netlist_file(file, icon, load_rig(rig, changes or []), tail, output, record)


def subcircuit_file(rig: Rig, output: Path) -> None:
    """Write module and skin of a rig as a library of subcircuits."""
    from thermicon.circuit.delivery.subcircuit import subcircuits

    check_output(output, SUBCIRCUIT_SUFFIXES, "a library of subcircuits")
    text = subcircuits(rig)
    if output == STDOUT:
        typer.echo(text, nl=False)
        return
    with complete_or_absent(output) as draft:
        draft.write_text(text, encoding="ascii", newline="\n")
    note(f"wrote {output}: thermicon_module and thermicon_skin; in a schematic, .include {output.name}")


def netlist_file(file: str, icon: str | None, rig: Rig, tail_s: float, output: Path, record: str | None) -> None:
    """Write the circuit of a rig that plays an icon; with ``record``, ngspice writes all probes into that file."""
    from thermicon.circuit import netlist, simulate
    from thermicon.circuit.delivery.netlist_landing import lead_s
    from thermicon.circuit.solver.inverse import design

    from .simulate import headline

    check_output(output, NETLIST_SUFFIXES, "a netlist")
    check_separate([file], [output])
    icons = read_set([file])
    played = only(icons, icon, file)
    warn_of_site(file, icons, rig)
    trace = simulate(played, rig, tail_s=tail_s)
    plan = design(played, rig, float(trace.time_s[-1]))
    title = f"{played.name} of {Path(file).name}"
    text = netlist(rig, plan.drive, rest_A=plan.rest_A, lead_A=plan.lead_A, title=title, out_file=record)
    if output == STDOUT:
        typer.echo(text, nl=False)
    else:
        with complete_or_absent(output) as draft:
            draft.write_text(text, encoding="ascii", newline="\n")
    note(headline(trace))
    if rig.contact.lands_s is not None:
        note(f"the netlist's clock begins when the hand lands; the cue begins at {lead_s(rig):g} s")
    if output != STDOUT:
        note(f"wrote {output}; {_how_to_run(output, record)}")


def _how_to_run(output: Path, record: str | None) -> str:
    if record is not None:
        return f"ngspice -b {output.name} writes the probes into {record}"
    return f"open it in LTspice, or run ngspice -b -r {output.stem}.raw {output.name}"


def sweep_command(
    file: OneFile,
    vary: Annotated[
        list[str],
        typer.Option(
            "--vary",
            metavar="KEY=LOW:HIGH:N",
            help="A key of the rig, or people.age_years, and N values from LOW to HIGH, Nlog for equal ratios; or "
            "values with commas, such as site=thenar,fingertip. Give it twice for a grid.",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            readable=False,
            help="Write the table to a .csv or .parquet file, or - for stdout; needed without --measure and --figure.",
        ),
    ] = None,
    icon: IconName = None,
    measure: Annotated[
        str | None,
        typer.Option(
            "--measure",
            metavar="NAME,NAME",
            help="Also predict what people perceive: correct, correct_95 (what 95 % of people reach), detected, onset, "
            "d_prime, bits.",
        ),
    ] = None,
    people: Annotated[
        int, typer.Option("--people", metavar="N", help="With --measure: number of virtual people.")
    ] = 60,
    parameters: Annotated[
        int,
        typer.Option(
            "--parameters", metavar="N", help="With --measure: draws of the posterior for intervals; 0 for none."
        ),
    ] = 64,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="With --measure: seed of the virtual people.")] = 0,
    tail: Tail = 0.0,
    figure: FigureFile = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Vary one or two keys of the rig and write, for every icon, misses, extremes, receptor changes and safety.

    Two keys make a grid: every combination of their values is played, and the table has one row per icon and
    combination. Values are in the unit that the key ends with. With --measure every value is ranked as by rank, and a
    last row of each is that of the whole set; intervals are those of a new laboratory, 95 %.
    """
    check_changes(changes or [])
    check_tail(tail)
    from thermicon.perception.ranking.swept import AGE

    from ..report.varied import read_measures, read_varied
    from .sweep import sweep_file

    look = figure_look(figure, width, style, no_title)
    varied = read_varied(vary)
    measures = None if measure is None else read_measures(measure, people, parameters, seed)
    if measures is None and any(vary.key == AGE for vary in varied):
        raise usage(f"{AGE} changes what people perceive only; add --measure correct", "--vary")
    if output is None and figure is None and measures is None:
        raise usage("give -o OUT for the table, --figure, or --measure to print what people perceive", "-o")
    sweep_file(file, varied, icon, load_rig(rig, changes or []), tail, output, figure, look, measures)


def compare_command(
    first: Annotated[str, typer.Argument(metavar="A", help="A rig, FILE:ICON, a set, a trace or a log.")],
    second: Annotated[str, typer.Argument(metavar="B", help="A second one of the same kind.")],
    file: Annotated[
        str | None,
        typer.Option(
            "--file", metavar="FILE", help="For two rigs: the icons to play.  [default: one icon of six-icons]"
        ),
    ] = None,
    icon: IconName = None,
    align: Annotated[
        bool, typer.Option("--align", help="For a trace and a log: shift B in time to where it is most like A.")
    ] = False,
    rigs: Annotated[
        str | None,
        typer.Option("--rigs", metavar="R,R", help="For two sets: score both on each of these rigs, as a table."),
    ] = None,
    figure: FigureFile = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Compare two rigs, icons, sets, or a trace with a measured log, as a table of differences B minus A.

    Rigs are names or .toml files, icons are FILE:ICON, sets are .cue files or shipped names, traces and logs are
    .csv or .parquet files with time_s and columns of a trace. Two sets without a common name of an icon are compared by
    what is predicted for them.
    """
    check_changes(changes or [])
    from ..report.compare_inputs import Request
    from .compare import compare

    look = figure_look(figure, width, style, no_title)
    several = tuple(name.strip() for name in (rigs or "").split(",") if name.strip())
    compare(first, second, Request(file, icon, rig, tuple(changes or ()), align, several), figure, look)


def sensitivity_command(
    file: OneFile,
    people: Annotated[int, typer.Option("--people", metavar="N", help="Number of virtual people in each run.")] = 24,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the virtual people and the draws.")] = 0,
    draws: Annotated[
        int | None,
        typer.Option(
            "--draws",
            metavar="N",
            help="Draws of the posterior; more take longer and scatter less.  [default: 256, or all there are]",
        ),
    ] = None,
    observer: DrawsFile = None,
    norm: Annotated[str, typer.Option("--norm", metavar="NAME", help="episodes or naming.")] = "episodes",
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT.csv",
            readable=False,
            help="Write the table to a .csv or .parquet file, or - for stdout.",
        ),
    ] = None,
    figure: FigureFile = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Find which constants of observer, contact and skin carry the doubt about a set, and what to measure first.

    The shares are read from draws of the posterior, with which the set is predicted as a new laboratory would see it.
    """
    check_changes(changes or [])
    check_bounds(
        ("--people", people, 1, 10_000),
        ("--seed", seed, 0, 2**32 - 1),
        ("--draws", 64 if draws is None else draws, 64, 100_000),
    )
    from .sensitivity import Request, sensitivity_file

    look = figure_look(figure, width, style, no_title)
    request = Request(people=people, seed=seed, draws=draws, norm=norm, observer=observer)
    sensitivity_file(file, load_rig(rig, changes or []), request, output, figure, look)


def calibrate_command(
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FILE", readable=False, help="Write the draws to this .csv file."),
    ] = Path("posterior.csv"),
    variant: Annotated[
        str,
        typer.Option("--variant", metavar="NAME", help=f"What receptors respond to: {', '.join(VARIANT_NAMES)}."),
    ] = "temperature",
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
    effective sample size above 600) or --steps is reached. What did not converge is refused without --force. On one
    computer the same seed gives the same draws, however many workers there are and however often the run was
    interrupted; elsewhere rounding may differ, and then the draws are others of the same posterior.
    """
    check_bounds(
        ("--seed", seed, 0, 2**32 - 1),
        ("--steps", steps, 100, MOST_STEPS),
        ("--workers", workers if workers is not None else 1, 1, 8),
    )
    if variant not in VARIANT_NAMES:
        raise usage(f"{variant!r} is not one of {', '.join(VARIANT_NAMES)}", "--variant")
    check_output(output, (".csv",), "a table of draws")
    if keep is not None:
        check_folder(keep)
    from thermicon.circuit.cores import cores
    from thermicon.perception.evidence.diagnostics import require_extra
    from thermicon.perception.evidence.learning import CHAINS
    from thermicon.perception.evidence.posterior import Posterior
    from thermicon.perception.evidence.sampling import LEAST_STEPS, sample
    from thermicon.perception.observer.draws_file import to_text, variant_named

    from ..report.calibrate_text import show_constants, worst_text

    require_extra()
    with progress_bar("sampling") as bar:

        def progress(done: int, total: int, words: str) -> None:
            if bar is not None:
                bar(done, total)

        sampled = sample(
            Posterior(variant_named(variant)),
            seed,
            keep=keep,
            workers=min(cores(), CHAINS) if workers is None else workers,
            least_steps=min(LEAST_STEPS, steps),
            most_steps=steps,
            progress=progress,
        )
    if output != STDOUT:
        show_constants(sampled)
    if not sampled.diagnostics.converged and not force:
        note(
            f"{output} was not written: {sampled.diagnostics.worst} has not converged "
            f"({worst_text(sampled)}). Give more --steps{'' if keep else ' and --keep DIR'}, "
            "or --force to write it marked."
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
