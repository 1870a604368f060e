"""The command line: every command of ``thermicon``, grouped by job.

A command imports what it needs when it runs, so that ``check`` answers at once. The work of each command is in a module
of this package.
"""

from __future__ import annotations

import gc
import math
import sys
from pathlib import Path
from typing import Annotated

import typer

from ..figures.figure_look import (
    FigureFolder,
    FigureFormat,
    FigureStyle,
    FigureWidth,
    NoTitle,
    figure_look,
)
from ..messages import check_bounds, check_changes, check_parameters, interrupted, load_rig, usage
from ..report.choices import ChooseCount, GoalText, MostEnergy, MostTime, Must, ObjectiveName, chosen_as
from ..report.options import (
    Bias,
    Changes,
    Cluster,
    Context,
    CueFiles,
    Draws,
    Files,
    Gap,
    IconName,
    Keep,
    NormName,
    ObserverFile,
    ReportPage,
    RigName,
    Tracking,
    Workers,
    check_tail,
    check_task,
    check_tracking,
)
from ..startup import is_command, print_anywhere, warn_if_hidden
from . import (
    fit,
    frontier,
    hardware_commands,
    lab,
    pilot_commands,
    searching,
    session,
    study,
    text_commands,
    validation,
    whatif_commands,
)
from .app import Commands, with_command

WRITE, SIMULATE, PREDICT = "Write icons", "Simulate a rig", "Predict perception"
PLAY, NOTEBOOKS, INSTALLATION = "Play on hardware", "Notebooks", "Installation"
"""Jobs, as the headings of ``thermicon --help``."""

RANKED_BY = ("model", "rules")

app = typer.Typer(
    name="thermicon",
    cls=Commands,
    help="Design thermal icons, simulate them on display and skin, and predict which ones people confuse.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    no_args_is_help=True,
)

Output = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="OUT",
        readable=False,
        help="Write the trace to a .csv or .parquet file, or - for stdout.",
    ),
]
"""Commands check paths themselves (`readable=False`), so that a bad path is bad input and not bad usage."""


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"thermicon {version('thermicon')}")
        raise typer.Exit


@app.callback()
def thermicon(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Design thermal icons, simulate them on display and skin, and predict which ones people confuse."""


@app.command("check", rich_help_panel=WRITE)
def check_command(
    files: Files,
    rig: Annotated[
        str | None, typer.Option("--rig", metavar="RIG", help="Also check levels and rates against this rig.")
    ] = None,
    changes: Changes = None,
) -> None:
    """Check cue files and report every error in them, or one line per file when there is none.

    With --rig, levels, baselines and (under display control) rates are also checked against what the rig can do.
    simulate reports whether the rig reaches the target in time.
    """
    check_changes(changes or [])
    from .check import check

    check(files, load_rig(rig, changes or [], module_matters=False) if rig is not None or changes else None)


@app.command("fmt", rich_help_panel=WRITE)
def fmt_command(
    files: CueFiles,
    check: Annotated[
        bool, typer.Option("--check", help="Only print the names of the files that would change.")
    ] = False,
) -> None:
    """Format cue files in canonical layout, in place; comments, numbers and units stay as they are.

    With --check nothing is written, and the exit code is 1 if a file would change.
    """
    from .formatting import format_files

    format_files(files, check)


@app.command("simulate", rich_help_panel=SIMULATE)
def simulate_command(
    file: Annotated[
        str | None, typer.Argument(metavar="FILE", help="A cue file, or the name of a shipped set.")
    ] = None,
    icon: IconName = None,
    current: Annotated[
        Path | None,
        typer.Option(
            "--current",
            metavar="DRIVE.csv",
            readable=False,
            help="Play this drive current (columns time_s, current_A) instead of icons.",
        ),
    ] = None,
    hold: Annotated[
        bool,
        typer.Option("--hold", help="With --current: hold each current until the next row instead of interpolating."),
    ] = False,
    output: Output = None,
    rate: Annotated[float, typer.Option("--rate", metavar="HZ", help="Samples per second.")] = 100.0,
    tail: Annotated[
        float | None,
        typer.Option(
            "--tail", metavar="S", help="Seconds simulated after the last corner.  [default: 0; 10 in figures]"
        ),
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option(
            "--figure",
            metavar="OUT",
            readable=False,
            help="Draw an overview, .pdf, .svg or .png; several icons give one file each, OUT-NAME.png.",
        ),
    ] = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    measured: Annotated[
        Path | None,
        typer.Option(
            "--measured",
            metavar="LOG",
            readable=False,
            help="Lay a measured log beside the trace, in the figure too: rms and largest miss of every column.",
        ),
    ] = None,
    power: Annotated[
        bool, typer.Option("--power", help="With -o: add the electrical power of the module, power_W.")
    ] = False,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Simulate icons: the current that plays them, and temperatures and heat flow down to the receptors.

    With --current, a given drive current is simulated instead. Without -o, a short summary is printed.
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
    if power and output is None:
        raise usage("adds a column to the trace; name its file with -o, or - for stdout", "--power")
    if not (math.isfinite(rate) and rate > 0):
        raise usage(f"{rate:g} is not a number of samples per second above 0", "--rate")
    check_tail(tail)
    look = figure_look(figure, width, style, no_title)
    from .simulate import simulate_drive, simulate_file

    if current is not None:
        simulate_drive(current, hold, load_rig(rig, changes or []), rate, output, figure, power, measured, look)
    elif file is not None:
        simulate_file(file, icon, load_rig(rig, changes or []), rate, tail, output, figure, power, measured, look)


@app.command("rank", rich_help_panel=PREDICT)
def rank_command(
    files: Files,
    people: Annotated[int, typer.Option("--people", metavar="N", help="Number of virtual people.")] = 200,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the virtual people.")] = 0,
    by: Annotated[
        str,
        typer.Option("--by", metavar="|".join(RANKED_BY), help="Score with the model, or with rules of thumb alone."),
    ] = "model",
    parameters: Draws = None,
    tracking: Tracking = None,
    norm: NormName = "episodes",
    trials: Annotated[
        int, typer.Option("--trials", metavar="N", help="Number of trials of the predicted experiment.")
    ] = 48,
    choose: ChooseCount = None,
    objective: ObjectiveName = None,
    must: Must = None,
    most_time: MostTime = None,
    most_energy: MostEnergy = None,
    goal: GoalText = None,
    edits: Annotated[
        bool,
        typer.Option("--edits", help="Find the cheapest edit for every indistinguishable pair, not only the worst."),
    ] = False,
    context: Context = 0.0,
    gap: Gap = None,
    bias: Bias = 0.0,
    observer: ObserverFile = None,
    json: Annotated[
        Path | None, typer.Option("--json", metavar="OUT", readable=False, help="Write every number as JSON.")
    ] = None,
    figure: FigureFolder = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    figure_format: FigureFormat = None,
    report: ReportPage = None,
    workers: Workers = None,
    cluster: Cluster = None,
    keep: Keep = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Rank a set of icons: predict detection, onset times, confusions and the information that the set carries.

    Several files are joined into one set. With --by rules, icons are scored by rules of thumb alone, and the model
    only reports where it disagrees.
    """
    check_changes(changes or [])
    check_bounds(("--people", people, 1, 100_000), ("--seed", seed, 0, 2**63 - 1), ("--trials", trials, 1, 1_000_000))
    check_parameters(parameters)
    if by not in RANKED_BY:
        raise usage(f"{by!r} is not one of {', '.join(RANKED_BY)}", "--by")
    check_tracking(tracking)
    if workers is not None and cluster is not None:
        raise usage("applies to this machine; a cluster brings its own workers", "--workers")
    if workers is not None:
        check_bounds(("--workers", workers, 1, 1024))
    check_task(context, gap, bias)
    picked = chosen_as(choose, objective, must, most_time, most_energy)
    if picked is not None and by == "rules":
        raise usage("icons are chosen with the model; leave out --by rules", "--choose")
    look = figure_look(figure, width, style, no_title, figure_format)
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
        goal=goal,
        edits="all" if edits else ("worst" if picked is None else "none"),
        context=context,
        gap=gap,
        bias=bias,
        observer=observer,
        rig=rig,
        workers=workers,
        cluster=cluster,
        keep=keep,
    )
    rank_files(files, load_rig(rig, changes or []), request, json, figure, report, look)


