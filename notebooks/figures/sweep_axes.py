"""What figures of sweeps share: panels on one axis of the key, a colour and a mark an icon, crosses, the legend."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .style import GREY, INK, plain

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COOLS = ("#0b3c6f", "#2166ac", "#5aa5dc", "#9ccbee")
WARMS = ("#7a3603", "#e08214", "#f3a95c", "#fbc894")
MARKS = "osD^vP*h"
MISSED = "x"
MOST_TICKS, MOST_NARROW_TICKS = 6, 3
WIDE = 3
"""Panels beside one another, fewer in a column."""
COLUMN_INCHES = 5.4
"""Height of all panels of a figure for a column, as drawn for the screen: in print it is at most 1.2 widths tall."""
HIGHEST, LOWEST = 2.6, 1.1


def small_multiples(count: int, across: int, wide: float = 3.2) -> tuple[Figure, list[Axes]]:
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


def draw_line(
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
