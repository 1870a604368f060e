"""The choice of a picture by the type of the result."""

from __future__ import annotations

import io
from functools import singledispatch
from statistics import NormalDist
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.base.checks.arguments import InputError
from thermicon.circuit.solver.draw import COOL, WARM, new_axes

from ..identification.map import PerceptualMap
from ..pilot.observed import Observed
from ..ranking.ranking import Ranking
from ..ranking.scores import PairScore
from ..ranking.sensitivity import Sensitivity
from ..selection.frontier import Frontier
from ..sensation.percept import Percept
from .draw_heat import plot_confusion
from .draw_map import plot_map
from .film import Film as Film

if TYPE_CHECKING:
    from matplotlib.axes import Axes


CLOCK = "response clock: with conduction and decision"
NOMINAL = "by the nominal person"
DARK, GREY = "0.15", "0.55"
HEIGHT = 0.38
STEPS, NORMAL = 400, NormalDist()
MOST = 16
"""Further constants explain less than chance does."""


@singledispatch
def plot(result: object, ax: Axes | None = None) -> Axes:
    """Draw a result: a percept as its sensations, a ranking as its confusion matrix, one of its pairs as its ROC.

    Parameters
    ----------
    result
        A Percept, Ranking, PairScore, Sensitivity, Frontier, Observed or PerceptualMap.
    ax
        Axes to draw on; None: new ones.

    Returns
    -------
    Axes
        The axes with the picture.

    Raises
    ------
    InputError
        For what has no picture.

    Examples
    --------
    >>> plot([1.0, 2.0])
    Traceback (most recent call last):
    thermicon.base.checks.arguments.InputError: plot: result takes a Percept, ..., Observed or PerceptualMap, not a list
    """
    names = "a Percept, Ranking, PairScore, Sensitivity, Frontier, Observed or PerceptualMap"
    raise InputError(f"plot: result takes {names}, not a {type(result).__name__}")


def plot_sensation(percept: Percept, ax: Axes | None = None) -> Axes:
    """Both sensations on the clock of the receptors, and when the first is reported, which is later."""
    axes = new_axes(ax, (6.0, 3.2))
    axes.plot(percept.time_s, percept.psi_cold, color=COOL, lw=1.8, label="cold")
    axes.plot(percept.time_s, percept.psi_warm, color=WARM, lw=1.8, ls=(0, (5, 1.2)), label="warm")
    if percept.onset_s is not None:
        said = f"reported as {percept.channel} at {percept.onset_s:.2f} s {NOMINAL}\n({CLOCK})"
        axes.axvline(percept.onset_s, color="0.35", linewidth=1.0, linestyle=":", label=said)
    else:
        axes.plot([], [], " ", label=f"not felt {NOMINAL} (p {percept.detected_probability:.2f})")
    axes.set(xlabel="time (s), receptor clock", ylabel="sensation (d′)", title=percept.icon or "percept")
    axes.set_xlim(0.0, float(percept.time_s[-1]))
    axes.set_ylim(bottom=0.0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize="small", framealpha=0.8)
    return axes


def plot_frontier(found: Frontier, ax: Axes | None = None) -> Axes:
    """Draw the mean over people, what 95 % of them reach, chance, and the total time at every point."""
    axes, first = new_axes(ax, (8.2, 4.2)), found.points[0]
    sizes = np.array([len(point.icons) for point in found.points])
    alert = np.array([100.0 * point.at_own_range.felt_and_named for point in found.points])
    low = np.array([100.0 * point.reached for point in found.points])
    reach = "95 % of people reach, people and model" if found.draws else "95 % of people reach, nominal model"
    axes.fill_between(sizes, low, alert, color="0.9", linewidth=0)
    axes.plot(sizes, alert, color=DARK, marker="o", label="mean over people")
    axes.plot(sizes, low, color=GREY, marker="v", linestyle="--", label=reach)
    axes.plot(sizes, 100.0 / sizes, color=GREY, linestyle=":", label="chance")
    for size, value, point in zip(sizes.tolist(), alert.tolist(), found.points, strict=True):
        axes.annotate(
            f"{point.total_s:.0f} s", (size, value), (0, 7), textcoords="offset points", ha="center", fontsize=8
        )
    axes.set_xticks(sizes)
    axes.set_ylim(0.0, 112.0)
    axes.set_yticks(range(0, 101, 20))
    axes.set_xlim(float(sizes.min()) - 0.5, float(sizes.max()) + 0.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)
    by = first.objective.replace("-", " ")
    axes.set_xlabel(f"number of icons, the best of {first.pool} by {by}\n(above the points: total time)")
    axes.set_ylabel("felt and named (%)")
    axes.set_title("How many icons are distinguishable", loc="left")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8)
    return axes


