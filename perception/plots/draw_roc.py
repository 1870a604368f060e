"""Receiver operating characteristic: hits against false alarms, by the d′ of an icon's detection or of a pair."""

from __future__ import annotations

from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.solver.draw import COOL, WARM, new_axes

from ..sensation.percept import Percept

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..ranking.scores import PairScore

STEPS = 400
NORMAL = NormalDist()


def plot_roc(shown: Percept | PairScore, ax: Axes | None = None) -> Axes:
    """Draw the share of hits against that of false alarms over all criteria, h = Φ(d′ + Φ⁻¹(f)).

    Of a percept it is the detection of the icon by each channel whose sensation rises, with the largest rise as d′:
    hits are reports of the icon, false alarms reports of nothing. Of a pair of a ranking it is telling the second icon
    from the first in one trial, with its d′ from memory, the median over people. The area below, Φ(d′/√2), is what a
    choice between two intervals gets right.
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
    axes.set_xlabel(f"false alarms: {alarms} (%)")
    axes.set_ylabel(f"hits: {hits} (%)")
    axes.set_title(name)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="lower right", frameon=False, fontsize="small")
    return axes
