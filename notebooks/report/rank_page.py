"""``rank --report``: one ranking as a single page."""

from __future__ import annotations

import platform
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from thermicon.base.words.number_text import number, percent
from thermicon.icons import SpatialIcon

from ..figures.print_figure import small_png
from .blocks import Block, Bullets, Cell, Code, Facts, Heading, Picture, Text, as_html, grid
from .rank_report import rank_report

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from thermicon.icons import Icon, IconSet
    from thermicon.perception import Ranking

    from .set_report import SetReport

MOST_OVERVIEWS = 24
OVERVIEWS, MAPS = 75, 120
"""Dots an inch of overviews, and of the maps of the set."""
OVERVIEW_PIXELS = 700
MOST_PAIRS = 60
LIMITS = (
    "Everything here follows from a model of the skin and of its receptors, calibrated on published thresholds. No "
    "experiment has confirmed it for these icons.",
    "The order of icons is less certain than the overall level: for the six icons of the only published experiment "
    "that it can be checked against, the model does not find the order.",
    "Predicted onsets are later than the usually quoted windows, those of warmth most.",
    "The skin is a stack of flat layers: no edges, no lateral heat flow, one patch at a time. Pain, adaptation over "
    "minutes, training, attention and several simultaneous elements are outside the model.",
    "Intervals over people cover differences between people, not errors of the model. The model uncertainty, where it "
    "is given, covers what the data leave open, for this structure of the model.",
)
ONE_ELEMENT = "several simultaneous elements", "what elements do to one another"
"""Words of the limits on one element, and in their place on several, apart."""
SAFETY = (
    "Icons were checked against temperature limits for skin and display that are this project's own and stricter than "
    "published ones (ISO 13732, IEC 60601-1). This is a calculation, not a medical or ethical clearance. Hardware that "
    "touches people needs its own temperature cut-off that works without any software."
)


def report(
    made: SetReport,
    icons: IconSet,
    command: str = "",
    cures: Mapping[str, str] | None = None,
) -> str:
    """Write the page as HTML text: the same bytes for the same arguments.

    ``icons`` are those that were ranked, ``command`` reproduces the ranking, ``cures`` explain by name how
    an icon could be reached. No date is printed.
    """
    ranking = made.ranking
    title, count = icons.title or "Thermal icons", len(ranking.icons)
    lead = f"Predicted ranking of {'1 icon' if count == 1 else f'{count} icons'} by thermicon"
    parts = [
        Heading(title, 1),
        Text(f"{lead}: a model's, not measured", "lead"),
        *(Text(f"warning: {line}", "warn") for line in made.warnings),
        *rank_report(made, "", cures, details=True),
        *_settings(ranking, command),
        *view_parts(ranking),
        *_pairs(ranking),
        *icon_parts(ranking),
        Heading("Rig file"),
        Text("The whole rig as it was used, changes included."),
        Code(ranking.job.layout.toml),
        Heading("Limits of the prediction"),
        Bullets(tuple(line.replace(*ONE_ELEMENT) if ranking.elements else line for line in LIMITS)),
        Heading("Safety"),
        Text(SAFETY),
    ]
    return as_html(parts, f"{title}: predicted ranking")


def _settings(ranking: Ranking, command: str) -> Iterator[Block]:
    elsewhere = ranking.new_laboratory
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    rows = [
        ("command", command),
        *(
            (
                " ".join(filter(None, ("rig", each.name))),
                f"{each.rig.name}: {each.rig.site}, {each.rig.contact.area_m2 * 1e4:g} cm²",
            )
            for each in ranking.job.layout.elements
        ),
        ("people", f"{ranking.people} virtual, seed {ranking.seed}"),
        ("draws of the posterior", str(elsewhere.draws) if elsewhere else ""),
        ("made with", f"thermicon {ranking.version}, Python {platform.python_version()}, {versions}"),
        ("content hash", ranking.content_hash),
    ]
    yield Heading("Settings")
    yield Facts(tuple(row for row in rows if row[1]))
    yield Text("The hash covers the icons' text, the rig and the observer's parameters: equal hashes mean equal input.")


