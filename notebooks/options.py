"""Arguments and options that several commands take, and the checks of their values."""

from __future__ import annotations

import math
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
Tail = Annotated[float, typer.Option("--tail", metavar="S", help="Time after the last corner.")]


def check_tail(tail_s: float | None) -> None:
    """Fail with a usage error for a tail that is no time."""
    if tail_s is not None and not (math.isfinite(tail_s) and tail_s >= 0):
        raise usage(f"{tail_s:g} is not a time in seconds of 0 or more", "--tail")
