"""The figures of ``rank --figure``: those of the whole set, and an overview for every icon."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files.outputs import complete_or_absent
from ..text.messages import note

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Ranking

DPI = 130


def write_figures(ranking: Ranking, icons: IconSet, rig: Rig, folder: Path) -> None:
    """Write the pictures of the set as PNG and an overview for every icon into ``folder``, which is made if missing.

    The set has ranking, distance, confusion, map and places; the last two need two icons, places two people.
    """
    from thermicon.circuit import simulate

    from .trace_overview import FELT_TAIL_S, draw_overview

    folder.mkdir(exist_ok=True)
    drawn = set_axes(ranking)
    for name, axes in drawn.items():
        figure: Any = axes.figure
        with complete_or_absent(folder / f"{name}.png") as draft:
            figure.savefig(draft, dpi=DPI)
    names = [icon.name for icon in icons]
    stems = distinct(names)
    for icon, stem in zip(icons, stems, strict=True):
        if stem != icon.name:
            note(
                f"warning: the overview of {icon.name} is overview-{stem}.png, since some disks take {icon.name} and "
                f"{names[[name.casefold() for name in names].index(icon.name.casefold())]} for the same name"
            )
        draw_overview(simulate(icon, rig, tail_s=FELT_TAIL_S), folder / f"overview-{stem}.png", rig.changes)
    count = "1 overview" if len(icons) == 1 else f"{len(icons)} overviews"
    note(f"wrote {', '.join(f'{name}.png' for name in drawn)} and {count} into {folder}")


def distinct(names: Sequence[str]) -> list[str]:
    """Return names for files that differ in more than capitals: the later of two alike gets a number.

    >>> distinct(["dip", "Dip", "dip-2"])
    ['dip', 'Dip-3', 'dip-2']
    """
    own, taken = {name.casefold() for name in names}, set[str]()
    found = []
    for name in names:
        stem, k = name, 1
        while stem.casefold() in taken or (k > 1 and stem.casefold() in own):
            k += 1
            stem = f"{name}-{k}"
        taken.add(stem.casefold())
        found.append(stem)
    return found


def set_axes(ranking: Ranking) -> dict[str, Axes]:
    """The pictures of a ranking by the names of their files, each on a figure of its own.

    By rules there is only the ranking: the others show the model's numbers.
    """
    from thermicon.perception.identification.map import map_of
    from thermicon.perception.plots.draw import plot_confusion, plot_distance, plot_map, plot_places, plot_ranking

    made = {"ranking": plot_ranking(ranking)}
    if ranking.by == "rules":
        return made
    made |= {"distance": plot_distance(ranking), "confusion": plot_confusion(ranking)}
    if len(ranking.icons) > 1:
        made["map"] = plot_map(map_of(ranking))
        if ranking.people > 1 and ranking.spread is not None:
            made["places"] = plot_places(ranking)
    return made
