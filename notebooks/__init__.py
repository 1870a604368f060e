"""The faces of thermicon: command line, figures, notebooks."""

from thermicon.notebooks.overview import overview, set_figure
from thermicon.notebooks.sweep import sweep
from thermicon.notebooks.sweepfigure import sweep_figure

__all__ = ["overview", "set_figure", "sweep", "sweep_figure"]
