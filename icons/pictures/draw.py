"""Plots of icons: the prescribed level against time."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from html import escape
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

from thermicon.base.results.drawn import Drawn

from ..model.family import Family
from ..model.icon import Icon
from ..model.iconset import IconSet
from ..model.spatial import SpatialIcon

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..model.corners import Corners

Direction = Literal["cool", "warm", "stay"]
# Dark blue and light orange stay apart in grey and for all common kinds of colour vision.
COOL, WARM, STAY = "#2166ac", "#f1a340", "#4d4d4d"
COLOURS: dict[Direction, str] = {"stay": STAY, "cool": COOL, "warm": WARM}
MOST_DRAWN, MOST_NAMED = 24, 8
# Eight colours for icons by name, safe for common kinds of colour vision; dashes distinguish them in grey.
_HUES = ("#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f")
_DASHES: tuple[Literal["-"] | tuple[int, tuple[float, ...]], ...] = (
    "-",
    (0, (5, 2)),
    (0, (1, 1.2)),
    (0, (6, 1.5, 1, 1.5)),
)
_LONGEST_TITLE = 48


def plot(drawn: Drawn, ax: Axes | None = None) -> Axes:
    """Draw the level (°C, or A under control current) against time in s, and return the Axes.

    One icon is coloured by direction, its steps thinner than ramps. Of a family or a set up to 24 icons are drawn over
    one another; up to 8 have a colour and a dash each and a legend, more are coloured by direction. On several elements
    each element has a row. Without ``ax`` a new figure is made, outside of pyplot; nothing is shown or saved.
    """
    if isinstance(drawn, SpatialIcon):
        return _rows([(name, track) for name, track in drawn.tracks.items()], drawn.name, ax)
    if isinstance(drawn, IconSet) and drawn.spatial:
        tracks = [(f"{icon.name}: {name}", track) for icon in drawn.spatial for name, track in icon.tracks.items()]
        more = f" ({MOST_DRAWN} of {len(tracks)} rows drawn)" if len(tracks) > MOST_DRAWN else ""
        title = drawn.title or drawn.name or icon_count(len(drawn))
        return _rows(tracks[:MOST_DRAWN], _short(title) + more, ax)
    if isinstance(drawn, Icon):
        return _overlay([drawn], [], drawn.name, ax)
    if isinstance(drawn, Family):
        places = chosen(tuple(map(len, drawn.parameters)), MOST_DRAWN)
        members = [drawn[place] for place in places]
        units = {own.name: own.unit for own in drawn.parameters}
        named = ([part.partition("=") for part in member.name.split("_")[1:]] for member in members)
        labels = [", ".join(f"{name} = {value} {units[name]}".strip() for name, _, value in each) for each in named]
        labels = [label.replace("= -", "= −") for label in labels]
        more = f", {len(members)} drawn" if len(members) < len(drawn) else ""
        return _overlay(members, labels, f"{_short(drawn.name)}: {icon_count(len(drawn))}{more}", ax)
    if isinstance(drawn, IconSet):
        members = [drawn.icons[place] for place in evenly(len(drawn), MOST_DRAWN)]
        title = drawn.title or drawn.name or icon_count(len(drawn))
        more = f" ({len(members)} of {len(drawn):,} drawn)" if len(members) < len(drawn) else ""
        return _overlay(members, [icon.name for icon in members], _short(title) + more, ax)
    raise TypeError(f"a {type(drawn).__name__} has no picture; an Icon, a Family or an IconSet has")


def as_svg(axes: Axes) -> str:
    """The figure of some axes as SVG for a notebook or a page; texts stay texts, and equal figures give equal bytes."""
    import matplotlib

    held = io.StringIO()
    figure: Any = axes.figure
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "thermicon"}):
        figure.savefig(held, format="svg", metadata={"Date": None})
    label = escape(f"{axes.get_title()}: {axes.get_ylabel()}")
    return f'<svg role="img" aria-label="{label}"{held.getvalue().partition("<svg")[2]}'


def icon_count(count: int) -> str:
    """Return a number of icons for people.

    >>> icon_count(1), icon_count(1000)
    ('1 icon', '1,000 icons')
    """
    return f"{count:,} icon{'' if count == 1 else 's'}"


def directions(corners: Corners) -> list[Direction]:
    """Return, for every straight piece, whether it cools, warms or stays; under control current, more current cools."""
    down: Direction = "cool" if corners.quantity == "temperature_C" else "warm"
    up: Direction = "warm" if down == "cool" else "cool"
    return ["stay" if b == a else down if b < a else up for a, b in pairwise(corners.value)]


def evenly(count: int, most: int) -> list[int]:
    """Return at most ``most`` places out of ``count``, evenly apart, the first and the last among them."""
    if count <= most:
        return list(range(count))
    return sorted({round(n * (count - 1) / (most - 1)) for n in range(most)})


def chosen(sizes: Sequence[int], most: int) -> list[int]:
    """At most ``most`` places among all combinations of values: the corners, a family's extremes, then evenly apart."""
    count = math.prod(sizes)
    corners = {0, count - 1}
    if count > most >= 2 ** len(sizes):
        corners = {0}
        for size in sizes:
            corners = {place * size + end for place in corners for end in (0, size - 1)}
    places = evenly(count, most if count <= most else max(2, most - len(corners) + 2))
    return sorted({*corners, *places}) if count > 1 else [0]


