"""A session in the worst case: the whole drive in every corner of the rig's uncertainty, and what follows it.

As one play at the gate: rows no farther apart than 10 ms or the driver's updates, so that no rate is averaged away, in
stretches, so that memory does not grow with the session. A session is a given sequence, so it is not judged
for repetition; an export covers single faults of the hardware.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..rig.rig import Rig
from ..rig.rules import Limits
from .checks import Check, worst_of
from .endings import ENDINGS, follow_endings, judge_the_end
from .ensemble import Ensemble
from .repeated import recovery_s, skin_C
from .sessiondrive import SessionDrive
from .tally import Tally

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class WorstCase:
    """Every rule in its worst scenario, the number of scenarios, and the recovery time of display and skin.

    `recovery_s` counts from the end of the session until both are within 0.1 K of where they began in every corner,
    with the resting current held; None where that takes longer than 10 min.
    """

    checks: tuple[Check, ...]
    scenarios: int
    recovery_s: float | None


def worst_case_of(played: SessionDrive, rig: Rig, limits: Limits, progress: Progress | None = None) -> WorstCase:
    """Check a session against every rule in all corners; `progress` is called with the seconds played and the total.

    Raises RigError where the rig as given has no steady state to start from.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):  # small matrices: threads would only wait for each other
        ensemble, drive = Ensemble.of(rig), played.drive
        start = state = ensemble.at_rest(played.rest_A)
        end_s = float(drive.time_s[-1])
        whole = Tally(limits, ensemble.corners)
        for (rows, values), then in ensemble.play(drive, state):
            whole.add(rows, values)
            state = then
            if progress is not None:
                progress(round(float(rows[-1])), round(end_s))
        endings = {ending: whole.fork(f"then {ending}") for ending in ENDINGS}
        follow_endings(ensemble, state, float(drive.current_A[-1]), end_s, endings)
        later = judge_the_end(ensemble, limits, end_s, skin_C(ensemble, start))
        checks = worst_of([each.checks() for each in (whole, *endings.values(), later)])
        recovery = recovery_s(ensemble, played.rest_A, start, state)
    return WorstCase(checks, len(ensemble.corners) * len(ENDINGS), recovery)