def plot_sensitivity(found: Sensitivity, ax: Axes | None = None) -> Axes:
    """Draw the shares of the constants that count most, of what is named above bits."""
    shown = found.effects[:MOST]
    axes = new_axes(ax, (7.6, 1.4 + 0.34 * len(shown)))
    names = [effect.constant for effect in shown]
    places = np.arange(len(names))
    correct = np.array([effect.proportion_correct for effect in shown])
    bits = np.array([effect.information_bits for effect in shown])
    axes.barh(places - HEIGHT / 2, correct, HEIGHT, color="0.3", label="named")
    axes.barh(places + HEIGHT / 2, bits, HEIGHT, color="0.68", label="bits")
    axes.set_yticks(places, names)
    axes.invert_yaxis()
    axes.set_xlim(left=0.0)
    axes.tick_params(axis="y", length=0)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.grid(axis="x", alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("share of the variance\nbetween posterior draws")
    axes.set_title("Constants that carry the doubt", loc="left")
    axes.legend(frameon=False, loc="lower right")
    return axes


def plot_observed(found: Observed[Any, Any], ax: Axes | None = None) -> Axes:
    """Draw what is felt and named of each set with its 95 % interval, before the data were seen and, if any, after."""
    axes = new_axes(ax, (6.4, 1.4 + 0.6 * len(found.predictions)))
    places = np.arange(len(found.predictions), dtype=np.float64)
    marks = (("before", -HEIGHT / 3, GREY), ("after", HEIGHT / 3, DARK))
    for when, shift, colour in marks[:1] if found.unusable else marks:
        shares = [getattr(each, when).felt_and_named for each in found.predictions]
        middle, low, high = 100.0 * np.array(shares).T
        axes.errorbar(middle, places + shift, xerr=(middle - low, high - middle), fmt="o", color=colour, label=when)
    axes.set_yticks(places, [fill(each.before.title or "set", 20) for each in found.predictions])
    axes.set_ylim(len(places) - 0.5, -1.0)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set_xlabel("felt and named (%), mean over people\nand 95 % of laboratories")
    axes.set_title("Before and after the data", loc="left")
    axes.legend(frameon=False, loc="upper center", ncols=2)
    return axes


def plot_roc(shown: Percept | PairScore, ax: Axes | None = None) -> Axes:
    """Draw the share of hits against that of false alarms over all criteria, h = Φ(d′ + Φ⁻¹(f)).

    Of a percept d′ is the largest rise of each channel; of a pair of a ranking it is from memory. The area below,
    Φ(d′/√2), is what a choice between two intervals gets right.
    """
    axes = new_axes(ax, (4.2, 4.2))
    # Evenly spaced criteria and not false alarms, so that the curve is smooth in the corners too.
    criteria = np.linspace(-8.0, 8.0, STEPS)
    if isinstance(shown, Percept):
        name, alarms, hits = shown.icon or "percept", "reports of nothing", "reports of the icon"
        sides = (("cold", shown.psi_cold, COOL), ("warm", shown.psi_warm, WARM))
        curves = [(side, float((psi - psi[0]).max()), colour) for side, psi, colour in sides]
    else:
        name, alarms, hits = f"{shown.a} and {shown.b}", f"{shown.a} called {shown.b}", f"{shown.b} named"
        curves = [("from memory", shown.d_prime, "0.15")]
    axes.plot([0.0, 100.0], [0.0, 100.0], color="0.6", linestyle=":", linewidth=1.0, label="chance")
    for label, d_prime, colour in curves:
        if d_prime > 0.0 or label == "from memory":
            shares = [[100.0 * NORMAL.cdf(d - c) for c in criteria.tolist()] for d in (0.0, d_prime)]
            area = NORMAL.cdf(d_prime / 2.0**0.5)
            axes.plot(*shares, color=colour, lw=1.8, label=f"{label}: d′ {d_prime:.2f}, area {area:.3f}")
    axes.set(xlim=(0.0, 100.0), ylim=(0.0, 100.5), aspect="equal")
    axes.set(xlabel=f"false alarms: {alarms} (%)", ylabel=f"hits: {hits} (%)", title=name)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="lower right", frameon=False, fontsize="small")
    return axes


plot.register(Percept, plot_sensation)
plot.register(Ranking, plot_confusion)
plot.register(PairScore, plot_roc)
plot.register(Sensitivity, plot_sensitivity)
plot.register(Frontier, plot_frontier)
plot.register(Observed, plot_observed)
plot.register(PerceptualMap, plot_map)


def as_svg(axes: Axes) -> str:
    """The figure of some axes as SVG text, for a notebook."""
    held = io.StringIO()
    figure: Any = axes.figure
    figure.savefig(held, format="svg", bbox_inches="tight")
    text = held.getvalue()
    return text[text.index("<svg") :]
