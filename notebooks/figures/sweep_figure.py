"""Figures of sweeps: a panel a quantity and a line an icon over one key of the rig, heat maps over two."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .style import COOL, GREY, INK, WARM, plain

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

COOLS = ("#0b3c6f", "#2166ac", "#5aa5dc", "#9ccbee")
WARMS = ("#7a3603", "#e08214", "#f3a95c", "#fbc894")
MARKS, MISSED = "osD^vP*h", "x"
MOST_TICKS, MOST_NARROW_TICKS = 6, 3
WIDE = 3
"""Panels beside one another, fewer in a column."""
COLUMN_INCHES, HIGHEST, LOWEST = 5.4, 2.6, 1.1
"""Height of all panels of a figure for a column (in print at most 1.2 widths tall), and of one panel."""
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
MOST_ROWS = 6
SHADES, BLUE_ORANGE = "cividis", "blue to orange"
QUANTITIES = (
    ("largest_miss_K", "largest miss (K)", SHADES),
    ("energy_J", "electrical energy (J)", SHADES),
    ("cold_receptor_peak_change_K", "peak change,\ncold receptor (K)", BLUE_ORANGE),
    ("warm_receptor_peak_change_K", "peak change,\nwarm receptor (K)", BLUE_ORANGE),
)
"""Columns of a sweep over two keys, their labels and colour maps; the diverging map is centred on 0."""


def sweep_figure(frame: pd.DataFrame, key: str, log: bool = False, across: int = WIDE) -> Figure:
    """Draw the table that `sweep` returns over its `key`, on a logarithmic abscissa if asked, `across` panels in a row.

    Icons that mainly cool are blue, others orange, and each has its own mark. A cross stands for an icon that was not
    reached, a grey band for values at which nothing could be played. What is the same at all values is left out and
    named below.
    """
    flat = [columns for columns, _ in PANELS if _same(frame, columns)]
    panels = [panel for panel in PANELS if panel[0] not in flat] or list(PANELS)
    figure, axes = _small_multiples(len(panels), across)
    styles, missed = _icon_styles(frame), frame["reached"] == False  # noqa: E712
    places, names = _key_places(frame, key)
    for ax, (columns, label) in zip(axes, panels, strict=True):
        for name, style in styles.items():
            rows = frame[frame["icon"] == name]
            for column in columns:
                values = rows[column].abs() if column == "largest_miss_K" else rows[column]
                dashes = "-" if column == columns[-1] else "--"
                _draw_line(ax, places[rows.index], values, missed[rows.index], style, ls=dashes)
        # above the axis at the right, where a letter of the panel may stand at the left
        ax.set_ylabel(label, fontsize=8, rotation=0, ha="right", va="bottom")
        ax.yaxis.set_label_coords(1.0, 1.02)
        ax.margins(y=0.1)
        _key_axis(ax, names, log, places, MOST_NARROW_TICKS if across < WIDE else MOST_TICKS)
        if columns == ("largest_miss_K",):
            ax.set_ylim(bottom=0.0)
    shaded = _shade(axes, frame, places)
    _legend(figure, styles, bool(missed.any()), shaded)
    left_out = [label.partition(" (")[0] for columns, label in PANELS if columns in flat and len(panels) < len(PANELS)]
    below = [f"the same at all values: {'; '.join(left_out)}"] if left_out else []
    figure.supxlabel("\n".join([key_label(key), *below]), fontsize=10)
    return figure


def measure_figure(
    frame: pd.DataFrame, key: str, columns: Sequence[Sequence[str]], whole: str, log: bool = False, across: int = 2
) -> Figure:
    """Draw what was measured against the key, with bands or bars of 95 % for a new laboratory.

    `columns` are value, and where it has an interval its lower and upper end, of each quantity; `whole` is the name of
    the rows of the whole set.
    """
    figure, axes = _small_multiples(len(columns), across, 3.6)
    places, names = _key_places(frame, key)
    measured = frame[[value for value, *_ in columns]].notna().any(axis=1)
    styles = _icon_styles(frame[(frame["icon"] != whole) & measured])
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
            _draw_line(ax, at, scale * rows[value], missed[rows.index], style, lw=1.1 * thick)
            if interval and rows[interval[0]].notna().any():
                banded = True
                low, high = (scale * rows[name].astype(float) for name in interval)
                ax.fill_between(at, low, high, color=style[0], alpha=BAND * thick, lw=0.0, zorder=1)
        ax.set_ylabel(LABELS[value], fontsize=9)
        if value in SHARES:
            ax.set_ylim(*_share_limits(ax))
        else:
            ax.set_ylim(bottom=0.0)
        _key_axis(ax, names, log, places)
    band = "95 % interval, new laboratory" if banded else ""
    _legend(figure, styles, bool(missed.any()), False, whole=whole, band=band)
    figure.align_ylabels(axes)
    figure.supxlabel(key_label(key), fontsize=10)
    return figure


def sweep_map(
    frame: pd.DataFrame, key: str, second: str, quantities: Sequence[tuple[str, str, str]] = QUANTITIES
) -> Figure:
    """Draw heat maps of a sweep over two keys: one row per icon, of which there are six at most, one column a quantity.

    Quantities are columns with their labels and colour maps. A circle marks a combination at which the icon was not
    reached; combinations that could not be played are grey.
    """
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    names = [str(name) for name in frame["icon"].unique()][:MOST_ROWS]
    figure = Figure(figsize=(1.1 + 2.6 * len(quantities), 1.2 + 2.1 * len(names)), layout="constrained")
    axes = figure.subplots(len(names), len(quantities), sharex=True, sharey=True, squeeze=False)
    for column, (quantity, label, colours) in enumerate(quantities):
        shown = frame.loc[frame["icon"].isin(names), quantity].abs() if "miss" in quantity else frame[quantity]
        high = float(np.nanmax(np.abs(shown))) or 1.0
        low: float = 0.0
        shades: Any = colours
        if colours == BLUE_ORANGE:
            low, shades = -high, LinearSegmentedColormap.from_list(BLUE_ORANGE, [COOL, "#ffffff", WARM])
        for row, name in enumerate(names):
            image = _map(axes[row, column], frame[frame["icon"] == name], (key, second, quantity), shades, (low, high))
        bar = figure.colorbar(
            image, ax=list(axes[:, column]), location="top", label=label, shrink=0.9, ticks=MaxNLocator(2)
        )
        bar.ax.tick_params(labelsize=7)
    for row, name in enumerate(names):
        axes[row, 0].set_ylabel(name, fontsize=9)
    figure.supxlabel(key_label(key), fontsize=10)
    figure.supylabel(key_label(second), fontsize=10)
    return figure


def key_label(key: str) -> str:
    """The key in words with its unit; an age is in years."""
    from thermicon.circuit.rig.faults import name_of, unit_of

    unit = "years" if key.endswith("_years") else unit_of(key)
    words = name_of(key).removesuffix("_years").replace(".", " ").replace("_", " ")
    words = words.replace("seebeck", "Seebeck coefficient")
    return f"{words} ({unit})" if unit else words


def _same(frame: pd.DataFrame, columns: tuple[str, ...]) -> bool:
    """Whether a quantity is the same at all values of the key, for every icon."""
    if columns == ("largest_miss_K",):
        return bool(frame["largest_miss_K"].abs().max() < MISS_K)
    held = frame.groupby("icon")[list(columns)]
    spread, largest = held.max() - held.min(), frame[list(columns)].abs().max()
    return bool((spread <= ALIKE * largest).to_numpy().all())


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


def _share_limits(ax: Axes) -> tuple[float, float]:
    """Limits in per cent that hold all lines and bands: tens, with room for the marks at 100 %."""
    low, high = ax.dataLim.y0, ax.dataLim.y1
    low = max(0.0, STEP * math.floor(low / STEP))
    high = min(100.0, STEP * math.ceil(high / STEP))
    low = max(0.0, min(low, high - LEAST_SPAN))
    high = max(high, low + LEAST_SPAN)
    return low, high + 0.03 * (high - low)


def _small_multiples(count: int, across: int, wide: float = 3.2) -> tuple[Figure, list[Axes]]:
    """A figure with so many panels on one abscissa; those with none below them have its numbers."""
    from matplotlib.figure import Figure

    across = min(across, count)
    down = -(-count // across)
    height = HIGHEST if across >= WIDE or down == 1 else max(LOWEST, min(HIGHEST, COLUMN_INCHES / down))
    figure = Figure(figsize=(wide * across, 0.4 + height * down), layout="constrained")
    axes = list(figure.subplots(down, across, sharex=True, squeeze=False).flat)
    for ax in axes[count:]:
        ax.remove()
    for ax in axes[max(0, count - across) : count]:
        ax.tick_params(labelbottom=True)
    for ax in axes[:count]:
        ax.tick_params(labelsize=8)
        plain(ax)
    return figure, axes[:count]


def _key_places(frame: pd.DataFrame, key: str) -> tuple[pd.Series, list[str]]:
    """Where the rows stand on the abscissa, and the names there: those of a key whose values are names."""
    values = frame[key]
    if values.dtype == "float64":
        return values, []
    names = [str(name) for name in values.unique()]
    return values.map({name: float(place) for place, name in enumerate(names)}).astype("float64"), names


def _key_axis(ax: Axes, names: list[str], log: bool, places: pd.Series, most: int = MOST_TICKS) -> None:
    """Names in the place of numbers; or equal ratios with ticks at the values, of many labels at every second or so."""
    from matplotlib.ticker import FixedFormatter, FixedLocator, NullFormatter

    if names:
        ax.set_xticks(range(len(names)), names, rotation=30, ha="right")
        ax.margins(x=0.08)
    elif log:
        values = sorted(set(places.astype(float)))
        ax.set_xscale("log")
        labelled = values[:: -(-(len(values) - 1) // (most - 1)) or 1]
        ax.xaxis.set_major_locator(FixedLocator(labelled))
        ax.xaxis.set_major_formatter(FixedFormatter([f"{value:.3g}" for value in labelled]))
        ax.xaxis.set_minor_locator(FixedLocator([value for value in values if value not in labelled]))
        ax.xaxis.set_minor_formatter(NullFormatter())


def _draw_line(
    ax: Axes,
    at: pd.Series,
    values: pd.Series,
    missed: pd.Series,
    style: tuple[str, str],
    lw: float = 1.3,
    ls: str = "-",
) -> None:
    """Draw one icon over the key, with crosses on a white ground where it was not reached."""
    from matplotlib.patheffects import withStroke

    color, mark = style
    ax.plot(at, values, color=color, marker=mark or None, ms=4, lw=lw, ls=ls, zorder=2 + lw)
    if missed.any():
        ground = [withStroke(linewidth=4.0, foreground="white")]
        ax.scatter(
            at[missed], values[missed], color=color, marker=MISSED, s=26, linewidths=1.3, zorder=6, path_effects=ground
        )


def _icon_styles(frame: pd.DataFrame) -> dict[str, tuple[str, str]]:
    """Colour and mark of every icon: blue where its larger change at the cold receptors is a cooling, else orange."""
    styles, used = {}, {True: 0, False: 0}
    for place, name in enumerate(frame["icon"].unique()):
        change = frame.loc[frame["icon"] == name, "cold_receptor_peak_change_K"].median()
        cools = bool(change < 0)
        shades = COOLS if cools else WARMS
        styles[str(name)] = (shades[(used[cools] + 1) % len(shades)], MARKS[place % len(MARKS)])
        used[cools] += 1
    return styles


def _legend(
    figure: Figure, styles: dict[str, tuple[str, str]], missed: bool, shaded: bool, whole: str = "", band: str = ""
) -> None:
    """The key of a sweep: icons, the whole set where it is named, bands, what was not reached or impossible."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Line2D | Patch] = [
        Line2D([], [], color=color, marker=mark, markersize=5, lw=1.3, label=name)
        for name, (color, mark) in styles.items()
    ]
    if whole:
        handles.append(Line2D([], [], color=INK, lw=2.2, label=whole))
    if band:
        handles.append(Patch(color=INK, alpha=0.15, lw=0.0, label=band))
    if missed:
        crossed: dict[str, Any] = {"marker": MISSED, "markersize": 6, "markeredgecolor": GREY, "markeredgewidth": 1.5}
        handles.append(Line2D([], [], color="none", label="not reached", **crossed))
    if shaded:
        handles.append(Patch(color=GREY, alpha=0.18, label="impossible"))
    figure.legend(handles=handles, loc="outside upper center", ncols=4, frameon=False, fontsize=9)


