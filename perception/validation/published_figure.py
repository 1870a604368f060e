"""The first figure of the validation report: everything that was published, beside its prediction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..plots.draw_published import plot_published, published_legend
from .comparisons import comparisons
from .validate_figures import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .validate import ValidationReport

NAME = "published-predicted"
CAPTION = (
    "Prediction over published number, on a log axis, with 95 % intervals. Left: the experiments that the constants "
    "were inferred from, each predicted from the others; the interval is that of what would be measured, and a filled "
    "marker means that it contains the published number. Right: targets that were never conditioned on, predicted from "
    "temperature; the interval is what the constants leave open, and a filled marker means that the target's criterion "
    "holds. Grey boxes: published numbers with their error, or the criterion where only that was published."
)
ROW_IN, HEAD_IN = 0.162, 1.0


def published_figure(report: ValidationReport) -> Figure:
    """Draw every published number beside its prediction: left out on the left, other targets on the right."""
    rows = comparisons(report.conditioning, report.sections)
    halves = [[row for row in rows if row.left_out == left_out] for left_out in (True, False)]
    lines = [len(half) + len({row.group for row in half}) for half in halves]
    figure = new_figure(12.6, ROW_IN * max(lines) + HEAD_IN)
    figure.set_layout_engine("none")
    bottom, top = 0.5 / figure.get_figheight(), 1.0 - 0.45 / figure.get_figheight()
    tall = (top - bottom) * min(lines) / max(lines)
    # Rows are as high in both panels; the legend stands where the shorter one ends.
    places = ((0.205, bottom, 0.285, top - bottom), (0.705, top - tall, 0.285, tall))
    titles = ("Predicted from the other experiments", "Never conditioned on")
    for place, half, title in zip(places, halves, titles, strict=True):
        axes = plot_published(half, figure.add_axes(place))
        axes.set_title(title, loc="right", fontsize=9.5, fontweight="bold", pad=4)
    below = top - tall - 0.65 / figure.get_figheight()
    figure.legend(
        handles=published_legend(), loc="upper center", bbox_to_anchor=(0.78, below), ncols=2, fontsize=8, frameon=False
    )
    return figure
