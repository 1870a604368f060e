"""The commands that ask what if: ``netlist``, ``sweep`` and ``compare``. They are put on the program in ``cli``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from thermicon.notebooks.door import check_changes, load_rig
from thermicon.notebooks.options import Changes, IconName, OneFile, RigName, Tail, check_tail

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
    from thermicon.notebooks.netlist import netlist_file

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
    from thermicon.notebooks.sweep import read_vary, sweep_file

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
    from thermicon.notebooks.compare import compare
    from thermicon.notebooks.sides import Request

    compare(first, second, Request(file, icon, rig, tuple(changes or ())), figure)
