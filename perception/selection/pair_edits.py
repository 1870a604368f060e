"""The pairs of a ranking with the cheapest edit that separates each of those it is wanted for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from ..arrays import Array
from ..criteria import DISTINGUISHABLE_DPRIME
from ..identification.task import USUAL, Task
from ..observer.observer import Norm, Observer
from ..observer.people import People
from .edit import cheapest_edit

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

    from ..ranking.scores import PairScore


def with_edits(
    which: str,
    pairs: Sequence[PairScore],
    worst: tuple[str, str] | None,
    icons: Sequence[Icon],
    rig: Rig,
    crowd: People,
    tracking: str | None,
    norm: Norm,
    middle: Array,
    task: Task = USUAL,
    observer: Observer | None = None,
) -> tuple[PairScore, ...]:
    """The pairs, with an edit for the `worst`, for `all` that are not distinguishable, or for `none`.

    `middle` is the median d′ (icons, icons) of all pairs.
    """

    def wants_edit(pair: PairScore) -> bool:
        if which == "all":
            return pair.d_prime < DISTINGUISHABLE_DPRIME or (pair.a, pair.b) == worst
        return which == "worst" and (pair.a, pair.b) == worst

    return tuple(
        replace(
            pair,
            edit=cheapest_edit(
                icons,
                rig,
                pair.a,
                pair.b,
                people=crowd,
                tracking=tracking,
                norm=norm,
                before=middle,
                task=task,
                observer=observer,
            ),
        )
        if wants_edit(pair)
        else pair
        for pair in pairs
    )
