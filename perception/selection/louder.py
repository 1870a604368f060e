"""The cheapest change of one number with which an icon that is hardly felt is reported."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from thermicon.circuit import Trace
from thermicon.circuit.solver.inverse import baseline_C
from thermicon.icons import parse
from thermicon.icons.model.changes import numbers_of
from thermicon.icons.model.statements import all_played

from ..observer.observer import Observer
from ..ranking.ranking import Ranking
from ..ranking.scores import objection
from .candidate_edits import CandidateEdit, changed
from .edit import Edit
from .pool import Pool

LARGEST, STEPS = 64.0, 24
"""A number becomes at most so many times larger or smaller, in steps of a fifth."""


def louder(ranking: Ranking, names: Sequence[str], shares: Sequence[float]) -> Iterator[tuple[Edit, ...]]:
    """For each share of plays the cheapest edits with which the nominal person reports icons so often, of those that
    have any.

    They are read back from their text, safe and reached. What people report is left to be judged, and `d_prime` is NaN.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import parse
    >>> from thermicon.perception import rank
    >>> icon = "icon dip { cool by 0.1 °C at 1 °C/s; return at 3 °C/s }"
    >>> faint = parse("cue 1; set s { site thenar; control display; baseline 32 °C }; " + icon)
    >>> (edit,) = next(louder(rank(faint, Rig.load("thenar"), people=4, parameters=0), ["dip"], [0.9]))
    >>> edit.text
    'dip: cool by 0.1 °C at 1 °C/s → cool by ... °C at 1 °C/s...'
    """
    job, nominal = ranking.job, ranking.model.nominal
    kept = Pool.of(job.icons, job.rig, nominal)
    # An icon that another one plays would change that one too.
    played = {one.name for icon in job.icons for one in all_played(icon.statements)}
    tried = [_tried(kept, ranking.labels.index(name), nominal) for name in names if name not in played]
    for share in shares:
        yield tuple(edit for each in tried if (edit := _cheapest(each, share)) is not None)


def _tried(kept: Pool, place: int, nominal: Observer) -> list[tuple[CandidateEdit, float, Trace]]:
    """Edits of an icon, the cheapest first, each with how often it is reported and its trace."""
    numbers = numbers_of(kept.icons[place], baseline_C(kept.icons[place], kept.rig))
    ways = list(product([place], numbers, (True, False)))
    logs = np.log(LARGEST) * np.arange(1, STEPS + 1) / STEPS
    edits = list[CandidateEdit]()
    for (w, way), log in product(enumerate(ways), logs):
        edits += changed(kept, way, w, 0, log, 2)
    if not edits:
        return []
    felt = Pool.of([one.icon for one in edits], kept.rig, nominal)
    reports = felt.felt_by(nominal)[0].tolist()
    return sorted(zip(edits, reports, felt.traces, strict=True), key=lambda each: each[0].cost)


def _cheapest(tried: Sequence[tuple[CandidateEdit, float, Trace]], share: float) -> Edit | None:
    for one, reported, trace in tried:
        name = one.icon.name
        if reported < share or objection(trace) is not None:
            continue
        if parse(str(one.icon))[name].statements == one.icon.statements:
            return Edit(name, one.old, one.new, one.cost, one.added_s, math.nan, one.icon)
    return None
