"""The picture of a percept: both sensations over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from thermicon.circuit.solver.draw import COOL, WARM, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..sensation.percept import Percept

CLOCK = "response clock: with conduction and decision"
NOMINAL = "by the nominal person"


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
    axes.set_xlabel(f"time (s), {percept.clock} clock")
    axes.set_ylabel("sensation (d′)")
    axes.set_title(percept.icon or "percept")
    axes.set_xlim(0.0, float(percept.time_s[-1]))
    axes.set_ylim(bottom=0.0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize="small", framealpha=0.8)
    return axes
