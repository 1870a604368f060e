"""The picture of a result, chosen by its type."""

from __future__ import annotations

import io
from functools import singledispatch
from typing import TYPE_CHECKING, Any

from ..identification.map import PerceptualMap
from ..ranking.ranking import Ranking
from ..ranking.sensitivity import Sensitivity
from ..selection.frontier import Frontier
from ..sensation.percept import Percept
from .draw_frontier import plot_frontier
from .draw_heat import plot_confusion
from .draw_map import plot_map
from .draw_sensation import plot_sensation
from .draw_sensitivity import plot_sensitivity

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@singledispatch
def plot(result: object, ax: Axes | None = None) -> Axes:
    """Draw a result: a percept as its sensations, a ranking as its confusion matrix.

    Parameters
    ----------
    result
        A Percept, Ranking, Sensitivity, Frontier or PerceptualMap.
    ax
        Axes to draw on; None: new ones.

    Returns
    -------
    Axes
        The axes with the picture.

    Raises
    ------
    TypeError
        For what has no picture.

    Examples
    --------
    >>> plot([1.0, 2.0])
    Traceback (most recent call last):
    TypeError: a list has no picture; a Percept, Ranking, Sensitivity, Frontier or PerceptualMap has
    """
    names = "Percept, Ranking, Sensitivity, Frontier or PerceptualMap"
    raise TypeError(f"a {type(result).__name__} has no picture; a {names} has")


plot.register(Percept, plot_sensation)
plot.register(Ranking, plot_confusion)
plot.register(Sensitivity, plot_sensitivity)
plot.register(Frontier, plot_frontier)
plot.register(PerceptualMap, plot_map)


def as_svg(axes: Axes) -> str:
    """The figure of some axes as SVG text, for a notebook."""
    held = io.StringIO()
    figure: Any = axes.figure
    figure.savefig(held, format="svg", bbox_inches="tight")
    text = held.getvalue()
    return text[text.index("<svg") :]
