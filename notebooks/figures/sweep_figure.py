"""The figure of a sweep: one panel per quantity with one line per icon."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.base.checks.arguments import InputError
from thermicon.circuit.rig.faults import name_of, unit_of
from thermicon.perception.ranking.swept import ALL, MEASURES

from .style import INK, SCREEN, Look, new_figure, plain
from .sweep_traces import Curves, draw_curves

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COOLS = ("#2166ac", "#5aa5dc", "#9ccbee", "#0b3c6f")
WARMS = ("#e08214", "#f3a95c", "#fbc894", "#7a3603")
MARKS = "osD^vP*h"
MOST_TICKS, LETTER_INCHES, TURNED_INCHES = 6, 0.08, 1.0
"""Ticks of an axis at most; room of a letter in the key, and of names that stand aslant below a narrow figure."""
WIDE = 3
"""Panels beside one another, fewer in a column."""
COLUMN_INCHES, HIGHEST = 6.8, 2.6
"""Height of the panels over the key in a figure for a column (in print at most 1.5 widths tall), and of one panel."""
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
    "felt_and_named": "felt and named (%)",
    "felt_and_named_95": "felt and named, 95 % of people (%)",
    "named": "named (%)",
    "named_95": "named, 95 % of people (%)",
    "detected": "detected (%)",
    "onset": "onset (s)",
    "d_prime": "d′ of the nearest icon",
    "bits": "information (bits)",
}
SHARES = ("felt_and_named", "named", "detected")
INTERVAL, MISSED = "95 % interval, new laboratory", "not reached"
BAND = 0.065
"""How dark the band of an icon is; that of the set is twice as dark."""


def sweep_figure(frame: pd.DataFrame, look: Look = SCREEN, curves: Curves | None = None) -> Figure:
    """Draw the table that `sweep` returns over its key: what the rig does, or what was measured of people.

    Above it stand the traces, if any, over one another.

    Icons that mainly cool are blue, others orange, and each has its own mark; a cross stands for an icon that was not
    reached. What the rig does alike at all values is left out and named below. Of people, bands are the 95 % of a new
    laboratory, and the black line is the whole set. The axis is logarithmic where values of the key
    are spaced more evenly in ratios than in steps.
    """
    if frame.columns[0] != "icon" or len(frame.columns) < 2:
        raise InputError("this is not a table of sweep(), whose first columns are icon and the key that was varied")
    key = str(frame.columns[1])
    what = [name for column in frame for name, columns in MEASURES.items() if columns[0] == column]
    panels = [(MEASURES[name], LABELS[name]) for name in what]
    same = [] if what else [label for columns, label in PANELS if _same(frame, columns)]
    if not what:
        panels = [panel for panel in PANELS if panel[1] not in same] or list(PANELS)
    across = look.across(2 if what else WIDE)
    figure, axes, above = _small_multiples(len(panels), across, len(curves or ()))
    handles: dict[str, Any] = {}
    values: list[Any] = sorted(frame[key].unique())
    if turned := isinstance(values[0], str) and look.narrow:
        figure.set_figheight(figure.get_figheight() + TURNED_INCHES)
    log = False
    if len(values) > 2 and not isinstance(values[0], str) and values[0] > 0.0:
        ratios, steps = np.diff(np.log(values)), np.diff(values)
        log = bool(np.ptp(ratios) / ratios.mean() < np.ptp(steps) / steps.mean())
    for ax, (columns, label) in zip(axes, panels, strict=True):
        for name, style in _icon_styles(frame).items():
            _draw(ax, frame[frame["icon"] == name], key, columns, style, handles)
        ax.set_title(label, fontsize=8, loc="right")  # where a letter of the panel may stand at the left
        if columns[0].startswith(SHARES):
            ax.set_ylim(top=100.5)
        elif what or columns == ("largest_miss_K",):
            ax.set_ylim(bottom=0.0)
        if log:  # ticks at the values, of many at every second or so
            named = values[:: -(-len(values) // MOST_TICKS)]
            ax.set_xscale("log")
            ax.set_xticks(named, [f"{value:.3g}" for value in named])
            ax.set_xticks([], minor=True)
        elif turned:
            ax.set_xticks(range(len(values)), [*frame[key].unique()], rotation=30, ha="right", rotation_mode="anchor")
    for name in [name for name in (INTERVAL, MISSED) if name in handles]:
        handles[name] = handles.pop(name)  # behind the icons
    across = int(figure.get_figwidth() / (0.6 + LETTER_INCHES * max(map(len, handles))))
    key_above: dict[str, Any] = {"loc": "outside upper center", "frameon": False, "fontsize": 9}
    figure.legend(handles.values(), handles.keys(), ncols=min(max(across, 1), 4), **key_above)
    alike = f"the same at all values: {'; '.join(label.partition(' (')[0] for label in same)}" * bool(same)
    # Print is wrapped anew for its letters.
    below = textwrap.wrap(alike, int(11 * figure.get_figwidth()) if look is SCREEN else len(alike) + 1)
    unit = "years" if key.endswith("_years") else unit_of(key)
    words = name_of(key).removesuffix("_years").replace(".", " ").replace("_", " ")
    words = words.replace("seebeck", "Seebeck coefficient") + f" ({unit})" * bool(unit)
    figure.supxlabel("\n".join([words, *below]), fontsize=10)
    if curves:
        draw_curves(above, curves, words, log=log)
    return figure


def _same(frame: pd.DataFrame, columns: tuple[str, ...]) -> bool:
    """Whether a quantity is the same at all values of the key, for every icon."""
    if columns == ("largest_miss_K",):
        return bool(frame["largest_miss_K"].abs().max() < MISS_K)
    held = frame.groupby("icon")[list(columns)]
    spread, largest = held.max() - held.min(), frame[list(columns)].abs().max()
    return bool((spread <= ALIKE * largest).to_numpy().all())


def _small_multiples(count: int, across: int, curves: int) -> tuple[Figure, list[Axes], list[Axes]]:
    """A figure with so many panels on one abscissa, and those of curves above; the others return first.

    Those with none below them have the numbers of the abscissa.
    """
    rows = -(-curves // across)
    across = min(across, count)
    down = -(-count // across)
    height = HIGHEST if across == WIDE else min(HIGHEST, COLUMN_INCHES / down)
    figure = new_figure(max(7.2, 3.2 * across), 0.4 + height * (down + rows))
    grid: Any = figure.add_gridspec(down, across)
    above: list[Axes] = []
    if curves:
        outer = figure.add_gridspec(2, 1, height_ratios=(rows, down))
        above = list(outer[0].subgridspec(rows, -(-curves // rows)).subplots(squeeze=False).flat)
        grid = outer[1].subgridspec(down, across)
    axes = list(grid.subplots(sharex=True, squeeze=False).flat)
    for ax in (*above[curves:], *axes[count:]):
        ax.remove()
    for place, ax in enumerate(axes[:count]):
        ax.tick_params(labelsize=8, labelbottom=place >= count - across)
        plain(ax)
    return figure, axes[:count], above[:curves]


def _draw(
    ax: Axes, rows: pd.DataFrame, key: str, columns: tuple[str, ...], style: tuple[str, str], handles: dict[str, Any]
) -> None:
    """Draw one icon over the key: of people the first column with the others as a band, else the last one solid."""
    color, mark = style
    whole, name = not mark, str(rows["icon"].iloc[0])
    at = rows[key].to_numpy(dtype=object if rows[key].dtype == "string" else float)
    scale = 100.0 if columns[0].startswith(SHARES) else 1.0
    banded = len(columns) == 3
    missed = (rows["reached"] == False).to_numpy(dtype=bool, na_value=False)  # noqa: E712
    for column in columns[:1] if banded else columns:
        values = scale * rows[column].to_numpy(dtype=float, na_value=float("nan"))
        values = abs(values) if column == "largest_miss_K" else values
        if rows[column].isna().all():
            continue
        dashes = "--" if column == columns[0] and len(columns) == 2 else "-"
        (line,) = ax.plot(at, values, color=color, marker=mark or None, ms=4, lw=2.2 if whole else 1.2, ls=dashes)
        handles[name] = line
        if missed.any():
            crosses = ax.scatter(
                at[missed], values[missed], s=45, color=color, marker="X", edgecolors="white", zorder=6
            )
            handles[MISSED] = crosses
    if banded and rows[columns[1]].notna().any():
        low, high = (scale * rows[column].to_numpy(dtype=float) for column in columns[1:])
        held = ax.fill_between(at, low, high, color=color, alpha=2 * BAND if whole else BAND, lw=0.0, zorder=1)
        handles[INTERVAL] = held


def _icon_styles(frame: pd.DataFrame) -> dict[str, tuple[str, str]]:
    """Colour and mark of every icon: blue where its larger change at the cold receptors is a cooling, else orange.

    The whole set is black, without a mark.
    """
    change = frame[frame["icon"] != ALL].groupby("icon", sort=False)["cold_receptor_peak_change_K"].median()
    cools = [name for name, value in change.items() if value < 0]
    warms = [name for name in change.index if name not in cools]
    styles = {}
    for place, name in enumerate(change.index):
        names, shades = (cools, COOLS) if name in cools else (warms, WARMS)
        styles[str(name)] = (shades[names.index(name) % len(shades)], MARKS[place % len(MARKS)])
    return styles | ({ALL: (INK, "")} if (frame["icon"] == ALL).any() else {})
