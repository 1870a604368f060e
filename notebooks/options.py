"""Arguments and options that several commands take, and the checks of their values."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from thermicon.notebooks.door import usage

Files = Annotated[list[str], typer.Argument(metavar="FILE", help="Cue files, or names of shipped sets (six-icons).")]
CueFiles = Annotated[list[str], typer.Argument(metavar="FILE", help="Cue files of your own.")]
OneFile = Annotated[str, typer.Argument(metavar="FILE", help="A cue file, or the name of a shipped set.")]
IconName = Annotated[str | None, typer.Option("--icon", metavar="NAME", help="Only this icon of the file.")]
RigName = Annotated[
    str | None, typer.Option("--rig", metavar="RIG", help="A shipped rig or a .toml file.  [default: thenar]")
]
Changes = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change one key of the rig; may be repeated.")
]
ReportPage = Annotated[
    Path | None,
    typer.Option("--report", metavar="OUT.html", readable=False, help="Write one page with everything, to mail."),
]
Workers = Annotated[
    int | None, typer.Option("--workers", metavar="N", help="Cores to work on.  [default: all of this machine]")
]
Cluster = Annotated[
    str | None,
    typer.Option("--cluster", metavar="ADDRESS", help="Work on a dask cluster instead: its scheduler's address."),
]
Keep = Annotated[
    Path | None,
    typer.Option(
        "--keep",
        metavar="DIR",
        readable=False,
        help="Keep finished parts in DIR.  [default: in the user's cache, until a long run is done]",
    ),
]
Tail = Annotated[float, typer.Option("--tail", metavar="S", help="Time after the last corner.")]


def check_tail(tail_s: float | None) -> None:
    """Fail with a usage error for a tail that is no time."""
    if tail_s is not None and not (math.isfinite(tail_s) and tail_s >= 0):
        raise usage(f"{tail_s:g} is not a time in seconds of 0 or more", "--tail")
