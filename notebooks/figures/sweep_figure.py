"""Figures of a sweep over one key: a panel a quantity, a line an icon, of what the rig does and what people feel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from .style import GREY, INK
from .sweep_axes import (
    MOST_NARROW_TICKS,
    MOST_TICKS,
    WIDE,
    draw_line,
    icon_styles,
    key_axis,
    key_label,
    key_places,
    small_multiples,
    sweep_legend,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANELS = (
    (("largest_miss_K",), "largest miss (K)"),
    (("current_min_A", "current_max_A"), "current (A), least dashed"),
    (("energy_J",), "electrical energy (J)"),
    (("display_min_C", "display_max_C"), "display (°C), least dashed"),
    (("skin_min_C", "skin_max_C"), "skin (°C), least dashed"),
    (("cold_receptor_peak_change_K",), "peak, cold receptor (K)"),
    (("warm_receptor_peak_change_K",), "peak, warm receptor (K)"),
    (("cold_receptor_attack_K_per_s",), "attack, cold receptor (K/s)"),
    (("cold_receptor_delay_s",), "delay, cold receptor (s)"),
)
"""Columns of a sweep, and what stands above their panel."""
ALIKE, MISS_K = 1e-3, 1e-3
"""What differs by less than 0.1 % is the same at all values; and so are misses within 1 mK."""
FLAT = 0.05
"""Share of its value that an axis shows around what is the same everywhere."""
LABELS = {
    "correct": "correct (%)",
    "correct_95": "correct (%),\n95 % of people reach",
    "detected": "detected (%)",
    "onset_s": "onset (s)",
    "d_prime": "d′ of the nearest icon",
    "bits": "information (bits)",
}
SHARES = ("correct", "correct_95", "detected")
BAND = 0.065
"""How dark the band of an icon is; that of the set is twice as dark."""
STEP, LEAST_SPAN = 10.0, 20.0
"""Axes of shares end at tens, and show 20 % at least."""


def sweep_figure(frame: pd.DataFrame, key: str, log: bool = False, across: int = WIDE) -> Figure:
    """Draw the table of a sweep, one panel per quantity and one line per icon.

    Icons that mainly cool are blue, others orange, and each has its own mark. A cross stands for an icon that was not
    reached, a grey band for values at which nothing could be played. What is the same at all values is left out and
    named below.

    Parameters
    ----------
    frame
        The table that `sweep` returns.
    key
        The column on the abscissa: the key of the rig that was varied.
    log
        Whether the abscissa is logarithmic.
    across
        Panels beside one another.

    Returns
    -------
    matplotlib.figure.Figure
        A figure that is not shown.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import load_library
    >>> from thermicon.notebooks import sweep
    >>> step, key = load_library("six-icons")["cooling-step"], "driver.current_limit_A"
    >>> len(sweep_figure(sweep([step], Rig.load("thenar"), key, [1.0, 1.5]), key).axes)
    5
    """
    flat = [columns for columns, _ in PANELS if _same(frame, columns)]
    panels = [panel for panel in PANELS if panel[0] not in flat] or list(PANELS)
    figure, axes = small_multiples(len(panels), across)
    styles, missed = icon_styles(frame), frame["reached"] == False  # noqa: E712
    places, names = key_places(frame, key)
    for ax, (columns, label) in zip(axes, panels, strict=True):
        for name, style in styles.items():
            rows = frame[frame["icon"] == name]
            for column in columns:
                values = rows[column].abs() if column == "largest_miss_K" else rows[column]
                dashes = "-" if column == columns[-1] else "--"
                draw_line(ax, places[rows.index], values, missed[rows.index], style, ls=dashes)
        # above the axis at the right, where a letter of the panel may stand at the left
        ax.set_ylabel(label, fontsize=8, rotation=0, ha="right", va="bottom")
        ax.yaxis.set_label_coords(1.0, 1.02)
        ax.margins(y=0.1)
        key_axis(ax, names, log, places, MOST_NARROW_TICKS if across < WIDE else MOST_TICKS)
        if columns in flat:
            _calm(ax)
        if columns == ("largest_miss_K",):
            ax.set_ylim(bottom=0.0)
    shaded = _shade(axes, frame, places)
    sweep_legend(figure, styles, bool(missed.any()), shaded)
    left_out = [label.partition(" (")[0] for columns, label in PANELS if columns in flat and len(panels) < len(PANELS)]
    below = [f"the same at all values: {'; '.join(left_out)}"] if left_out else []
    figure.supxlabel("\n".join([key_label(key), *below]), fontsize=10)
    return figure


def _same(frame: pd.DataFrame, columns: tuple[str, ...]) -> bool:
    """Whether a quantity is the same at all values of the key, for every icon."""
    if columns == ("largest_miss_K",):
        return bool(frame["largest_miss_K"].abs().max() < MISS_K)
    held = frame.groupby("icon")[list(columns)]
    spread, largest = held.max() - held.min(), frame[list(columns)].abs().max()
    return bool((spread <= ALIKE * largest).to_numpy().all())


def _calm(ax: Axes) -> None:
    """Limits around what is the same everywhere, whose last digits are noise."""
    low, high = ax.dataLim.y0, ax.dataLim.y1
    around = max(FLAT * max(abs(low), abs(high)), ALIKE)
    ax.set_ylim(low - around, high + around)


def _shade(axes: list[Axes], frame: pd.DataFrame, places: pd.Series) -> bool:
    """Shade the stretches of the key in which no icon could be played; whether there are any."""
    lost = frame.groupby(places)["duration_s"].count() == 0
    values = lost.index.to_numpy(dtype=float)
    for k in lost.to_numpy().nonzero()[0]:
        low = values[k] if k == 0 else 0.5 * (values[k - 1] + values[k])
        high = values[k] if k == len(values) - 1 else 0.5 * (values[k] + values[k + 1])
        for ax in axes:
            ax.axvspan(low, high, color=GREY, alpha=0.18, lw=0.0, zorder=0)
    return bool(lost.any())


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
        for icon, style in {**styles, whole: (INK, "")}.items():
            rows, thick = frame[frame["icon"] == icon], 2.0 if icon == whole else 1.0
            # the d′ of the set is the lower edge of the icons' lines
            if rows[value].isna().all() or (icon == whole and value == "d_prime" and styles):
                continue
            at = places[rows.index]
            draw_line(ax, at, scale * rows[value], missed[rows.index], style, lw=1.1 * thick)
            if interval and rows[interval[0]].notna().any():
                banded = True
                low, high = (scale * rows[name].astype(float) for name in interval)
                ax.fill_between(at, low, high, color=style[0], alpha=BAND * thick, lw=0.0, zorder=1)
        ax.set_ylabel(LABELS[value], fontsize=9)
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
    low, high = ax.dataLim.y0, ax.dataLim.y1
    low = max(0.0, STEP * math.floor(low / STEP))
    high = min(100.0, STEP * math.ceil(high / STEP))
    low = max(0.0, min(low, high - LEAST_SPAN))
    high = max(high, low + LEAST_SPAN)
    return low, high + 0.03 * (high - low)
