"""What a report says was asked: the command that gives it again."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from thermicon.circuit import Rig

    from .ranking import Request

PLAIN_OPTIONS = ("people", "seed", "tracking", "norm", "trials", "by", "parameters", "context", "gap", "bias")


def command_text(files: Sequence[str], rig: Rig, request: Request) -> str:
    """Return the command that asks this, without its outputs: files by their names, and what is not the default.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.notebooks.cli.ranking import Request
    >>> command_text(["/home/a/two icons.cue"], Rig.load("thenar"), Request(people=20))
    "thermicon rank 'two icons.cue' --people 20"
    """
    from .ranking import Request

    words = ["thermicon", "rank", *(Path(name).name for name in files)]
    usual, held = Request(), {name: getattr(request, name) for name in PLAIN_OPTIONS}
    words += [] if rig.name == "thenar" else ["--rig", rig.name]
    words += [word for change in rig.changes for word in ("--set", change)]
    for name, value in held.items():
        words += [] if value == getattr(usual, name) else [f"--{name}", str(value)]
    if (asked := request.choosing) is not None:
        words += ["--choose", str(asked.count), "--objective", asked.objective]
        words += [word for icon in asked.must for word in ("--must", icon)]
        words += [] if asked.most_s is None else ["--most-time", f"{asked.most_s:g}"]
        words += [] if asked.most_J is None else ["--most-energy", f"{asked.most_J:g}"]
    return shlex.join(words + ["--edits"] * (request.edits == "all"))
