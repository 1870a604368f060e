"""The pictures of a report: those of the set, and every icon with its text, its course and its overview."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..text.number_text import number, percent
from .report_page import element, picture, png_of, svg_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet
    from thermicon.perception import Ranking

MOST_OVERVIEWS = 24
FEW, LARGE, SMALL = 12, 84, 66
"""Dots an inch of overviews: large for few icons."""
OVERVIEW_PIXELS = 700
VECTOR_ICONS = 8
"""Pictures of more icons are pixels, which take less room, and stand below one another."""


def view_parts(ranking: Ranking) -> Iterator[str]:
    """Yield heat maps, perceptual map and places; nothing for one icon or by rules."""
    if ranking.by == "rules" or len(ranking.icons) < 2:
        return
    from thermicon.perception.identification.map import map_of
    from thermicon.perception.plots.draw import plot_confusion, plot_distance, plot_map, plot_places

    vector = len(ranking.icons) <= VECTOR_ICONS
    yield element("h2", "Pictures of the set")
    confused = "Rows: icon presented. Columns: name answered. The diagonal is correct. Similar icons are adjacent."
    maps = (
        _drawn(plot_confusion(ranking), "answers to each icon, per cent", confused, vector),
        _drawn(
            plot_distance(ranking),
            "d′ of every pair",
            "Median over people of the d′ by which two icons differ.",
            vector,
        ),
    )
    yield f'<div class="pair">{"".join(maps)}</div>' if vector else "".join(maps)
    found = map_of(ranking)
    bent = (
        f"Distances in the plane are as near to d′ as a plane allows (stress {found.stress:.2f}; 0: exactly). Only "
        "distances count: directions have no meaning."
    )
    if found.covariance is not None:
        bent += (
            f" An ellipse holds half of {found.people} people, whose own maps were turned and shifted onto this one."
        )
    yield _drawn(plot_map(found), "the icons as points of a plane", bent, vector)
    if ranking.spread is not None and ranking.people > 1:
        places = "Each person ranks the icons by how often each is named correctly; equal ones share their places."
        yield _drawn(plot_places(ranking), "probability of each place for each icon", places, vector)


def _drawn(axes: Axes, said: str, caption: str, vector: bool) -> str:
    figure: Any = axes.figure
    width = round(96 * figure.get_figwidth())
    if not vector:
        return picture(png_of(figure, 120), "png", said, caption, width)
    return picture(svg_of(figure), "svg+xml", said, caption, width)


def icon_parts(result: dict[str, Any], icons: IconSet, rig: Rig) -> Iterator[str]:
    """Yield every icon: what it scores, its cue text, its course and an overview of its run."""
    from thermicon.icons.pictures.picture import picture as drawn

    members = list(icons)
    yield element("h2", "Icons")
    if len(members) > MOST_OVERVIEWS:
        yield element("p", f"Overviews of the first {MOST_OVERVIEWS} icons; --figure DIR writes those of all.")
    for place, (icon, score) in enumerate(zip(members, result["icons"], strict=True)):
        yield element("h3", icon.name)
        facts = [
            f"{percent(score['proportion_correct'])} correct",
            f"detected by {percent(score['detected_probability'])}",
        ]
        peaks = (f"{number(k, 2)} K at the {name.replace('_', ' ')}" for name, k in score["peak_change_K"].items())
        said = [*(facts if result["by"] == "model" else []), "largest change " + ", ".join(peaks)]
        yield element("p", "; ".join(said) + ".", "lead")
        small = drawn(icon).encode("utf-8")
        yield '<div class="pair">' + element("pre", cue_text(icon))
        yield picture(small, "svg+xml", f"prescribed course of {icon.name}", "", 320) + "</div>"
        if place < MOST_OVERVIEWS:
            yield _overview(icon, rig, len(members))


def cue_text(icon: Icon) -> str:
    """The statement of one icon in canonical form, without the head of its file."""
    text = str(icon)
    return text[text.find("\nicon ") + 1 :].rstrip("\n")


def _overview(icon: Icon, rig: Rig, count: int) -> str:
    from thermicon.circuit import simulate
    from thermicon.perception import perceive

    from ..figures.overview import overview
    from ..figures.trace_overview import FELT_TAIL_S, on_one_clock

    trace = on_one_clock(simulate(icon, rig, tail_s=FELT_TAIL_S))
    data = png_of(overview(trace, perceive(trace), rig.changes), LARGE if count <= FEW else SMALL)
    return picture(data, "png", f"temperatures, heat flow, current and sensation of {icon.name}", "", OVERVIEW_PIXELS)
