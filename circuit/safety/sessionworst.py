"""A session in the worst case: the whole drive in every corner of the rig's uncertainty, and what follows it.

As one play at the gate: rows no farther apart than 10 ms or the driver's updates, so that no rate is averaged away, in
stretches, so that memory does not grow with the session. A session is a given sequence, so it is not judged
for repetition; an export covers single faults of the hardware.

A break, in which the hand is off and then lands again, brings skin and module back towards rest. With a given current
every temperature and every rate is affine in the state that a play begins from, so that a block after a break lies
between the block within one run without breaks and the block from rest: both are judged.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..cores import quiet_blas
from ..rig.rig import Rig
from ..rig.rules import Limits
from .checks import Check, colour_of, findings_of, worst_of
from .current import CurrentPlant, CurrentPlay
from .endings import judge_the_end
from .ensemble import Ensemble
from .plant import follow
from .sessiondrive import SessionDrive
from .single import recovery_s
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

    @property
    def findings(self) -> tuple[Check, ...]:
        """The limits that are exceeded, the hard ones first."""
        return findings_of(self.checks)

    @property
    def verdict(self) -> str:
        """Green, amber or red."""
        return colour_of(self.findings)


def worst_case_of(played: SessionDrive, rig: Rig, limits: Limits, progress: Progress | None = None) -> WorstCase:
    """Check a session against every rule in all corners; `progress` is called with the seconds played and the total.

    Raises RigError where the rig as given has no steady state to start from.
    """
    return worst_case_of_blocks((played,), rig, limits, progress)


def worst_case_of_blocks(
    blocks: Sequence[SessionDrive], rig: Rig, limits: Limits, progress: Progress | None = None
) -> WorstCase:
    """Check blocks, each from rest and with what may follow it, as `worst_case_of`; doses add up over all of them.

    Times run on from block to block, breaks left out; `recovery_s` is that after the last block.
    """
    total_s = sum(float(played.drive.time_s[-1]) for played in blocks)
    with quiet_blas():
        plant, before_s = CurrentPlant(Ensemble.of(rig)), 0.0
        whole, tallies = Tally(limits, plant.corners), list[Tally]()
        for played in blocks:
            play = CurrentPlay(played.drive, played.rest_A)
            start = state = plant.rest(play)
            for (rows, values), then in plant.play(play, state):
                whole.add(before_s + rows, values)
                state = then
                if progress is not None:
                    progress(round(before_s + float(rows[-1])), round(total_s))
            before_s += play.end_s
            endings = [whole.fork(ending) for ending in plant.endings]
            follow(plant, play, state, before_s, endings)
            tallies += endings
        tallies.append(judge_the_end(plant.ensemble, limits, before_s, plant.now(play, start)[0]))
        checks = worst_of([each.checks() for each in (whole, *tallies)])
        recovery = recovery_s(plant, play, start, state)
    return WorstCase(checks, len(plant.corners) * len(plant.endings), recovery)
