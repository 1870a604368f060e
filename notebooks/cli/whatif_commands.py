"""The commands that ask what if: ``netlist``, ``sweep``, ``compare``, ``sensitivity``; ``cli`` puts them in place."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..text.messages import check_changes, load_rig, usage
from .options import Changes, IconName, OneFile, RigName, Tail, check_tail

METHODS = ("sobol", "morris")
Figure = Annotated[Path | None, typer.Option("--figure", metavar="OUT.png", readable=False, help="Draw the figure.")]


def netlist_command(
    file: OneFile,
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="OUT.cir", readable=False, help="The netlist, or - for stdout."),
    ],
    icon: IconName = None,
    tail: Tail = 0.0,
    record: Annotated[
        str | None,
        typer.Option("--ngspice", metavar="OUT.txt", help="Have ngspice -b write all probes there; not for LTspice."),
    ] = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Write driver, module and skin as a circuit that LTspice and ngspice read, with the current that plays an icon."""
    check_changes(changes or [])
    check_tail(tail)
    from .netlist import netlist_file

    netlist_file(file, icon, load_rig(rig, changes or []), tail, output, record)


def sweep_command(
    file: OneFile,
    vary: Annotated[
        str,
        typer.Option("--vary", metavar="KEY=LOW:HIGH:N", help="A key of the rig and N values; Nlog: in equal ratios."),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="OUT", readable=False, help="The table: .csv, .parquet, or - for stdout."
        ),
    ],
    icon: IconName = None,
    tail: Tail = 0.0,
    figure: Figure = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Vary one key of the rig and write what every icon then does: misses, extremes, what receptors see, safety."""
    check_changes(changes or [])
    check_tail(tail)
    from .sweep import read_vary, sweep_file

    asked = read_vary(vary)
    sweep_file(file, asked, icon, load_rig(rig, changes or []), tail, output, figure)


def compare_command(
    first: Annotated[str, typer.Argument(metavar="A", help="A rig, FILE:ICON, a set, or a trace or log.")],
    second: Annotated[str, typer.Argument(metavar="B", help="The same kind of thing.")],
    file: Annotated[
        str | None,
        typer.Option("--file", metavar="FILE", help="For two rigs: the icons to play.  [default: six-icons, one icon]"),
    ] = None,
    icon: IconName = None,
    figure: Figure = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Compare two rigs, two icons, two sets, or a trace and a measured log: a table of differences, B minus A.

    Rigs are names or .toml files, icons are FILE:ICON, sets are .cue files or shipped names, traces and logs are
    .csv or .parquet files with time_s and columns of a trace.
    """
    check_changes(changes or [])
    from .compare import compare
    from .compare_inputs import Request

    compare(first, second, Request(file, icon, rig, tuple(changes or ())), figure)


def sensitivity_command(
    file: OneFile,
    people: Annotated[int, typer.Option("--people", metavar="N", help="Virtual people of every run.")] = 24,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of people and draws.")] = 0,
    method: Annotated[
        str,
        typer.Option("--method", metavar="|".join(METHODS), help="Shares of variance, or effects by SALib."),
    ] = "sobol",
    samples: Annotated[
        int | None,
        typer.Option(
            "--samples", metavar="N", help="Base samples, a power of 2, or trajectories.  [default: 64; 16 for morris]"
        ),
    ] = None,
    norm: Annotated[str, typer.Option("--norm", metavar="NAME", help="max, rms or integral.")] = "max",
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT.csv", readable=False, help="The table, or - for stdout."),
    ] = None,
    figure: Figure = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Tell which uncertain parameters of model, contact and skin move the prediction most: what to measure first."""
    check_changes(changes or [])
    bounds = (("--people", people, 1, 10_000), ("--seed", seed, 0, 2**32 - 1), ("--samples", samples or 2, 2, 65_536))
    for option, value, least, most in bounds:
        if not least <= value <= most:
            raise usage(f"{value} is outside {least} to {most}", option)
    if method not in METHODS:
        raise usage(f"{method!r} is none of {', '.join(METHODS)}", "--method")
    if samples is not None and method == "sobol" and samples & (samples - 1):
        raise usage(f"{samples} is not a power of 2, which sobol needs, such as 64", "--samples")
    from .sensitivity import Request, sensitivity_file

    request = Request(people=people, seed=seed, method=method, samples=samples, norm=norm)
    sensitivity_file(file, load_rig(rig, changes or []), request, output, figure)
