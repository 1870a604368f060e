"""``thermicon cite``: what a paper says of a set of icons, and where they come from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from .cues import read_set, warn_of_site

if TYPE_CHECKING:
    from thermicon.circuit import Rig


def cite_file(file: str, as_bibtex: bool, rig: Rig | None) -> None:
    """Print the methods paragraph of a file, with a rig if given, or the BibTeX entries of its sources."""
    from thermicon.icons.papers.cite import bibtex, methods

    icons = read_set([file])
    if as_bibtex:
        typer.echo(bibtex(icons), nl=False)
        return
    if rig is not None:
        warn_of_site(file, icons, rig)
    typer.echo(methods(icons, None if rig is None else rig.about()))
