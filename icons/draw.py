"""Draw icons: the prescribed level against time, coloured by direction; the same picture for plots and notebooks."""

import re
from collections.abc import Sequence
from io import StringIO
from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from thermicon.icons.family import Family
    from thermicon.icons.icon import Icon

# Dark blue and light orange stay apart in grey and for all common kinds of colour vision.
COOL, WARM, STAY = "#2166ac", "#f1a340", "#4d4d4d"
_MOST_PICTURES = 12


def plot_icon(icon: "Icon", ax: "Axes | None" = None) -> "Axes":
    """Draw the level of an icon (°C, or A under control current) against time in s, and return the Axes.

    Without ``ax`` a new figure is made, outside of pyplot; nothing is shown or saved.

    >>> from thermicon.icons import load_library
    >>> plot_icon(load_library("six-icons")["cooling-step"]).get_title()
    'cooling-step'
    """
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    if ax is None:
        ax = Figure(figsize=(5, 3), layout="constrained").add_subplot()
    corners = icon.lower()
    points = list(zip(corners.time_s, corners.value, strict=True))
    pieces = list(pairwise(points))
    down, up = (COOL, WARM) if corners.quantity == "temperature_C" else (WARM, COOL)  # more current cools
    colours = [STAY if b[1] == a[1] else down if b[1] < a[1] else up for a, b in pieces]
    ax.axhline(corners.value[0], color="#999999", linestyle="--", linewidth=1, zorder=1)
    ax.add_collection(LineCollection(pieces, colors=colours, linewidths=2.5, capstyle="round", zorder=2))
    middle = (corners.lowest + corners.highest) / 2
    half = max(0.6 * (corners.highest - corners.lowest), 1.0 if corners.quantity == "temperature_C" else 0.1)
    ax.set_xlim(0, corners.duration_s)
    ax.set_ylim(middle - half, middle + half)
    ax.set_title(icon.name)
    ax.set_xlabel("time (s)")
    ax.set_ylabel(_label(icon))
    return ax


def svg(icons: "Sequence[Icon | Family]") -> str:
    """Return icons as one small inline SVG; of more than 12, the first 12."""
    from matplotlib.figure import Figure

    shown = list(icons)[:_MOST_PICTURES]
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    figure = Figure(figsize=(3.2 * columns, 2.2 * rows), layout="constrained")
    for place, icon in enumerate(shown):
        icon.plot(figure.add_subplot(rows, columns, place + 1))
    out = StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None})
    more = f"<p>and {len(icons) - len(shown)} more</p>" if len(icons) > len(shown) else ""
    return re.sub(r"^.*?(?=<svg)", "", out.getvalue(), flags=re.DOTALL) + more


def plot_family(family: "Family", ax: "Axes | None" = None) -> "Axes":
    """Draw up to 24 members of a family, evenly chosen, over one another, and return the Axes."""
    step = max(1, len(family) // 24)
    axes = plot_icons([family[place] for place in range(0, len(family), step)][:24], ax)
    axes.set_title(f"{family.name}: {len(family):,} icons")
    return axes


def plot_icons(icons: "Sequence[Icon]", ax: "Axes | None" = None) -> "Axes":
    """Draw several icons over one another, and return the Axes."""
    for icon in icons:
        ax = plot_icon(icon, ax)
    assert ax is not None
    return ax


def _label(icon: "Icon") -> str:
    if icon.frame.control == "current":
        return "current (A)"
    return f"{'display' if icon.frame.control == 'display' else 'skin'} temperature (°C)"
