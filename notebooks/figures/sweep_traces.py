"""Curves of a sweep over one another in colours of the values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .style import plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from thermicon.circuit import Trace

DARKEST, PALEST = 0.0, 0.88
"""The part of the colour map that is seen on white."""
SHOWN = {"skin_C": "skin (°C)", "display_C": "display (°C)", "current_A": "current (A)"}
"""Columns of traces that may be drawn, and what the axis says."""
Curves = Mapping[str, Mapping[Any, "Trace"]]
"""Traces by icon and by value of the key."""


def draw_curves(axes: list[Axes], curves: Curves, label: str, *, log: bool) -> None:
    """Draw the traces of each icon on axes of its own, with one colour bar: of what varies most with the key.

    The clocks of an icon are alike at all values.
    """
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, LogNorm, Normalize

    column = max(SHOWN, key=lambda name: _share(curves, name))
    values = sorted({value for traces in curves.values() for value in traces})
    named = isinstance(values[0], str)
    shades = dict(zip(values, range(len(values)) if named else values, strict=True))
    norm = (LogNorm if log else Normalize)(min(shades.values()), max(shades.values()))
    colours = ListedColormap(colormaps["viridis"](np.linspace(DARKEST, PALEST, 256)))
    for ax, (name, traces) in zip(axes, curves.items(), strict=True):
        for value, trace in traces.items():
            ax.plot(trace.time_s, getattr(trace, column), color=colours(norm(shades[value])), lw=1.3)
        ax.set_title(name, fontsize=8, loc="right").set_parse_math(False)
        ax.set_xlabel("time (s)", fontsize=8)
        ax.tick_params(labelsize=8)
        ax.margins(x=0.0)
        ax.locator_params(axis="y", nbins=3)
    axes[0].set_ylabel(SHOWN[column], fontsize=8)
    plain(*axes)
    figure: Any = axes[0].figure
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, pad=0.02, aspect=14)
    bar.set_label(label, fontsize=8)
    bar.ax.tick_params(labelsize=8)
    if named:
        bar.set_ticks([*shades.values()], labels=values)


def _share(curves: Curves, column: str) -> float:
    """How far a column differs between values of the key at one time, as a share of its range; 0 without one."""
    shares = []
    for traces in curves.values():
        drawn = np.array([getattr(trace, column) for trace in traces.values()])
        shares.append(float(np.ptp(drawn, axis=0).max()) / max(float(np.ptp(drawn)), 1e-9))
    return float(np.nan_to_num(max(shares)))
