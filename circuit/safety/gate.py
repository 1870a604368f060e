"""The safety gate: a drive checked against every rule in the worst case."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.cores import quiet_blas

from ..rig.layout import AnyLayout, Layout
from ..rig.rig import Rig
from ..rig.rules import Limits
from ..rig.uncertainty import Uncertainty, tightened
from ..solver.drive import Drive, DriveError
from .checks import Check, Judged, colour_of, findings_of, hard_of, hard_reason, worst_of
from .current import CurrentPlant, CurrentPlay
from .demands import Demands
from .display import DisplayCourse, DisplayPlant
from .ensemble import Ensemble
from .plant import Plant, Played, Single, States
from .repeated import LONGEST_PAUSE_S, Repeated, Repeating, check_pause, plays_in, shortest_pause_s
from .spans import ENDING_S


@dataclass(frozen=True, slots=True)
class Gate(Judged):
    """The verdict on one drive.

    Attributes
    ----------
    rig_name
        Name of the rig.
    duration_s
        Duration of the drive in s.
    uncertainty, limits
        The uncertainty of the rig and the limits that were applied.
    scenarios
        Number of combinations of corner and ending.
    checks
        Every rule in its worst scenario; times count from the first row of the play.
    once
        The same for a single play and what follows it.
    after_C
        Skin of the rig as given in °C, 60 s after the last sample, for each ending.
    drift_C
        Its steady state in °C under zero current; None for a device without a current.
    repeated
        The verdict on repeated plays, which `checks` include.
    demands
        What the hardware must prevent.

    See Also
    --------
    gate : The function that returns it.
    """

    rig_name: str
    duration_s: float
    uncertainty: Uncertainty
    limits: Limits
    scenarios: int
    checks: tuple[Check, ...]
    once: tuple[Check, ...]
    after_C: dict[str, float]
    drift_C: float | None
    repeated: Repeated
    demands: Demands

    def __repr__(self) -> str:
        return f"Gate({self.colour}: {len(self.checks)} rules in {self.scenarios} scenarios on {self.rig_name})"

    @property
    def colour(self) -> str:
        """Green, amber (only soft limits are exceeded) or red."""
        return "red" if self.repeated.too_soon else colour_of(self.findings)

    @property
    def reason(self) -> str | None:
        """The first hard limit exceeded, in one sentence with its cure; None where there is none.

        A single play comes first: where that is not safe, repetition adds no information.
        """
        return hard_reason(findings_of(self.once)) or self.repeated.reason

    @property
    def safe_once(self) -> bool:
        """Whether a single play passes no hard limit, and nothing fails that must prevent its single faults."""
        return not hard_of(findings_of(self.once))

    @property
    def mended_by_pause(self) -> bool:
        """Whether a longer pause between plays is all that is missing."""
        return self.safe_once and self.repeated.shortest_pause_s is not None

    @property
    def demanded(self) -> dict[str, object]:
        """Demands on the hardware, in the form of sidecars and players."""
        return self.demands.to_dict()

    def to_dict(self) -> dict[str, object]:
        """All of it in the form of a sidecar."""
        from .words import WHAT_IT_IS_NOT

        return {
            "colour": self.colour,
            "what_it_is_not": WHAT_IT_IS_NOT,
            "reason": self.reason,
            "limits": self.limits.to_dict(),
            "uncertainty": {**self.uncertainty.model_dump(), "smaller_than_shipped": list(tightened(self.uncertainty))},
            "scenarios": self.scenarios,
            "ending_s": ENDING_S,
            "skin_after_ending_C": dict(self.after_C),
            "skin_in_the_end_at_zero_current_C": self.drift_C,
            "repeated": self.repeated.to_dict(),
            "recovery_s": self.repeated.recovery_s,
            "shortest_pause_s": self.repeated.shortest_pause_s,
            "findings": [finding.to_dict() for finding in self.findings],
            "checks": [check.to_dict() for check in self.checks],
        }


@checked
def gate(
    drive: Drive,
    rig: AnyLayout = "thenar",
    *,
    rest_A: float | None = None,
    bridge_A: float | None = None,
    limits: Limits | None = None,
    pause_s: float | None = None,
) -> Gate:
    """Check a drive against every rule of safety, on the rig and in all corners of its uncertainty.

    The drive is what the hardware receives, played open loop: one that ends in the middle of a ramp, as a design does,
    leaves that current on and is judged accordingly. It is followed through its endings (60 s of its last value, zero
    current, no power; zero current without limit of time), repeated plays and single faults.

    Parameters
    ----------
    drive
        The current that the hardware receives.
    rig
        The rig, or the name or file of one, or a layout of one; its uncertainty determines the corners.
    rest_A
        Current in A held before the drive and in the pauses; None: the drive's first current.
    bridge_A
        The current in A that a bridge switches; `rest_A` and the last current of the drive are then means.
    limits
        Limits in place of the rig's.
    pause_s
        Time between plays, 0 to 600 s; None: the recovery time.

    Returns
    -------
    Gate
        Colour, and the worst value of every rule with its scenario.

    Raises
    ------
    RigError
        Where there is no steady state to start from.
    DriveError
        For an impossible resting current.
    PauseError
        For an impossible pause.
    UnjudgedError
        Where repeated plays cannot be bounded.

    Examples
    --------
    >>> from thermicon.circuit import design
    >>> from thermicon.icons import load_library
    >>> rig = Rig.load("thenar")
    >>> plan = design(load_library("six-icons")["cooling-step"], rig, 8.0)
    >>> ended = Drive(plan.drive.time_s, [*plan.drive.current_A[:-1], plan.rest_A], held=True)
    >>> gate(ended, rig, rest_A=plan.rest_A)  # red without its end, which would leave the last current on
    Gate(green: 22 rules in 195 scenarios on thenar)
    """
    if rest_A is None:
        if bridge_A is not None:
            raise DriveError("the mean current of rest is needed where a bridge switches; give rest_A")
        rest_A = float(drive.current_A[0])
    elif not np.isfinite(rest_A) or (bridge_A is not None and abs(rest_A) > bridge_A):
        most = "" if bridge_A is None else f" of at most {bridge_A:g} A"
        raise DriveError(f"a rest of {rest_A:g} A is not possible; it must be a finite current{most}")
    return gate_set([(drive, rest_A)], Layout.of(rig).alone, bridge_A=bridge_A, limits=limits, pause_s=pause_s)[0]


def gate_set(
    drives: Sequence[tuple[Drive, float]],
    rig: Rig,
    *,
    bridge_A: float | None = None,
    limits: Limits | None = None,
    pause_s: float | None = None,
    averaged: bool = False,
) -> tuple[Gate, ...]:
    """Check drives, each with its rest in A, that may be played repeatedly in any order; as `gate` does.

    Each is judged by itself, and between bounds on the states that any sequence of all can reach; the pause is by
    default the longest recovery time. `averaged`: drives have the mean currents of a bridge too fast for a plate to
    follow.
    """
    check_pause(pause_s)
    with quiet_blas():
        plant = CurrentPlant.of(Ensemble.of(rig, bridge_A, averaged))
        rules = rig.limits if limits is None else limits
        return _gated([[CurrentPlay(drive, rest)] for drive, rest in drives], plant, rules, pause_s)


def gate_shown(
    drives: Sequence[Sequence[DisplayCourse]],
    rig: Rig,
    *,
    stuck_C: tuple[float, float],
    limits: Limits | None = None,
    pause_s: float | None = None,
    module: bool = False,
) -> tuple[Gate, ...]:
    """Check what a device with its own control loop shows, in repeated plays in any order; as `gate_set` does.

    `drives` has the display of each drive in each way in which the device may follow; of the rig, skin, contact and air
    with their uncertainty are used. A single fault may leave the device at one of `stuck_C` (°C). `module` keeps the
    rules of a hot plate, taken as warm as the display, so that checks can be joined with a module's; the rate of skin
    is left to these, since a jump of the display is an idealisation.
    """
    check_pause(pause_s)
    rules = rig.limits if limits is None else limits
    if not module:
        rules = replace(rules, rules=tuple(rule for rule in rules.rules if rule.quantity != "hot plate"))
    return _gated(drives, DisplayPlant.of(rig, stuck_C, rates=not module), rules, pause_s)


def _gated(
    drives: Sequence[Sequence[Played]], plant: Plant[Played, States], limits: Limits, pause_s: float | None
) -> tuple[Gate, ...]:
    singles = [[Single.of(plant, play, limits) for play in ways] for ways in drives]
    safe = [all(single.safe for single in ways) for ways in singles]
    together = [number for number, each in enumerate(safe) if each]
    gates: dict[int, Gate] = {}

    def judge(group: list[int], safe: bool) -> None:
        judged = _gated_together(plant, [singles[number] for number in group], limits, pause_s, safe)
        gates.update(zip(group, judged, strict=True))

    for number, each in enumerate(safe):
        if not each:  # never written, so never part of a sequence
            judge([number], False)
    if together:
        judge(together, True)
    if len(together) > 1 and not all(gates[number].safe_once for number in together):
        for number in together:  # whose faults nothing prevents by itself is refused, and the others are judged anew
            judge([number], True)
        if rest := [number for number in together if gates[number].safe_once]:
            judge(rest, True)
    return tuple(gates[number] for number in range(len(drives)))


def _gated_together(
    plant: Plant[Played, States],
    singles: Sequence[Sequence[Single[Played, States]]],
    limits: Limits,
    pause_s: float | None,
    safe: bool,
) -> Iterator[Gate]:
    """The verdicts on drives, each in its ways of being followed, that may follow each other in any order."""
    times = [[single.recovery_s for single in ways] for ways in singles]
    recoveries = [None if None in each else max(time for time in each if time is not None) for each in times]
    recovered_s = [LONGEST_PAUSE_S if time is None else time for time in recoveries]
    pause = max(recovered_s) if pause_s is None else pause_s
    repeating = Repeating(plant, [[single.play for single in ways] for ways in singles], limits)
    tallies = repeating.tallies(pause)
    shortest = shortest_pause_s(repeating) if safe else None  # no pause makes a play safe that is red by itself
    if shortest is not None and shortest > pause and repeating.safe(pause):  # the search is exact to 2 % only
        shortest = pause
    demanded = plant.demanded(singles, recovered_s, repeating, tallies, shortest)
    for ways, recovery, own, demands in zip(singles, recoveries, tallies, demanded.demands, strict=True):
        first, last = ways[0], ways[-1]
        once, again = worst_of(single.checks for single in ways), worst_of(tally.checks() for tally in own)
        plays = plays_in(first.play, pause, limits.session_s)
        yield Gate(
            plant.rig.name,
            first.play.end_s,
            plant.rig.uncertainty,
            limits,
            len(plant.corners) * len(ways) * len(plant.endings),
            (*worst_of([once, again]), *demanded.failed),
            (*once, *demanded.failed),
            {ending: float(skin_C[0]) for ending, skin_C in last.after_C.items()},
            plant.drift_C,
            Repeated(pause, recovery, demanded.pause_s, plays, limits.session_s, again, shortest),
            demands,
        )
