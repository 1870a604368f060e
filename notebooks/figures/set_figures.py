"""Figures of a set: distances and confusions side by side, and all those of ``rank --figure``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files.outputs import FIGURE_SUFFIXES
from ..messages import note
from .print_figure import MM_PER_INCH, write_figure
from .style import SCREEN, Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Ranking

FLAT = 0.75
"""Height of a cell to its width, where two heat maps stand below one another."""
MAP_HEIGHT = 0.85
"""Height of a narrow map to its width."""


def set_figure(ranking: Ranking, stacked: bool = False) -> Figure:
    """Draw distances (d′) and predicted confusions of one set side by side; stacked in a narrow column, as asked."""
    from matplotlib.figure import Figure

    from thermicon.perception.plots import draw_heat

    longest = max(map(len, map(draw_heat.short, ranking.labels)))
    side = max(4.2, 1.2 + 0.07 * longest + 0.45 * len(ranking.labels))
    down, across = (2, 1) if stacked else (1, 2)
    names = 0.06 * longest if stacked else 0.0  # of the upper one, which stand below the lower one
    high = down * (FLAT if stacked else 1.0) * side - names
    figure = Figure(figsize=(across * (side + 0.6), high), layout="constrained")
    distance, confusion = figure.subplots(down, across)
    draw_heat.plot_distance(ranking, ax=distance)
    draw_heat.plot_confusion(ranking, ax=confusion)
    if stacked:
        distance.set_xlabel("")
        distance.tick_params(labelbottom=False)
        for ax in (distance, confusion):
            ax.set_aspect(FLAT)
    return figure


def _one_figure(ranking: Ranking, file: Path, look: Look) -> None:
    """Distances and confusions beside each other; by rules the ranking."""
    if ranking.by == "rules":
        from thermicon.perception.plots.draw_table import plot_ranking

        drawn: Any = plot_ranking(ranking, words=not look.narrow).figure
    else:
        drawn = set_figure(ranking, stacked=look.narrow)
    write_figure(drawn, file, look)
    note(f"wrote {file}")


def write_figures(ranking: Ranking, icons: IconSet, rig: Rig, place: Path, look: Look = SCREEN) -> None:
    """Write all figures of the set and an overview of each icon into a folder, or one figure of the set into a file.

    A folder is made if it is missing. The set has ranking, distance, confusion, map and places; the last two need two
    icons, places two people.
    """
    from thermicon.circuit import simulate

    from .overview import FELT_TAIL_S, draw_overview

    if place.suffix.lower() in FIGURE_SUFFIXES and not place.is_dir():
        _one_figure(ranking, place, look)
        return
    folder, kind = place, "png" if look.width_mm is None else "pdf"
    folder.mkdir(exist_ok=True)
    drawn = set_axes(ranking, words=not look.narrow, width_mm=look.width_mm if look.narrow else None)
    for name, axes in drawn.items():
        figure: Any = axes.figure
        write_figure(figure, folder / f"{name}.{kind}", look)
    for icon in icons:
        trace, picture = simulate(icon, rig, tail_s=FELT_TAIL_S), folder / f"overview-{icon.name}.{kind}"
        draw_overview(trace, picture, rig.changes, look=look)
    count = "1 overview" if len(icons) == 1 else f"{len(icons)} overviews"
    note(f"wrote {', '.join(f'{name}.{kind}' for name in drawn)} and {count} into {folder}")


def set_axes(ranking: Ranking, words: bool = True, width_mm: float | None = None) -> dict[str, Axes]:
    """The pictures of a ranking by the names of their files, each on a figure of its own.

    By rules there is only the ranking: the others show the model's numbers. Without words the ranking has no columns of
    text. The map, whose names find their places in its own size, is drawn in a width where one is given.
    """
    from matplotlib.figure import Figure

    from thermicon.perception.identification.map import map_of
    from thermicon.perception.plots.draw_heat import plot_confusion, plot_distance, plot_places
    from thermicon.perception.plots.draw_map import plot_map
    from thermicon.perception.plots.draw_table import plot_ranking

    made = {"ranking": plot_ranking(ranking, words=words)}
    if ranking.by == "rules":
        return made
    made |= {"distance": plot_distance(ranking), "confusion": plot_confusion(ranking)}
    if len(ranking.icons) > 1:
        size = None if width_mm is None else (width_mm / MM_PER_INCH, MAP_HEIGHT * width_mm / MM_PER_INCH)
        made["map"] = plot_map(
            map_of(ranking), None if size is None else Figure(figsize=size, layout="constrained").add_subplot()
        )
        if ranking.people > 1 and ranking.spread is not None:
            made["places"] = plot_places(ranking)
    return made
