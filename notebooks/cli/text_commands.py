"""The commands about icons as text: ``convert``, ``cite`` and ``explain``; ``main`` registers them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..messages import check_changes, load_rig, usage
from ..report.options import Changes, IconName, OneFile
from .cues import read_set, warn_of_site

if TYPE_CHECKING:
    from thermicon.circuit import Rig

CONTROLS = ("skin", "display")


def convert_command(
    file: Annotated[str, typer.Argument(metavar="FILE", help="A .cue or .csv file, or a shipped set.")],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="OUT", readable=False, help="The file to write: .cue or .json."),
    ],
    icon: IconName = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            "--tolerance", metavar="K", help="For .csv: largest deviation of the icon from the recording, in K."
        ),
    ] = None,
    name: Annotated[str | None, typer.Option("--name", metavar="NAME", help="For .csv: the name of the icon.")] = None,
    column: Annotated[
        str | None, typer.Option("--column", metavar="COLUMN", help="For .csv: the column of temperatures.")
    ] = None,
    control: Annotated[
        str | None,
        typer.Option(
            "--control",
            metavar="|".join(CONTROLS),
            help="For .csv: whether skin or display temperatures were recorded.",
        ),
    ] = None,
) -> None:
    """Write icons as a cue file or, for other programs, as JSON, as the ending says.

    JSON keeps everything except comments. A recording (.csv) becomes an icon of a few straight pieces.
    """
    if not file.lower().endswith(".csv"):
        for option, value in (
            ("--tolerance", tolerance),
            ("--name", name),
            ("--column", column),
            ("--control", control),
        ):
            if value is not None:
                raise usage("applies only to a recording, a .csv file", option)
    if tolerance is not None and not (math.isfinite(tolerance) and tolerance > 0):
        raise usage(f"{tolerance:g} is not a difference in K above 0", "--tolerance")
    if control is not None and control not in CONTROLS:
        raise usage(f"{control!r} is not one of {', '.join(CONTROLS)}", "--control")
    from .convert import Recording, convert_file

    convert_file(file, output, icon, Recording(tolerance, name, column, control))


def cite_command(
    file: OneFile,
    bibtex: Annotated[bool, typer.Option("--bibtex", help="Print BibTeX entries of the sources instead.")] = False,
    rig: Annotated[
        str | None, typer.Option("--rig", metavar="RIG", help="Also describe this rig in the paragraph.")
    ] = None,
    changes: Changes = None,
) -> None:
    """Print a paragraph for the methods section of a paper, or the BibTeX entries of the icons' sources."""
    check_changes(changes or [])
    if bibtex and (rig is not None or changes):
        raise usage("applies to the paragraph; BibTeX entries do not describe a rig", "--rig" if rig else "--set")
    named = rig is not None or bool(changes)
    cite_file(file, bibtex, load_rig(rig, changes or [], module_matters=False) if named else None)


def cite_file(file: str, as_bibtex: bool, rig: Rig | None) -> None:
    """Print the methods paragraph of a file, with a rig if given, or the BibTeX entries of its sources."""
    from thermicon.circuit.rig.rig_summary import rig_for_methods
    from thermicon.icons.files.bibtex import bibtex
    from thermicon.icons.files.methods import methods

    icons = read_set([file])
    if as_bibtex:
        typer.echo(bibtex(icons), nl=False)
        return
    if rig is not None:
        warn_of_site(file, icons, rig)
    typer.echo(methods(icons, None if rig is None else rig_for_methods(rig)))


def explain_command(
    code: Annotated[str, typer.Argument(metavar="CODE", help="The code of an error, such as E102, or its title.")],
) -> None:
    """Explain an error in a cue file: its meaning, an example, and the corrected example."""
    from thermicon.icons.files.catalogue import explain

    try:
        typer.echo(explain(code))
    except ValueError as unknown:
        raise usage(str(unknown), "CODE") from None
