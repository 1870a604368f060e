"""The cheapest change of one number with which an icon that is hardly felt is reported."""

from __future__ import annotations

import math

import numpy as np

from thermicon.circuit.solver.inverse import baseline_C
from thermicon.icons import parse
from thermicon.icons.model.changes import numbers_of
from thermicon.icons.model.statements import all_played

from ..ranking.ranking import Ranking
from ..ranking.scores import objection
from .candidate_edits import changed
from .edit import Edit
from .pool import Pool

LARGEST, STEPS = 64.0, 24
"""A number becomes at most so many times larger or smaller, in steps of a fifth."""


def louder(ranking: Ranking, name: str, wanted: float) -> Edit | None:
    """The cheapest edit with which the nominal person reports an icon in a share of plays; None where none does.

    It is read back from its text, safe and reached. What people report is left to be judged, and its `d_prime` is NaN.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import parse
    >>> from thermicon.perception import rank
    >>> icon = "icon dip { cool by 0.1 °C at 1 °C/s; return at 3 °C/s }"
    >>> faint = parse("cue 1; set s { site thenar; control display; baseline 32 °C }; " + icon)
    >>> louder(rank(faint, Rig.load("thenar"), people=4, parameters=0), "dip", 0.9).text
    'dip: cool by 0.1 °C at 1 °C/s → cool by ... °C at 1 °C/s...'
    """
    job, nominal = ranking.job, ranking.model.nominal
    kept, place = Pool.of(job.icons, job.rig, nominal), ranking.labels.index(name)
    icon = job.icons[place]
    # An icon that another one plays would change that one too.
    if name in {one.name for each in job.icons for one in all_played(each.statements)}:
        return None
    ways = [(place, number, up) for number in numbers_of(icon, baseline_C(icon, job.rig)) for up in (True, False)]
    logs = np.log(LARGEST) * np.arange(1, STEPS + 1) / STEPS
    tried = [one for w, way in enumerate(ways) for log in logs for one in changed(kept, way, w, 0, log, 2)]
    if not tried:
        return None
    felt = Pool.of([one.icon for one in tried], job.rig, nominal)
    reports = felt.felt_by(nominal)[0].tolist()
    for one, share, trace in sorted(zip(tried, reports, felt.traces, strict=True), key=lambda each: each[0].cost):
        read = share >= wanted and objection(trace) is None and parse(str(one.icon))[name]
        if read and read.statements == one.icon.statements:
            return Edit(name, one.old, one.new, one.cost, one.added_s, math.nan, one.icon)
    return None
