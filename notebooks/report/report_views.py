"""The pictures of a report: those of the set, and every icon with its text, its course and its overview."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import number, percent

from .blocks import Block, Code, Heading, Picture, Row, Text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet
    from thermicon.perception import Ranking

MOST_OVERVIEWS = 24
FEW, LARGE, SMALL = 12, 84, 66
"""Dots an inch of overviews: large for few icons."""
OVERVIEW_PIXELS = 700
SALT = "thermicon"
VECTOR_ICONS = 8
"""Pictures of more icons are pixels, which take less room, and stand below one another."""


def view_parts(ranking: Ranking) -> Iterator[Block]:
    """Yield heat maps, perceptual map and places; nothing for one icon or by rules."""
    if ranking.by == "rules" or len(ranking.icons) < 2:
        return
    from thermicon.perception.identification.map import map_of
    from thermicon.perception.plots.draw_heat import plot_confusion, plot_distance, plot_places
    from thermicon.perception.plots.draw_map import plot_map

    vector = len(ranking.icons) <= VECTOR_ICONS
    yield Heading("Pictures of the set")
    confused = "Rows: the icon presented. Columns: the response. The diagonal is correct. Similar icons are adjacent."
    maps = (
        _drawn(plot_confusion(ranking), "answers to each icon, per cent", confused, vector),
        _drawn(
            plot_distance(ranking),
            "d′ of every pair",
            "Median over people of the d′ between two icons.",
            vector,
        ),
    )
    yield from (Row(maps),) if vector else maps
    found = map_of(ranking)
    bent = (
        f"Distances in the plane approach d′ (stress {found.stress:.2f}; 0: exact). Only distances matter; directions "
        "have no meaning."
    )
    if found.covariance is not None:
        bent += f" Each ellipse holds half of {found.people} people, whose maps were rotated and shifted onto this one."
    yield _drawn(plot_map(found), "the icons as points of a plane", bent, vector)
    if ranking.spread is not None and ranking.people > 1:
        places = "Each person ranks the icons by how often they are named correctly; ties share their ranks."
        yield _drawn(plot_places(ranking), "probability of each place for each icon", places, vector)


def _drawn(axes: Axes, said: str, caption: str, vector: bool) -> Picture:
    figure: Any = axes.figure
    width = round(96 * figure.get_figwidth())
    if not vector:
        return Picture(caption, said, "png", width, png_of(figure, 120))
    return Picture(caption, said, "svg+xml", width, svg_of(figure))


def icon_parts(result: dict[str, Any], icons: IconSet, rig: Rig) -> Iterator[Block]:
    """Yield every icon: what it scores, its cue text, its course and an overview of its run."""
    from thermicon.icons.pictures.picture import picture as drawn

    members = list(icons)
    yield Heading("Icons")
    if len(members) > MOST_OVERVIEWS:
        yield Text(f"Overviews of the first {MOST_OVERVIEWS} icons; --figure DIR writes all of them.")
    for place, (icon, score) in enumerate(zip(members, result["icons"], strict=True)):
        yield Heading(icon.name, 3)
        facts = [
            f"{percent(score['proportion_correct'])} correct",
            f"reported in {percent(score['detected_probability'])} of the trials of all people",
        ]
        peaks = (f"{number(k, 2)} K at the {name.replace('_', ' ')}" for name, k in score["peak_change_K"].items())
        said = [*(facts if result["by"] == "model" else []), "largest change " + ", ".join(peaks)]
        yield Text("; ".join(said) + ".", "lead")
        small = drawn(icon).encode("utf-8")
        course = Picture("", f"prescribed course of {icon.name}", "svg+xml", 320, small)
        yield Row((Code(cue_text(icon)), course))
        if place < MOST_OVERVIEWS:
            yield _overview(icon, rig, len(members))


def cue_text(icon: Icon) -> str:
    """The statement of one icon in canonical form, without the head of its file."""
    text = str(icon)
    return text[text.find("\nicon ") + 1 :].rstrip("\n")


def _overview(icon: Icon, rig: Rig, count: int) -> Picture:
    from thermicon.circuit import simulate
    from thermicon.perception import perceive

    from ..figures.overview import FELT_TAIL_S, evenly_timed, overview

    trace = evenly_timed(simulate(icon, rig, tail_s=FELT_TAIL_S))
    data = png_of(overview(trace, perceive(trace), rig.changes), LARGE if count <= FEW else SMALL)
    alt = f"temperatures, heat flow, current and sensation of {icon.name}"
    return Picture("", alt, "png", OVERVIEW_PIXELS, data)


def svg_of(figure: Figure) -> bytes:
    """A figure as SVG, the same bytes every time: no date, and names drawn from a fixed salt."""
    import matplotlib

    held = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": SALT, "svg.fonttype": "path"}):
        figure.savefig(held, format="svg", metadata={"Date": None})
    return held.getvalue()


def png_of(figure: Figure, dpi: float, colours: int = 64) -> bytes:
    """A figure as a small PNG of few colours."""
    from PIL import Image

    held, small = io.BytesIO(), io.BytesIO()
    figure.savefig(held, format="png", dpi=dpi)
    held.seek(0)
    with Image.open(held) as image:
        image.convert("RGB").quantize(colours, dither=Image.Dither.NONE).save(small, format="png", optimize=True)
    return small.getvalue()
