"""Plot icons with matplotlib: the prescribed level against time, coloured by direction, or one colour an icon."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

from ..drawn import Drawn
from ..model.family import Family
from ..model.icon import Icon
from ..model.iconset import IconSet
from .curve_style import COLOURS, chosen, directions, evenly

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..model.corners import Corners

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


@singledispatch
def plot(drawn: Drawn, ax: Axes | None = None) -> Axes:
    """Draw an icon, a family or a set by its type, and return the Axes."""
    raise TypeError(f"a {type(drawn).__name__} has no picture; an Icon, a Family or an IconSet has")


@plot.register(Icon)
def plot_icon(icon: Icon, ax: Axes | None = None) -> Axes:
    """Draw the level of an icon (°C, or A under control current) against time in s, and return the Axes.

    Without ``ax`` a new figure is made, outside of pyplot; nothing is shown or saved. Steps are thinner than ramps.

    >>> from thermicon.icons import load_library
    >>> plot_icon(load_library("six-icons")["cooling-step"]).get_title()
    'cooling-step'
    """
    from matplotlib.figure import Figure

    if ax is None:
        ax = Figure(figsize=(5, 3), layout="constrained").add_subplot()
    corners = icon.corners()
    _rest(ax, [corners])
    _directed(ax, corners, 2.5, 1.0)
    _finish(ax, [icon], [corners], icon.name)
    return ax


def plot_icons(icons: Sequence[Icon], ax: Axes | None = None) -> Axes:
    """Draw several icons over one another, and return the Axes.

    Up to 8 have a colour and a dash each and a legend with their names; more are coloured by direction. Raises
    ValueError without icons, and for currents and temperatures on one axis.

    >>> from thermicon.icons import load_library
    >>> plot_icons(load_library("six-icons").icons).get_ylabel()
    'display temperature (°C)'
    """
    return _overlay(icons, [icon.name for icon in icons], f"{len(icons)} icons", ax)


@plot.register(Family)
def plot_family(family: Family, ax: Axes | None = None) -> Axes:
    """Draw up to 24 members of a family, its corners among them, over one another, and return the Axes."""
    places = chosen(tuple(map(len, family.parameters)), MOST_DRAWN)
    members = [family[place] for place in places]
    labels = [member.name.partition("_")[2].replace("_", ", ").replace("=", " = ") for member in members]
    for own in family.parameters:
        labels = [_with_unit(label, own.name, own.unit) for label in labels]
    title = f"{_short(family.name)}: {len(family):,} icon{'' if len(family) == 1 else 's'}"
    drawn = f", {len(members)} drawn" if len(members) < len(family) else ""
    return _overlay(members, labels, title + drawn, ax)


@plot.register(IconSet)
def plot_set(icons: IconSet, ax: Axes | None = None) -> Axes:
    """Draw up to 24 icons of a set, evenly chosen, over one another, and return the Axes."""
    members = [icons.icons[place] for place in evenly(len(icons), MOST_DRAWN)]
    title = icons.title or icons.name or f"{len(icons):,} icon{'' if len(icons) == 1 else 's'}"
    drawn = f" ({len(members)} of {len(icons):,} drawn)" if len(members) < len(icons) else ""
    return _overlay(members, [icon.name for icon in members], _short(title) + drawn, ax)


def _overlay(icons: Sequence[Icon], labels: Sequence[str], title: str, ax: Axes | None) -> Axes:
    from matplotlib.figure import Figure

    if not icons:
        raise ValueError("there are no icons to draw")
    if len({icon.context.control == "current" for icon in icons}) > 1:
        raise ValueError("icons under control current are in A, the others in °C: draw them on separate axes")
    named = len(icons) <= MOST_NAMED
    own = ax is None
    if ax is None:
        ax = Figure(figsize=(7, 3.4) if named else (6, 3.6), layout="constrained").add_subplot()
    all_corners = [icon.corners() for icon in icons]
    _rest(ax, all_corners)
    for place, (corners, label) in enumerate(zip(all_corners, labels, strict=True)):
        if named:  # later lines are thinner, so that those which they cover still show
            width = 3.4 - 2.0 * place / max(1, len(icons) - 1)
            (line,) = ax.plot(corners.time_s, corners.value, color=_HUES[place], linewidth=width, zorder=2 + place / 10)
            line.set_linestyle(_DASHES[place % len(_DASHES)])
            line.set_label(_short(label, 32))
        else:
            _directed(ax, corners, 1.3, 0.75)
    _finish(ax, icons, all_corners, title)
    if named:
        legend = ax.legend(frameon=not own, fontsize=8, handlelength=3.2)
        if own:  # beside the curves, where constrained layout keeps room for it
            legend.set_loc("center left")
            legend.set_bbox_to_anchor((1.01, 0.5))
        for text in legend.get_texts():
            text.set_parse_math(False)
    return ax


def _directed(ax: Axes, corners: Corners, width: float, alpha: float) -> None:
    """Add the pieces of a curve, each in the colour of its direction."""
    from matplotlib.collections import LineCollection

    pieces = list(pairwise(zip(corners.time_s, corners.value, strict=True)))
    steps = set(corners.steps)
    widths = [width * (0.6 if n in steps else 1.0) for n in range(len(pieces))]
    colours = [COLOURS[way] for way in directions(corners)]
    ax.add_collection(
        LineCollection(pieces, colors=colours, linewidths=widths, capstyle="round", alpha=alpha, zorder=2)
    )


def _rest(ax: Axes, all_corners: Sequence[Corners]) -> None:
    for level in sorted({corners.value[0] for corners in all_corners}):
        ax.axhline(level, color="#999999", linestyle="--", linewidth=1, zorder=1)


def _finish(ax: Axes, icons: Sequence[Icon], all_corners: Sequence[Corners], title: str) -> None:
    low, high = min(corners.lowest for corners in all_corners), max(corners.highest for corners in all_corners)
    controls = {icon.context.control for icon in icons}
    half = max(0.6 * (high - low), 0.1 if controls == {"current"} else 1.0)
    longest = max(corners.duration_s for corners in all_corners)
    ax.set_xlim(-0.015 * longest, 1.015 * longest)  # room for steps at either end
    ax.set_ylim((low + high) / 2 - half, (low + high) / 2 + half)
    ax.set_title(_short(title), fontsize=11).set_parse_math(False)
    ax.set_xlabel("time (s)")
    what = f"{controls.pop()} " if len(controls) == 1 else ""
    ax.set_ylabel("current (A)" if what == "current " else f"{what}temperature (°C)")
    ax.spines[["top", "right"]].set_visible(False)


def _with_unit(label: str, name: str, unit: str) -> str:
    """Return a label such as ``rate = 1, size = 3`` with the unit behind the value of one parameter."""
    parts = label.split(", ")
    parts = [f"{part} {unit}".strip() if part.startswith(f"{name} = ") else part for part in parts]
    return ", ".join(parts).replace("= -", "= −")


def _short(text: str, most: int = _LONGEST_TITLE) -> str:
    plain = " ".join(text.split())
    return plain if len(plain) <= most else plain[: most - 1].rstrip() + "…"
