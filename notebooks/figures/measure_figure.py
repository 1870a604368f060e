"""The figure of a sweep over what people perceive: a panel a quantity, a line an icon, the set in black, intervals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from .overview import INK
from .sweep_figure import draw_missed, icon_styles, key_axis, key_label, key_places, small_multiples, sweep_legend

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LABELS = {
    "correct": "correct (%)",
    "correct_95": "correct (%),\n95 % of people reach",
    "detected": "detected (%)",
    "onset_s": "onset (s)",
    "d_prime": "d′ of the nearest icon",
    "bits": "information (bits)",
}
SHARES = ("correct", "correct_95", "detected")
BAND = 0.13
STEP, LEAST_SPAN = 10.0, 20.0
"""Axes of shares end at tens, and show 20 % at least."""


def measure_figure(
    frame: pd.DataFrame, key: str, columns: Sequence[Sequence[str]], whole: str, log: bool = False, across: int = 2
) -> Figure:
    """Draw what was measured against the key, with bands or bars of 95 % for a new laboratory.

    Parameters
    ----------
    frame
        The table of a sweep with measures.
    key
        The column on the abscissa.
    columns
        Value, and where it has an interval its lower and upper end, of each quantity.
    whole
        Name of the rows of the whole set.
    log
        Whether the abscissa is logarithmic.
    across
        Panels beside one another.
    """
    figure, axes = small_multiples(len(columns), across, 3.6)
    places, names = key_places(frame, key)
    measured = frame[[value for value, *_ in columns]].notna().any(axis=1)
    styles = icon_styles(frame[(frame["icon"] != whole) & measured])
    missed = frame["reached"] == False  # noqa: E712
    banded = False
    for ax, (value, *interval) in zip(axes, columns, strict=True):
        scale = 100.0 if value in SHARES else 1.0
        for icon, (color, mark) in {**styles, whole: (INK, "")}.items():
            rows = frame[frame["icon"] == icon]
            if not len(rows) or rows[value].isna().all():
                continue
            if icon == whole and value == "d_prime" and styles:
                continue  # it is the lower edge of the icons' lines
            at = places[rows.index]
            style: dict[str, Any] = {"lw": 2.2, "zorder": 4} if icon == whole else {"lw": 1.2, "zorder": 3}
            ax.plot(at, scale * rows[value], color=color, marker=mark or None, ms=4, **style)
            lost = missed[rows.index]
            draw_missed(ax, at[lost], scale * rows[value][lost], color)
            if interval and rows[interval[0]].notna().any():
                banded = True
                low, high = (scale * rows[name].astype(float) for name in interval)
                ax.fill_between(
                    at, low, high, color=color, alpha=BAND if icon == whole else 0.5 * BAND, lw=0.0, zorder=1,
                )  # fmt: skip
        ax.set_ylabel(LABELS[value], fontsize=9)
        ax.tick_params(labelsize=8)
        ax.grid(alpha=0.25, linewidth=0.6)
        ax.spines[["top", "right"]].set_visible(False)
        if value in SHARES:
            ax.set_ylim(*_share_limits(ax))
        else:
            ax.set_ylim(bottom=0.0)
        key_axis(ax, names, log, places)
    band = "95 % interval, new laboratory" if banded else ""
    sweep_legend(figure, styles, bool(missed.any()), False, whole=whole, band=band)
    figure.align_ylabels(axes)
    figure.supxlabel(key_label(key), fontsize=10)
    return figure


def _share_limits(ax: Axes) -> tuple[float, float]:
    """Limits in per cent that hold all lines and bands: tens, with room for the marks at 100 %."""
    import math

    low, high = ax.dataLim.y0, ax.dataLim.y1
    low = max(0.0, STEP * math.floor(low / STEP))
    high = min(100.0, STEP * math.ceil(high / STEP))
    low = max(0.0, min(low, high - LEAST_SPAN))
    high = max(high, low + LEAST_SPAN)
    return low, high + 0.03 * (high - low)
