"""The ranking as a picture: one line an icon, the best first, a bar for its per cent correct."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.circuit.solver.draw import COOL, WARM, new_axes

from .draw_heat import short

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..ranking.ranking import Ranking

LINE = 0.30
LETTER = 0.082
"""Inches of a line, and of a letter of a name."""
WORDS = ("most confused with", "plays")
HUES = {"cold": COOL, "warm": WARM}


def plot_ranking(ranking: Ranking, ax: Axes | None = None, words: bool = True) -> Axes:
    """Icons from the best to the worst: a bar of per cent correct, detection, onset, channel and strongest rival.

    Without words only the per cent stands beside the bars, as in a narrow column.
    """
    rows = ranking.rows()
    names = [short(row["icon"], 36) for row in rows]
    rivals = [short(_rival(ranking, row["icon"]), 42) for row in rows]
    wide = LETTER * (max(map(len, names)) + max(map(len, rivals)))
    axes = new_axes(ax, (max(6.0, 5.4 + wide) if words else 4.4, 0.95 + LINE * len(rows)))
    places = np.arange(len(rows))
    shares = [100.0 * row["proportion_correct"] for row in rows]
    colours = [HUES.get(row["channel"] or "", "#9a9a9a") for row in rows]
    axes.barh(places, shares, 0.62, color=colours)
    axes.set_xlim(0.0, 100.0)
    axes.set_ylim(len(rows) - 0.4, -1.2)
    axes.set_yticks(places, names)
    axes.tick_params(axis="y", length=0)
    axes.set_xticks([0, 25, 50, 75, 100])
    axes.set_xlabel("correct (%)")
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.grid(axis="x", alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)
    columns: list[tuple[str, list[str]]] = [
        ("correct", [f"{share:.0f} %" for share in shares]),
        ("detected", [f"{100 * row['detected_probability']:.0f} %" for row in rows]),
        ("onset", ["–" if row["onset_s"] is None else f"{row['onset_s']:.2f} s" for row in rows]),
        ("felt as", [row["channel"] or "–" for row in rows]),
        ("most confused with", rivals),
    ]
    if any(row["reason"] for row in rows):
        columns += [("plays", [_plays(row) for row in rows])]
    _columns(axes, columns if words else columns[:1])
    return axes


def _columns(axes: Axes, columns: list[tuple[str, list[str]]]) -> None:
    """Columns of text to the right of the bars, in points from their end, so that they keep their distance."""
    offset = 12.0
    for head, cells in columns:
        last = head in WORDS
        wide = 72.0 * LETTER * max(len(head), *map(len, cells)) + 10.0
        at, side = (offset, "left") if last else (offset + wide - 10.0, "right")
        for y, text in ((-0.75, head), *enumerate(cells)):
            axes.annotate(
                text,
                (1.0, y),
                xycoords=("axes fraction", "data"),
                xytext=(at, 0.0),
                textcoords="offset points",
                ha=side,
                va="center",
                fontsize=9,
                color="#555555" if y == -0.75 else "#1a1a1a",
                annotation_clip=False,
            )
        offset += wide


def _plays(row: dict[str, Any]) -> str:
    said = ["not safe"] * (not row["safe"]) + ["not reached"] * (not row["reachable"])
    return ", ".join(said) or "yes"


def _rival(ranking: Ranking, name: str) -> str:
    """The icon that this one is confused with most often, and how often: the mean of both directions."""
    pairs = [pair for pair in ranking.pairs if name in (pair.a, pair.b)]
    if not pairs:
        return "–"
    share, label = max((pair.confused_probability, pair.b if pair.a == name else pair.a) for pair in pairs)
    return f"{label} ({100 * share:.0f} %)"
