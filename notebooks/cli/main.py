"""The command line: ``thermicon check``, ``simulate``, ``rank`` …; ``whatif``, ``handing``, ``hardware`` … hold others.

Every command imports what it needs when it runs, so that ``check`` answers at once. The work itself is one module a
command, beside this one.
"""

from __future__ import annotations

import io
import math
import sys
from pathlib import Path
from typing import Annotated

import typer

from ..text.choices import ChooseCount, MostEnergy, MostTime, Must, ObjectiveName, chosen_as
from ..text.messages import check_changes, interrupted, load_rig, usage
from . import hardware_commands as hardware
from . import lab, searching, session, validation
from . import text_commands as handing
from . import whatif_commands as whatif
from .app import Commands
from .options import (
    Bias,
    Changes,
    Cluster,
    Context,
    CueFiles,
    Files,
    Gap,
    IconName,
    Keep,
    ReportPage,
    RigName,
    Workers,
    check_tail,
    check_task,
)

TRACKING = ("replay", "display", "ideal")
RANKED_BY = ("model", "rules")

app = typer.Typer(
    name="thermicon",
    cls=Commands,
    help="Write thermal icons, see what they do to display, skin and receptors, predict which ones people confuse.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    no_args_is_help=True,
)

Output = Annotated[
    Path | None,
    typer.Option(
        "-o", "--output", metavar="OUT", readable=False, help="Write the trace: .csv, .parquet, or - for stdout."
    ),
]
"""Commands look at paths themselves (`readable=False`), so that a bad one is bad input and not bad usage."""


def _tell_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"thermicon {version('thermicon')}")
        raise typer.Exit


