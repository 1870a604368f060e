"""The faces of thermicon: command line, figures, notebooks."""

from thermicon.notebooks.overview import overview, set_figure

__all__ = ["overview", "set_figure"]