def _overlay(icons: Sequence[Icon], labels: Sequence[str], title: str, ax: Axes | None) -> Axes:
    """Draw icons of one context over one another, by name where there are few; one without labels by direction."""
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    named = 0 < len(labels) <= MOST_NAMED
    own = ax is None
    if ax is None:
        size = (7.0, 3.4) if named else (6.0, 3.6) if labels else (5.0, 3.0)
        ax = Figure(figsize=size, layout="constrained").add_subplot()
    all_corners = [icon.corners() for icon in icons]
    for level in sorted({corners.value[0] for corners in all_corners}):
        ax.axhline(level, color="#999999", linestyle="--", linewidth=1, zorder=1)
    for place, corners in enumerate(all_corners):
        if named:  # later lines are thinner, so that those which they cover still show
            width = 3.4 - 2.0 * place / max(1, len(icons) - 1)
            (line,) = ax.plot(corners.time_s, corners.value, color=_HUES[place], linewidth=width, zorder=2 + place / 10)
            line.set_linestyle(_DASHES[place % len(_DASHES)])
            line.set_label(_short(labels[place], 32))
        else:
            width, alpha = (1.3, 0.75) if labels else (2.5, 1.0)
            pieces = list(pairwise(zip(corners.time_s, corners.value, strict=True)))
            widths = [width * (0.6 if n in corners.steps else 1.0) for n in range(len(pieces))]
            ways = [COLOURS[way] for way in directions(corners)]
            look: dict[str, Any] = {"colors": ways, "linewidths": widths, "capstyle": "round", "alpha": alpha}
            ax.add_collection(LineCollection(pieces, zorder=2, **look))
    control = icons[0].context.control
    low, high = min(corners.lowest for corners in all_corners), max(corners.highest for corners in all_corners)
    half = max(0.6 * (high - low), 0.1 if control == "current" else 1.0)
    longest = max(corners.duration_s for corners in all_corners)
    ax.set_xlim(-0.015 * longest, 1.015 * longest)  # room for steps at either end
    ax.set_ylim((low + high) / 2 - half, (low + high) / 2 + half)
    ax.set_title(_short(title), fontsize=11).set_parse_math(False)
    ax.set_xlabel("time (s)")
    ax.set_ylabel("current (A)" if control == "current" else f"{control} temperature (°C)")
    ax.spines[["top", "right"]].set_visible(False)
    if named:
        legend = ax.legend(frameon=not own, fontsize=8, handlelength=3.2)
        if own:  # beside the curves, where constrained layout keeps room for it
            legend.set_loc("center left")
            legend.set_bbox_to_anchor((1.01, 0.5))
        for text in legend.get_texts():
            text.set_parse_math(False)
    return ax


def _rows(tracks: Sequence[tuple[str, Icon]], title: str, ax: Axes | None) -> Axes:
    """Draw each track in a row of its own on one time axis, the first on top, coloured by direction."""
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    if ax is None:
        ax = Figure(figsize=(6.0, 1.2 + 0.6 * len(tracks)), layout="constrained").add_subplot()
    courses = [track.corners() for _, track in tracks]
    low = min(each.lowest - each.value[0] for each in courses)
    high = max(each.highest - each.value[0] for each in courses)
    height = 1.25 * max(high - low, 1.0)
    longest = max(each.duration_s for each in courses)
    rests = [-place * height for place in range(len(tracks))]
    for rest, course in zip(rests, courses, strict=True):
        points = list(zip(course.time_s, (value - course.value[0] + rest for value in course.value), strict=True))
        ways = [COLOURS[way] for way in directions(course)]
        ax.add_collection(LineCollection(list(pairwise(points)), colors=ways, linewidths=2.5, capstyle="round"))
        ax.axhline(rest, color="#999999", linestyle="--", linewidth=1, zorder=1)
    ax.set_xlim(-0.015 * longest, 1.015 * longest)
    ax.set_ylim(rests[-1] + low - 0.15 * height, high + 0.15 * height)
    ax.set_yticks(rests, [_short(name, 32) for name, _ in tracks])
    for text in ax.get_yticklabels():
        text.set_parse_math(False)
    ax.set_title(_short(title), fontsize=11).set_parse_math(False)
    ax.set_xlabel("time (s)")
    ax.set_ylabel(f"{tracks[0][1].context.control} temperature ({high - low:.3g} K from low to high)")
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def _short(text: str, most: int = _LONGEST_TITLE) -> str:
    plain = " ".join(text.split())
    return plain if len(plain) <= most else plain[: most - 1].rstrip() + "…"
