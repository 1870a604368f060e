"""What a figure shows, as one CSV table a panel: read from the drawing itself, so that it is exactly what is drawn."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..files.outputs import complete_or_absent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLORBAR = "<colorbar>"
LETTERS = "abcdefghijklmnopqrstuvwxyz"


def panels_of(figure: Figure) -> list[Axes]:
    """The panels of a figure in reading order, without its colour bars."""
    shown = [ax for ax in figure.axes if ax.get_label() != COLORBAR and ax.get_visible() and ax.axison]

    def place(ax: Axes) -> tuple[int, int]:
        spec = ax.get_subplotspec()
        return (0, 0) if spec is None else (spec.rowspan.start, spec.colspan.start)

    return sorted(shown, key=place)


def letter(place: int) -> str:
    """Letter of a panel: a to z, then aa, ab.

    >>> letter(0), letter(27)
    ('a', 'ab')
    """
    before = letter(place // len(LETTERS) - 1) if place >= len(LETTERS) else ""
    return before + LETTERS[place % len(LETTERS)]


def write_figure_data(figure: Figure, folder: Path, stem: str) -> list[str]:
    """Write ``STEM.csv``, of several panels ``STEM-a.csv`` and so on; return the names of the files."""
    panels = panels_of(figure)
    folder.mkdir(exist_ok=True)
    names = []
    for place, ax in enumerate(panels):
        name = f"{stem}.csv" if len(panels) == 1 else f"{stem}-{letter(place)}.csv"
        with complete_or_absent(folder / name) as draft:
            draft.write_text(panel_csv(ax), encoding="utf-8", newline="")
        names.append(name)
    return names


def panel_csv(ax: Axes) -> str:
    """One panel as CSV, a row for each point: series, kind, and the coordinates under the labels of the axes.

    >>> from matplotlib.figure import Figure
    >>> ax = Figure().add_subplot(xlabel="time (s)", ylabel="skin (°C)")
    >>> _ = ax.plot([0, 1], [32, 30.5], label="skin")
    >>> panel_csv(ax).splitlines()
    ['series,kind,time (s),skin (°C)', 'skin,line,0,32', 'skin,line,1,30.5']
    """
    held = io.StringIO()
    table = csv.writer(held, lineterminator="\n")
    across, up = _label(ax, "x"), _label(ax, "y")
    if (cells := heat_map(ax)) is not None:
        table.writerow(["row", "column", "value"])
        table.writerows(_cells(ax, cells))
        return held.getvalue()
    table.writerow(["series", "kind", across, up])
    for series, kind, points in _series(ax):
        table.writerows([series, kind, _text(x), _text(y)] for x, y in points)
    return held.getvalue()


def heat_map(ax: Axes) -> Any:
    """The values of the heat map in a panel, (rows, columns); None where there is none."""
    from matplotlib.collections import QuadMesh

    drawn: Any = next((mesh for mesh in ax.collections if isinstance(mesh, QuadMesh)), None)
    drawn = ax.images[0] if drawn is None and ax.images else drawn
    return None if drawn is None else np.ma.atleast_2d(np.ma.asarray(drawn.get_array()))


def _label(ax: Axes, name: str) -> str:
    """Label of an axis; of panels that share it, that of the outermost."""
    own = getattr(ax, f"get_{name}label")()
    shared: Any = getattr(ax, f"get_shared_{name}_axes")()
    others = [getattr(other, f"get_{name}label")() for other in shared.get_siblings(ax)]
    figure: Any = ax.figure
    whole = figure.get_supxlabel() if name == "x" else figure.get_supylabel()
    title = ax.get_title() if name == "y" else ""
    text = next((text for text in (own, *others, whole, title) if text), name)
    return " ".join(str(text).split())


def _cells(ax: Axes, values: Any) -> Iterator[list[str]]:
    rows, columns = _names(ax.yaxis, values.shape[0]), _names(ax.xaxis, values.shape[1])
    for row, line in zip(rows, values, strict=True):
        for column, value in zip(columns, line, strict=True):
            yield [row, column, _text(value)]


def _names(axis: Any, count: int) -> list[str]:
    places = axis.get_ticklocs()
    texts = axis.get_major_formatter().format_ticks(places)  # also of labels that are not shown
    ticks = {math.floor(float(tick) + 1e-9): text for tick, text in zip(places, texts, strict=True) if text}
    return [ticks.get(k, str(k)) for k in range(count)]


def _series(ax: Axes) -> Iterator[tuple[str, str, Iterable[Sequence[float]]]]:
    from matplotlib.collections import LineCollection, PathCollection, PolyCollection
    from matplotlib.patches import Polygon, Rectangle

    for line in ax.get_lines():
        points = np.column_stack([np.asarray(values, dtype=float) for values in line.get_data()])
        if len(points):
            yield _series_name(line), "line" if line.get_linestyle() not in ("None", "none") else "points", points
    for held in ax.collections:
        if isinstance(held, PathCollection):
            yield _series_name(held), "points", np.asarray(np.ma.filled(held.get_offsets(), np.nan), dtype=float)
        elif isinstance(held, LineCollection):
            for segment in held.get_segments():
                yield _series_name(held), "segment", segment
        elif isinstance(held, PolyCollection):
            for path in held.get_paths():
                yield _series_name(held), "area", np.asarray(path.vertices, dtype=float)
    for patch in ax.patches:
        if isinstance(patch, Rectangle):
            (x, y), wide, high = patch.get_xy(), patch.get_width(), patch.get_height()
            yield _series_name(patch), "bar", [(x, y), (x + wide, y + high)]
        elif isinstance(patch, Polygon):
            yield _series_name(patch), "area", np.asarray(patch.get_xy(), dtype=float)


def _series_name(artist: Any) -> str:
    label = str(artist.get_label()).strip()
    return "" if label.startswith("_") else " ".join(label.split())


def _text(value: Any) -> str:
    return "" if value is np.ma.masked or not np.isfinite(value) else f"{float(value):.9g}"