@app.callback()
def thermicon(
    version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Write thermal icons, see what they do to display, skin and receptors, predict which ones people confuse."""


@app.command("check")
def check_command(
    files: Files,
    rig: Annotated[
        str | None, typer.Option("--rig", metavar="RIG", help="Also hold levels and rates against this rig.")
    ] = None,
    changes: Changes = None,
) -> None:
    """Read cue files and report everything that is wrong with them, or one line a file when nothing is.

    With --rig the icons are also held against the rig's levels, baselines and, under display control, rates;
    whether a cue is reached in time is for simulate to say.
    """
    check_changes(changes or [])
    from .check import check

    check(files, load_rig(rig, changes or []) if rig is not None or changes else None)


@app.command("fmt")
def fmt_command(
    files: CueFiles,
    check: Annotated[bool, typer.Option("--check", help="Only print the names of files that would change.")] = False,
) -> None:
    """Bring cue files into canonical layout, in place; comments, numbers and units stay as they are.

    With --check nothing is written, and the exit code is 1 when a file would change.
    """
    from .formatting import format_files

    format_files(files, check)


@app.command("simulate")
def simulate_command(
    file: Annotated[
        str | None, typer.Argument(metavar="FILE", help="A cue file, or the name of a shipped set.")
    ] = None,
    icon: IconName = None,
    current: Annotated[
        Path | None,
        typer.Option(
            "--current", metavar="DRIVE.csv", readable=False, help="Play this drive (time_s, current_A) instead."
        ),
    ] = None,
    hold: Annotated[bool, typer.Option("--hold", help="With --current: hold each row until the next.")] = False,
    output: Output = None,
    rate: Annotated[float, typer.Option("--rate", metavar="HZ", help="Rows a second.")] = 100.0,
    tail: Annotated[
        float | None,
        typer.Option("--tail", metavar="S", help="Time after the last corner.  [default: 0; 10 in figures]"),
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option(
            "--figure", metavar="OUT.png", readable=False, help="Draw the overview; several icons give OUT-NAME.png."
        ),
    ] = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Find the current that plays an icon, then follow temperatures and heat flow down to the receptors.

    With --current a given drive is played instead. Without -o a short summary is printed.
    """
    check_changes(changes or [])
    if (file is None) == (current is None):
        raise usage("give either a cue FILE or --current DRIVE.csv", "FILE")
    if current is None and hold:
        raise usage("belongs to --current, which plays a drive", "--hold")
    if current is not None and icon is not None:
        raise usage("belongs to a cue FILE; a drive has no icons", "--icon")
    if current is not None and tail is not None:
        raise usage("belongs to a cue FILE; a drive ends at its last row", "--tail")
    if not (math.isfinite(rate) and rate > 0):
        raise usage(f"{rate:g} is not a number of rows a second above 0", "--rate")
    check_tail(tail)
    from .simulate import simulate_drive, simulate_file

    if current is not None:
        simulate_drive(current, hold, load_rig(rig, changes or []), rate, output, figure)
    elif file is not None:
        simulate_file(file, icon, load_rig(rig, changes or []), rate, tail, output, figure)


@app.command("rank")
def rank_command(
    files: Files,
    people: Annotated[int, typer.Option("--people", metavar="N", help="Virtual people.")] = 200,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the virtual people.")] = 0,
    by: Annotated[
        str,
        typer.Option("--by", metavar="|".join(RANKED_BY), help="Score by the model, or by rules of thumb alone."),
    ] = "model",
    parameters: Annotated[
        int,
        typer.Option("--parameters", metavar="N", help="Draws for the interval of the model's parameters; 0: none."),
    ] = 128,
    tracking: Annotated[
        str | None,
        typer.Option("--tracking", metavar="|".join(TRACKING), help="What each person gets.  [default: by control]"),
    ] = None,
    norm: Annotated[
        str, typer.Option("--norm", metavar="NAME", help="How a difference over time counts: max, rms, integral.")
    ] = "max",
    trials: Annotated[
        int, typer.Option("--trials", metavar="N", help="Trials in all of the experiment foretold.")
    ] = 48,
    choose: ChooseCount = None,
    objective: ObjectiveName = None,
    must: Must = None,
    most_time: MostTime = None,
    most_energy: MostEnergy = None,
    edits: Annotated[
        bool,
        typer.Option("--edits", help="Find the cheapest edit for every pair that is not apart, not only the worst."),
    ] = False,
    context: Context = 0.0,
    gap: Gap = None,
    bias: Bias = 0.0,
    json: Annotated[
        Path | None, typer.Option("--json", metavar="OUT", readable=False, help="Write every number as JSON.")
    ] = None,
    figure: Annotated[
        Path | None, typer.Option("--figure", metavar="DIR", readable=False, help="Write the figures into DIR.")
    ] = None,
    report: ReportPage = None,
    workers: Workers = None,
    cluster: Cluster = None,
    keep: Keep = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Predict what people detect, how soon, what they confuse, and how much information the set carries.

    Several files are joined into one set. With --by rules nothing but rules of thumb counts, and the model only says
    where it disagrees.
    """
    check_changes(changes or [])
    bounds = (
        ("--people", people, 1, 100_000),
        ("--seed", seed, 0, 2**63 - 1),
        ("--trials", trials, 1, 1_000_000),
        ("--parameters", parameters, 0, 10_000),
    )
    for option, value, least, most in bounds:
        if not least <= value <= most:
            raise usage(f"{value} is outside {least} to {most}", option)
    if parameters == 1:
        raise usage("1 draw has no interval; ask for 2 or more, or 0 for none", "--parameters")
    if by not in RANKED_BY:
        raise usage(f"{by!r} is none of {', '.join(RANKED_BY)}", "--by")
    if tracking is not None and tracking not in TRACKING:
        raise usage(f"{tracking!r} is none of {', '.join(TRACKING)}", "--tracking")
    if workers is not None and cluster is not None:
        raise usage("is for this machine; a cluster has the workers that it has", "--workers")
    if workers is not None and not 1 <= workers <= 1024:
        raise usage(f"{workers} is outside 1 to 1024", "--workers")
    check_task(context, gap, bias)
    picked = chosen_as(choose, objective, must, most_time, most_energy)
    if picked is not None and by == "rules":
        raise usage("icons are chosen by the model; leave out --by rules", "--choose")
    from .ranking import Request, rank_files

    request = Request(
        people=people,
        seed=seed,
        tracking=tracking,
        norm=norm,
        trials=trials,
        by=by,
        parameters=parameters,
        choosing=picked,
        edits="all" if edits else ("worst" if picked is None else "none"),
        context=context,
        gap=gap,
        bias=bias,
        workers=workers,
        cluster=cluster,
        keep=keep,
    )
    rank_files(files, load_rig(rig, changes or []), request, json, figure, report)


app.command("sweep")(whatif.sweep_command)
app.command("compare")(whatif.compare_command)
app.command("search")(searching.search_command)
app.command("netlist")(whatif.netlist_command)
app.command("convert")(handing.convert_command)
app.command("cite")(handing.cite_command)
app.command("explain")(handing.explain_command)
app.command("sensitivity")(whatif.sensitivity_command)
app.command("validate")(validation.validate_command)
app.command("export")(hardware.export_command)
app.command("session")(session.session_command)
app.command("devices")(hardware.devices_command)
app.command("lab")(lab.lab_command)


@app.command("rigs")
def rigs_command() -> None:
    """List the rigs that are shipped."""
    from .shipped import show_rigs

    show_rigs()


@app.command("library")
def library_command() -> None:
    """List the icon sets that are shipped, with what they are for and where they come from."""
    from .shipped import show_library

    show_library()


def main() -> None:
    """Run the command line of the process; the entry point of the ``thermicon`` command."""
    try:
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="replace")
        app(prog_name="thermicon")
    except KeyboardInterrupt:
        sys.exit(interrupted().exit_code)


if __name__ == "__main__":
    main()
