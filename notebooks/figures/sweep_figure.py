"""The figure of a sweep: small multiples of what matters against the key, a line an icon."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .overview import GREY, INK

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COOLS = ("#0b3c6f", "#2166ac", "#5aa5dc", "#9ccbee")
WARMS = ("#7a3603", "#e08214", "#f3a95c", "#fbc894")
MARKS = "osD^vP*h"
MISSED = "x"
PANELS = (
    (("largest_miss_K",), "largest miss\n(K)", "largest miss (K)"),
    (("current_min_A", "current_max_A"), "current (A)\nleast dashed", "current (A), least dashed"),
    (("energy_J",), "electrical energy\n(J)", "electrical energy (J)"),
    (("display_min_C", "display_max_C"), "display (°C)\nleast dashed", "display (°C), least dashed"),
    (("skin_min_C", "skin_max_C"), "skin (°C)\nleast dashed", "skin (°C), least dashed"),
    (("cold_receptor_peak_change_K",), "peak change,\ncold receptor (K)", "peak, cold receptor (K)"),
    (("warm_receptor_peak_change_K",), "peak change,\nwarm receptor (K)", "peak, warm receptor (K)"),
    (("cold_receptor_attack_K_per_s",), "attack,\ncold receptor (K/s)", "attack, cold receptor (K/s)"),
    (("cold_receptor_delay_s",), "delay behind the skin,\ncold receptor (s)", "delay, cold receptor (s)"),
)
"""Columns of a sweep, the label of their panel, and the one above it where panels are low."""
ALIKE, MISS_K = 1e-3, 1e-3
"""What differs by less than 0.1 % is the same at all values; and so are misses within 1 mK."""
FLAT = 0.05
"""Share of its value that an axis shows around what is the same everywhere."""
MOST_DOWN = 3
"""Of more panels below one another each is lower, so that the figure fits on a page."""
MOST_TICKS, MOST_NARROW_TICKS = 6, 3
WIDE = 3
"""Panels beside one another, fewer in a column."""
COLUMN_INCHES = 5.4
"""Height of all panels of a figure for a column, as drawn for the screen: in print it is at most 1.2 widths tall."""
HIGHEST, LOWEST = 2.6, 1.1


def sweep_figure(frame: pd.DataFrame, key: str, log: bool = False, across: int = WIDE) -> Figure:
    """Draw the table of a sweep, one panel per quantity and one line per icon.

    Icons that mainly cool are blue, others orange, and each has its own mark. A cross stands for an icon that was not
    reached, a grey band for values at which nothing could be played. With fewer than three panels beside one another,
    as in a column of a journal, panels of what is the same at all values are left out and named below.

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
    9
    """
    narrow = across < WIDE
    flat = [columns for columns, *_ in PANELS if _same(frame, columns)]
    panels = [panel for panel in PANELS if not narrow or panel[0] not in flat] or list(PANELS)
    figure, axes = small_multiples(len(panels), across)
    above = narrow and -(-len(panels) // across) >= MOST_DOWN
    styles = icon_styles(frame)
    places, names = key_places(frame, key)
    for ax, (columns, label, short) in zip(axes, panels, strict=True):
        for name, (color, mark) in styles.items():
            rows = frame[frame["icon"] == name]
            _line(ax, rows, places[rows.index], columns, color, mark, 0.5 if above else 1.0)
        _label(ax, short if above else label, above)
        ax.tick_params(labelsize=8)
        ax.grid(alpha=0.25, linewidth=0.6)
        ax.spines[["top", "right"]].set_visible(False)
        key_axis(ax, names, log, places, MOST_NARROW_TICKS if narrow else MOST_TICKS)
        if columns == ("largest_miss_K",):
            ax.set_ylim(bottom=0.0)
            if columns in flat:
                ax.set_ylim(0.0, 0.1)
                ax.text(0.5, 0.5, "everywhere\nwithin 1 mK", ha="center", transform=ax.transAxes, fontsize=8)
        elif columns in flat:
            _calm(ax)
    shaded = _shade(axes, frame, places)
    sweep_legend(figure, styles, bool((frame["reached"] == False).any()), shaded)  # noqa: E712
    if not above:
        figure.align_ylabels(axes)
    left_out = [short for columns, _, short in PANELS if len(panels) < len(PANELS) and columns in flat]
    figure.supxlabel("\n".join([key_label(key), *_left_out(left_out)]), fontsize=10)
    return figure


def _same(frame: pd.DataFrame, columns: tuple[str, ...]) -> bool:
    """Whether a quantity is the same at all values of the key, for every icon."""
    if columns == ("largest_miss_K",):
        return bool(frame["largest_miss_K"].abs().max() < MISS_K)
    held = frame.groupby("icon")[list(columns)]
    spread, largest = held.max() - held.min(), frame[list(columns)].abs().max()
    return bool((spread <= ALIKE * largest).to_numpy().all())


def _label(ax: Axes, label: str, above: bool) -> None:
    """Beside the axis, or above it at the right, where a letter of the panel may stand at the left."""
    ax.set_ylabel(label, fontsize=9)
    if above:
        ax.margins(y=0.1)
        ax.set_ylabel(label, fontsize=8, rotation=0, ha="right", va="bottom")
        ax.yaxis.set_label_coords(1.0, 1.02)


def _calm(ax: Axes) -> None:
    """Limits around what is the same everywhere, whose last digits are noise."""
    low, high = ax.dataLim.y0, ax.dataLim.y1
    around = max(FLAT * max(abs(low), abs(high)), ALIKE)
    ax.set_ylim(low - around, high + around)


def _left_out(labels: list[str]) -> list[str]:
    """The line that names what is not drawn; none where all is."""
    names = [label.partition(" (")[0] for label in labels]
    return [f"the same at all values: {'; '.join(names)}"] if names else []


def small_multiples(count: int, across: int, wide: float = 3.2) -> tuple[Figure, list[Axes]]:
    """A figure with so many panels on one abscissa; those with none below them have its numbers."""
    from matplotlib.figure import Figure

    across = min(across, count)
    down = -(-count // across)
    height = HIGHEST if down <= MOST_DOWN else 1.8
    if across < WIDE and count > across:
        height = max(LOWEST, min(HIGHEST, COLUMN_INCHES / down))
    figure = Figure(figsize=(wide * across, 0.4 + height * down), layout="constrained")
    axes = list(figure.subplots(down, across, sharex=True, squeeze=False).flat)
    for ax in axes[count:]:
        ax.remove()
    for ax in axes[max(0, count - across) : count]:
        ax.tick_params(labelbottom=True)
    return figure, axes[:count]


def key_places(frame: pd.DataFrame, key: str) -> tuple[pd.Series, list[str]]:
    """Where the rows stand on the abscissa, and the names there: those of a key whose values are names."""
    values = frame[key]
    if values.dtype == "float64":
        return values, []
    names = [str(name) for name in values.unique()]
    return values.map({name: float(place) for place, name in enumerate(names)}).astype("float64"), names


def key_label(key: str) -> str:
    """The key in words with its unit; an age is in years.

    >>> key_label("contact.area_cm2"), key_label("module.seebeck_V_per_K"), key_label("age_years"), key_label("site")
    ('contact area (cm²)', 'module Seebeck coefficient (V/K)', 'age (years)', 'site')
    """
    from thermicon.circuit.rig.keyunits import name_of, unit_of

    unit = "years" if key.endswith("_years") else unit_of(key)
    words = name_of(key).removesuffix("_years").replace(".", " ").replace("_", " ")
    words = words.replace("seebeck", "Seebeck coefficient")
    return f"{words} ({unit})" if unit else words


def key_axis(ax: Axes, names: list[str], log: bool, places: pd.Series, most: int = MOST_TICKS) -> None:
    """Names in the place of numbers, or equal ratios with ticks at the values that were computed."""
    if names:
        ax.set_xticks(range(len(names)), names, rotation=30, ha="right")
        ax.margins(x=0.08)
    elif log:
        _log_axis(ax, sorted(set(places.astype(float))), most)


def _log_axis(ax: Axes, values: list[float], most: int) -> None:
    """Equal ratios on the abscissa, ticks at the values; of many, labels at every second, third and so on."""
    from matplotlib.ticker import FixedFormatter, FixedLocator, NullFormatter

    ax.set_xscale("log")
    every = -(-(len(values) - 1) // (most - 1)) or 1
    labelled = values[::every]
    ax.xaxis.set_major_locator(FixedLocator(labelled))
    ax.xaxis.set_major_formatter(FixedFormatter([f"{value:.3g}" for value in labelled]))
    ax.xaxis.set_minor_locator(FixedLocator([value for value in values if value not in labelled]))
    ax.xaxis.set_minor_formatter(NullFormatter())


def _line(
    ax: Axes, rows: pd.DataFrame, at: pd.Series, columns: tuple[str, ...], color: str, mark: str, size: float
) -> None:
    for place, column in enumerate(columns):
        values = rows[column].abs() if column == "largest_miss_K" else rows[column]
        ax.plot(at, values, color=color, lw=1.3, ls="-" if place == len(columns) - 1 else "--", zorder=2)
        missed = rows["reached"] == False  # noqa: E712
        ax.scatter(at[~missed], values[~missed], color=color, marker=mark, s=18 * size, linewidths=0.8, zorder=3)
        draw_missed(ax, at[missed], values[missed], color)


def draw_missed(ax: Axes, at: pd.Series, values: pd.Series, color: str) -> None:
    """Crosses on a white ground where an icon was not reached, above all else."""
    from matplotlib.patheffects import withStroke

    if len(at):
        ground = [withStroke(linewidth=4.0, foreground="white")]
        ax.scatter(at, values, color=color, marker=MISSED, s=26, linewidths=1.3, zorder=6, path_effects=ground)


def icon_styles(frame: pd.DataFrame) -> dict[str, tuple[str, str]]:
    """Colour and mark of every icon: blue where its larger change at the cold receptors is a cooling, else orange."""
    styles, used = {}, {True: 0, False: 0}
    for place, name in enumerate(frame["icon"].unique()):
        change = frame.loc[frame["icon"] == name, "cold_receptor_peak_change_K"].median()
        cools = bool(change < 0)
        shades = COOLS if cools else WARMS
        styles[str(name)] = (shades[(used[cools] + 1) % len(shades)], MARKS[place % len(MARKS)])
        used[cools] += 1
    return styles


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


def sweep_legend(
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
        cross = Line2D([], [], color="none", marker=MISSED, markersize=6, label="not reached")
        cross.set_markeredgecolor(GREY)
        cross.set_markeredgewidth(1.5)
        handles.append(cross)
    if shaded:
        handles.append(Patch(color=GREY, alpha=0.18, label="impossible"))
    figure.legend(handles=handles, loc="outside upper center", ncols=4, frameon=False, fontsize=9)
