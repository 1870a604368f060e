"""What ``improve --up-to`` says: how many icons of a pool are distinguishable, at which per cent correct and time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from thermicon.icons.number_text import count_of, number, percent

from ..report.choices import goal_lines
from ..report.tables import show, table

if TYPE_CHECKING:
    from thermicon.perception.selection.frontier import Frontier, FrontierPoint


def show_frontier(found: Frontier, title: str) -> None:
    """Print one row for each number of icons, the names of the largest choices, and what was left out."""
    heads = ("icons", "correct", "95 % of people", "d′", "bits", "time", "energy", *(["goal"] * bool(found.goal)))
    made = table(*heads, numbers=heads[:7])
    for point in found.points:
        made.add_row(
            str(len(point.icons)) + ("" if point.optimal else " *"),
            percent(point.proportion_correct),
            f"from {percent(point.reached)}",
            number(point.d_prime),
            f"{point.information_bits:.2f}",
            f"{number(point.total_s)} s",
            "–" if point.total_J != point.total_J else f"{number(point.total_J)} J",
            *([] if point.goal is None else ["✓" if point.goal.met else "✗"]),
        )
    last = found.points[-1] if found.points else None
    starred = any(not point.optimal for point in found.points)
    crowd = count_of(found.people, "virtual person", "virtual people")
    what_if = f" with {', '.join(found.rig_changes)}" if found.rig_changes else ""
    show(
        *([title, ""] if title else []),
        made,
        "",
        *([] if last is None else [f"The {len(last.icons)}: {_named(last)}"]),
        *(["* not proven to be the best of their number"] if starred else []),
        *_amber(found),
        *_goal(found),
        *(f"Left out: {name} {reason}" for name, reason in found.excluded[:3]),
        *([f"and {len(found.excluded) - 3} more left out"] if len(found.excluded) > 3 else []),
        "",
        f"The best by {found.objective} of {found.pool} icons that can be {'chosen' if found.goal else 'played'}, for "
        f"{crowd} on the {found.rig} rig{what_if} (seed {found.seed}). {_reached(found)} These are predictions of a "
        "model, not measurements.",
    )


def _named(point: FrontierPoint) -> str:
    return ", ".join(f"{name} (amber)" if name in point.amber else name for name in point.icons)


def _amber(found: Frontier) -> Iterator[str]:
    """From how many icons on a choice has one that passes a soft limit; nothing where none has."""
    sizes = [str(len(point.icons)) for point in found.points if point.amber]
    if sizes:
        yield f"With icons that pass a soft limit of safety (amber): the choices of {', '.join(sizes)}"


def _goal(found: Frontier) -> Iterator[str]:
    """The largest choice that meets the goal with its parts, or the smallest with what is in its way."""
    judged = [(len(point.icons), point.goal) for point in found.points if point.goal is not None]
    if not judged:
        return
    met = [each for each in judged if each[1].met]
    if met:
        count, result = met[-1]
        more = "the largest choice here" if count == judged[-1][0] else "by no larger choice of these"
        yield from goal_lines(result.to_dict(), f"met by the best {count}, {more}")
    else:
        count, result = judged[0]
        yield from goal_lines(result.to_dict(), f"met by none of these choices; the best {count}:")


def _reached(found: Frontier) -> str:
    if found.draws:
        return (
            "What 95 % of people reach is about people and the uncertainty of the model together "
            f"({found.draws} draws), as in a goal."
        )
    return "What 95 % of people reach is about people alone, at the nominal constants: milder than in a goal."