def _map(
    ax: Axes, rows: pd.DataFrame, columns: tuple[str, str, str], colours: Any, limits: tuple[float, float]
) -> AxesImage:
    """Draw one quantity of one icon in the order in which both keys take their values, marked where it was missed."""
    key, second, quantity = columns

    def grid(column: str) -> pd.DataFrame:
        made = rows.pivot(index=second, columns=key, values=column)
        return made.reindex(index=rows[second].unique(), columns=rows[key].unique())

    values = grid(quantity)
    cells = np.abs(values.to_numpy(dtype=float)) if "miss" in quantity else values.to_numpy(dtype=float)
    image = ax.imshow(cells, origin="lower", aspect="auto", cmap=colours, vmin=limits[0], vmax=limits[1])
    ax.set_facecolor(GREY)
    up, across = np.nonzero(~grid("reached").astype("boolean").fillna(True).to_numpy(dtype=bool))
    if len(up):
        ax.scatter(across, up, s=20, facecolors="white", edgecolors="black", linewidths=0.7)
    for axis, ends in ((ax.xaxis, values.columns), (ax.yaxis, values.index)):
        places = np.unique(np.linspace(0, len(ends) - 1, min(len(ends), MOST_TICKS)).round().astype(int))
        names = [ends[k] if isinstance(ends[k], str) else f"{ends[k]:g}" for k in places]
        axis.set_ticks(list(places), names, fontsize=8)
    return image