def _pairs(ranking: Ranking) -> Iterator[Block]:
    if not ranking.pairs:
        return
    yield Heading("Pairs, the most confused first")
    rows = sorted(ranking.pairs, key=lambda pair: (-pair.confused_probability, pair.a, pair.b))
    names = [part.name for part in rows[0].parts]
    cells: list[list[str | Cell]] = [
        [
            *(pair.a, pair.b, Cell(f"{pair.d_prime:.1f}", "strong")),
            f"{100 * pair.confused_probability:.1f} %",
            *(Cell(f"{part.value:.{1 + (part.value < 10)}f} d′", "strong" * part.above) for part in pair.parts),
        ]
        for pair in rows[:MOST_PAIRS]
    ]
    yield grid(("icon", "and", "d′", "confused", *names), cells, ("d′", "confused", *names))
    more = f" {len(rows) - MOST_PAIRS} more pairs are in the JSON." if len(rows) > MOST_PAIRS else ""
    yield Text(f"Components in bold are above the just noticeable difference of icons played back to back.{more}")


def view_parts(ranking: Ranking) -> Iterator[Block]:
    """Yield heat maps, perceptual map and the worst pair's ROC; nothing for one icon."""
    if len(ranking.icons) < 2:
        return
    from thermicon.perception.identification.map import map_of
    from thermicon.perception.plots.draw_heat import plot_confusion, plot_distance
    from thermicon.perception.plots.draw_map import plot_map
    from thermicon.perception.plots.plot import plot_roc

    yield Heading("Pictures of the set")
    confused = (
        "Rows: the icon presented. Columns: the response. The diagonal is named correctly. Similar icons are adjacent."
    )
    yield _drawn(plot_confusion(ranking), "answers to each icon, per cent", confused)
    yield _drawn(plot_distance(ranking), "d′ of every pair", "Median over people of the d′ between two icons.")
    found = map_of(ranking)
    bent = (
        f"Distances in the plane approach d′ (stress {found.stress:.2f}; 0: exact). Only distances matter; directions "
        "have no meaning."
    )
    if found.covariance is not None:
        bent += f" Each ellipse holds half of {found.people} people, whose maps were rotated and shifted onto this one."
    yield _drawn(plot_map(found), "the icons as points of a plane", bent)
    if (worst := ranking.worst) is not None:
        roc = "Hits against false alarms for the pair that is confused most often, whatever the criterion."
        yield _drawn(plot_roc(worst), "receiver operating characteristic of the worst pair", roc)


def _drawn(axes: Axes, said: str, caption: str) -> Picture:
    figure: Any = axes.figure
    return Picture(caption, said, round(96 * figure.get_figwidth()), small_png(figure, MAPS))


def icon_parts(ranking: Ranking) -> Iterator[Block]:
    """Yield every icon: what it scores, its cue text, and an overview of its run, or a row for each element."""
    from thermicon.circuit import simulate

    from ..figures.layout_figure import layout_figure
    from ..figures.overview import FELT_TAIL_S, felt, overview

    members: tuple[Icon | SpatialIcon, ...] = ranking.job.members
    layout = ranking.job.layout
    yield Heading("Icons")
    if len(members) > MOST_OVERVIEWS:
        yield Text(f"Overviews of the first {MOST_OVERVIEWS} icons; simulate FILE --figure OUT draws all of them.")
    for place, (icon, score) in enumerate(zip(members, ranking.icons, strict=True)):
        yield Heading(icon.name, 3)
        facts = [
            f"{percent(score.felt_and_named)} felt and named",
            f"reported in {percent(score.detected_probability)} of the trials of all people",
        ]
        cold, warm = (f"{number(peak, 2)} K at the" for peak in score.peak_change_K)
        yield Text("; ".join([*facts, f"largest change {cold} cold receptor, {warm} warm receptor"]) + ".", "lead")
        text = str(icon)  # without the head of its file
        yield Code(text[text.find("\nicon ") + 1 :].rstrip("\n"))
        if place < MOST_OVERVIEWS:
            if isinstance(icon, SpatialIcon):
                figure = layout_figure(simulate(icon, layout, tail_s=FELT_TAIL_S))
            else:
                figure = overview(*felt(simulate(icon, layout, tail_s=FELT_TAIL_S)), layout.alone.changes)
            data = small_png(figure, OVERVIEWS)
            alt = f"temperatures, heat flow, current and sensation of {icon.name}"
            yield Picture("", alt, OVERVIEW_PIXELS, data)