@app.command("rigs", rich_help_panel=SIMULATE)
def rigs_command() -> None:
    """List the shipped rigs with skin site, resting temperatures and resting heat flow."""
    from .shipped import show_rigs

    show_rigs()


@app.command("library", rich_help_panel=WRITE)
def library_command() -> None:
    """List the shipped icon sets with the meaning and the source of their icons."""
    from .shipped import show_library

    show_library()


def doctor_command(
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of lines.")] = False,
) -> None:
    """Check the installation: versions, extras, outside programs, cache, fonts, Jupyter, and a self-test.

    Every line is ok, a note (something that can be done without) or a fault, with its cure. With a fault, the exit code
    is 1.
    """
    from .examine import doctor

    raise typer.Exit(doctor(json))


for _name, _command, _panel in (
    ("convert", text_commands.convert_command, WRITE),
    ("cite", text_commands.cite_command, WRITE),
    ("explain", text_commands.explain_command, WRITE),
    ("sweep", whatif_commands.sweep_command, SIMULATE),
    ("compare", whatif_commands.compare_command, SIMULATE),
    ("netlist", whatif_commands.netlist_command, SIMULATE),
    ("fit", fit.fit_command, SIMULATE),
    ("search", searching.search_command, PREDICT),
    ("frontier", frontier.frontier_command, PREDICT),
    ("observed", pilot_commands.observed_command, PREDICT),
    ("plan", pilot_commands.plan_command, PREDICT),
    ("sensitivity", whatif_commands.sensitivity_command, PREDICT),
    ("calibrate", whatif_commands.calibrate_command, PREDICT),
    ("validate", validation.validate_command, PREDICT),
    ("session", session.session_command, PLAY),
    ("study", study.study_command, PLAY),
    ("export", hardware_commands.export_command, PLAY),
    ("devices", hardware_commands.devices_command, PLAY),
    ("lab", lab.lab_command, NOTEBOOKS),
    ("doctor", doctor_command, INSTALLATION),
):
    app.command(_name, rich_help_panel=_panel)(_command)


def main() -> None:
    """Run the command line of the process; the entry point of the ``thermicon`` command."""
    # What imports create is not garbage, and looking for some after each 700 objects takes a twentieth of a command.
    gc.set_threshold(100_000)
    try:
        if is_command():
            warn_if_hidden()
        print_anywhere()
        with_command(app, sys.argv[1:2])(prog_name="thermicon")
    except KeyboardInterrupt:
        sys.exit(interrupted().exit_code)
    finally:
        gc.freeze()  # a process that ends needs no last search for garbage either


if __name__ == "__main__":
    main()
