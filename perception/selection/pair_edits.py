"""The cheapest edits that separate the pairs of a ranking."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..criteria import DISTINGUISHABLE_DPRIME
from .edit import find_edit
from .edit_result import Edit, NoEdit

if TYPE_CHECKING:
    from ..ranking.ranking import Ranking

EDITS = ("worst", "all", "none")


def cheapest_edit(ranking: Ranking, a: str, b: str, *, wanted: float = DISTINGUISHABLE_DPRIME) -> Edit | NoEdit:
    """Find the cheapest edit of one of two icons that separates them by a median d′.

    Every edit that is offered is read back from its text, simulated, safe and reachable, and makes no other pair worse
    by more than 0.1 d′ below twice `wanted`. The people of the ranking confirm it, in its task.

    Parameters
    ----------
    ranking
        The set as it was ranked.
    a, b
        Names of the two.
    wanted
        Median d′ to be reached; by default that of a distinguishable pair.

    Returns
    -------
    Edit or NoEdit
        The edit, or why there is none.

    Raises
    ------
    KeyError, ValueError
        For a name that is not there; for a `wanted` that is not above 0.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception import rank
    >>> ranking = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    >>> cheapest_edit(ranking, "cooling-step", "warming-step").reason
    'the pair is distinguishable already: d′ ..., criterion 2.56'
    """
    job, model = ranking.job, ranking.model
    return find_edit(
        job.icons,
        job.rig,
        a,
        b,
        wanted=wanted,
        people=model.people(job.people, job.seed),
        tracking=job.tracking,
        norm=job.norm,
        before=ranking.d_prime,
        task=job.task,
        observer=model.nominal,
    )


def cheapest_edits(ranking: Ranking, which: str = "worst") -> dict[tuple[str, str], Edit | NoEdit]:
    """An edit, by names, for the `worst` pair, for `all` that are not distinguishable, or for `none`."""
    if which not in EDITS:
        raise ValueError(f"edits are of {', '.join(EDITS)}, not {which!r}")
    near = [(p.a, p.b) for p in ranking.pairs if which == "all" and p.d_prime < DISTINGUISHABLE_DPRIME]
    worst = [] if ranking.worst_pair is None or which == "none" else [ranking.worst_pair]
    return {pair: cheapest_edit(ranking, *pair) for pair in dict.fromkeys([*near, *worst])}
