"""Arguments and options that several commands take, and the checks of their values."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from ..messages import usage

LONGEST_GAP_S, MOST_BIAS = 600.0, 5.0
"""Limits of `thermicon.perception.Task`, repeated here to avoid its imports."""

Files = Annotated[list[str], typer.Argument(metavar="FILE", help="Cue files, or names of shipped sets (six-icons).")]
CueFiles = Annotated[list[str], typer.Argument(metavar="FILE", help="Cue files of your own.")]
OneFile = Annotated[str, typer.Argument(metavar="FILE", help="A cue file, or the name of a shipped set.")]
IconName = Annotated[str | None, typer.Option("--icon", metavar="NAME", help="Only this icon of the file.")]
RigName = Annotated[
    str | None, typer.Option("--rig", metavar="RIG", help="A shipped rig or a .toml file.  [default: thenar]")
]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change one key of the rig; may be given several times."),
]
ReportPage = Annotated[
    Path | None,
    typer.Option("--report", metavar="OUT.html", readable=False, help="Write a self-contained HTML report."),
]
Workers = Annotated[
    int | None, typer.Option("--workers", metavar="N", help="Number of CPU cores.  [default: all of this machine]")
]
Cluster = Annotated[
    str | None,
    typer.Option("--cluster", metavar="ADDRESS", help="Compute on a dask cluster: the address of its scheduler."),
]
Draws = Annotated[
    int | None,
    typer.Option(
        "--parameters",
        metavar="N",
        help="Draws of the posterior for intervals and goals; 0 for none.  [default: 128, or all there are]",
    ),
]
ObserverFile = Annotated[
    Path | None,
    typer.Option(
        "--observer",
        metavar="FILE",
        readable=False,
        help="Predict with another observer: draws of thermicon calibrate or observed (.csv), or its records (.toml).",
    ),
]
DrawsFile = Annotated[
    Path | None,
    typer.Option(
        "--observer",
        metavar="FILE",
        readable=False,
        help="Draw from another posterior: the table of draws (.csv) of thermicon calibrate or observed --keep.",
    ),
]
Keep = Annotated[
    Path | None,
    typer.Option(
        "--keep",
        metavar="DIR",
        readable=False,
        help="Folder for finished parts, so that an interrupted run continues.",
    ),
]
Context = Annotated[
    float,
    typer.Option(
        "--context", metavar="SHARE", help="Share of the memory noise that grows with the range of the set, 0 to 1."
    ),
]
Gap = Annotated[
    float | None,
    typer.Option(
        "--gap",
        metavar="S",
        help="Seconds from the end of one icon to the next, 0 to 600.  [default: until carry-over has faded]",
    ),
]
Bias = Annotated[
    float,
    typer.Option(
        "--bias", metavar="SD", help="Standard deviation of people's response bias, in log likelihood, 0 to 5."
    ),
]
TRACKING = ("replay", "display", "ideal")
Tracking = Annotated[
    str | None,
    typer.Option(
        "--tracking",
        metavar="|".join(TRACKING),
        help="What is the same for all people: current, display or target.  [default: by control]",
    ),
]
NormName = Annotated[
    str,
    typer.Option("--norm", metavar="NAME", help="How icons are remembered: episodes or naming."),
]
Tail = Annotated[float, typer.Option("--tail", metavar="S", help="Seconds simulated after the last corner.")]


def check_tracking(tracking: str | None) -> None:
    """Fail with a usage error for a tracking that there is not; None is the usual one."""
    if tracking is not None and tracking not in TRACKING:
        raise usage(f"{tracking!r} is not one of {', '.join(TRACKING)}", "--tracking")


def check_task(context: float, gap_s: float | None, bias: float) -> None:
    """Fail with a usage error for an impossible identification task."""
    for option, value, most, unit in (
        ("--context", context, 1.0, ""),
        ("--gap", gap_s, LONGEST_GAP_S, " s"),
        ("--bias", bias, MOST_BIAS, ""),
    ):
        if value is not None and not 0.0 <= value <= most:
            raise usage(f"{value:g}{unit} is outside 0 to {most:g}{unit}", option)


def check_tail(tail_s: float | None) -> None:
    """Fail with a usage error for a tail that is not a time."""
    if tail_s is not None and not (math.isfinite(tail_s) and tail_s >= 0):
        raise usage(f"{tail_s:g} is not a time in seconds of 0 or more", "--tail")


LONGEST_PAUSE_S = 600.0
"""The longest pause between plays, as in `thermicon.circuit.safety.repeated`, repeated here to avoid its imports."""


def check_pause(pause_s: float | None) -> None:
    """Fail with a usage error for a pause outside 0 to 10 min."""
    if pause_s is not None and not 0 <= pause_s <= LONGEST_PAUSE_S:
        raise usage(f"{pause_s:g} is not a time between plays of 0 to {LONGEST_PAUSE_S:g} s", "--pause")


def check_norm_option(norm: str) -> None:
    """Fail with a usage error for a norm that there is not."""
    from thermicon.icons.near_words import nearest_words
    from thermicon.perception.observer.channels import NORMS

    if norm not in NORMS:
        near = nearest_words(norm, NORMS)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise usage(f"{norm!r} is not one of {', '.join(NORMS)}{hint}", "--norm")
