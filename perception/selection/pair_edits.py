"""The cheapest edits that separate the pairs of a ranking."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..criteria import DISTINGUISHABLE_DPRIME
from .edit import cheapest_edit
from .edit_result import Edit, NoEdit

if TYPE_CHECKING:
    from ..ranking.ranking import Ranking

EDITS = ("worst", "all", "none")


def cheapest_edits(ranking: Ranking, which: str = "worst") -> dict[tuple[str, str], Edit | NoEdit]:
    """An edit, by names, for the `worst` pair, for `all` that are not distinguishable, or for `none`."""
    if which not in EDITS:
        raise ValueError(f"edits are of {', '.join(EDITS)}, not {which!r}")
    near = [(p.a, p.b) for p in ranking.pairs if which == "all" and p.d_prime < DISTINGUISHABLE_DPRIME]
    worst = [] if ranking.worst_pair is None or which == "none" else [ranking.worst_pair]
    return {pair: cheapest_edit(ranking, *pair) for pair in dict.fromkeys([*near, *worst])}
