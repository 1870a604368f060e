"""Which pairs of a ranking get the cheapest edit that parts them, and the pairs with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from thermicon.perception.criteria import APART_DPRIME
from thermicon.perception.edit import cheapest_edit
from thermicon.perception.observer import Norm
from thermicon.perception.people import People
from thermicon.perception.rows import Array
from thermicon.perception.task import USUAL, Task

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon
    from thermicon.perception.ranking import PairScore


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
) -> tuple[PairScore, ...]:
    """The pairs, with an edit for the `worst`, for `all` that are not told apart, or for `none`.

    `middle` is the median d′ (icons, icons) of all pairs.
    """

    def asked(pair: PairScore) -> bool:
        if which == "all":
            return pair.d_prime < APART_DPRIME or (pair.a, pair.b) == worst
        return which == "worst" and (pair.a, pair.b) == worst

    return tuple(
        replace(
            pair,
            edit=cheapest_edit(
                icons, rig, pair.a, pair.b, people=crowd, tracking=tracking, norm=norm, before=middle, task=task
            ),
        )
        if asked(pair)
        else pair
        for pair in pairs
    )
