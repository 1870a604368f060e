"""The faces of thermicon: command line, figures, notebooks."""

from typing import TYPE_CHECKING

from thermicon.notebooks.overview import overview, set_figure
from thermicon.notebooks.sweep import sweep
from thermicon.notebooks.sweepfigure import sweep_figure

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

__all__ = ["overview", "set_figure", "sweep", "sweep_figure"]


def load_ipython_extension(shell: "InteractiveShell") -> None:
    """Bring the ``%%cue`` cell magic: what ``%load_ext thermicon.notebooks`` calls."""
    from thermicon.notebooks.magic import register

    register(shell)


def unload_ipython_extension(shell: "InteractiveShell") -> None:
    """Take the magic away again: what ``%unload_ext thermicon.notebooks`` calls."""
    from thermicon.notebooks.magic import unregister

    unregister(shell)
