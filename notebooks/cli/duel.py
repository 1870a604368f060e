"""Which of two sets is told apart better, and how surely, for people and rigs drawn at random."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..text.number_text import number, percent

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import SetComparison

MOST_IN_A_SET = 30
"""Larger sets are compared icon by icon alone; `thermicon.perception.compare_sets` takes them."""


def duel_of(first: IconSet, second: IconSet, rig: Rig) -> str | None:
    """Return one sentence on which of two sets wins; None where one has a single icon, or very many."""
    from thermicon.perception import compare_sets

    if any(not 2 <= len(icons) <= MOST_IN_A_SET for icons in (first, second)):
        return None
    return duel_line(compare_sets(first, second, rig))


def duel_line(found: SetComparison) -> str:
    """Say how often A beats B, and by how much.

    >>> from thermicon.perception import SetComparison
    >>> duel_line(SetComparison(0.93, 0.02, 0.41, "worst", 100))
    'predicted: A is told apart better than B in 93 % of 100 draws of person, contact, room and rig; in the middle its \
worst pair is d′ 0.4 farther apart'
    """
    share, better = (found.probability, "A") if found.probability >= 0.5 else (1.0 - found.probability, "B")
    other = "B" if better == "A" else "A"
    drawn = f"{found.draws} draws of person, contact, room and rig"
    if share < 0.5 + 2.0 * found.standard_error:
        return f"predicted: A and B are told apart equally well, as far as {drawn} can say"
    gain = abs(found.gain)
    return (
        f"predicted: {better} is told apart better than {other} in {percent(share)} of {drawn}; "
        f"in the middle its worst pair is d′ {number(gain)} farther apart"
    )
