"""The gate for drives of temperatures: what a device shows, judged for one play, repeated plays and single faults."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..arrays import Array
from ..rig.rig import Rig
from ..rig.rules import Limits
from .checks import Before, Check, Scenario, findings_of, hard_of, worst_of
from .demands import CutOff, Demands, SingleFault
from .endings import ENDING_S
from .gate import Gate
from .repeated import (
    LONGEST_PAUSE_S,
    PRACTICAL_S,
    Repeated,
    check_pause,
    lengthened_s,
    pause_rows,
    shortest_of,
)
from .single_faults import BEYOND_K, MARGIN
from .tally import Tally
from .thermode import (
    DISPLAY_ENDINGS,
    DisplayCourse,
    Under,
    add_endings,
    limits_without_module,
    tally_once,
    time_to_limit_s,
)

Ways = Sequence[DisplayCourse]
"""What a device shows of one drive, in each way of following it."""


def gate_shown(
    drives: Sequence[Ways],
    rig: Rig,
    *,
    stuck_C: tuple[float, float],
    limits: Limits | None = None,
    pause_s: float | None = None,
    module: bool = False,
) -> tuple[Gate, ...]:
    """Check what a device shows, in repeated plays in any order, against every rule of safety.

    Parameters
    ----------
    drives
        For each drive, its display in each way in which the device may follow.
    rig
        The rig, of which skin, contact and air with their uncertainty are used.
    stuck_C
        Ends in °C of the device's range, at which a single fault may leave it.
    limits
        Limits in place of the rig's.
    pause_s
        Time between plays, 0 to 600 s; None: the longest recovery time.
    module
        Keep the rules of a hot plate, taken as warm as the display, so that checks can be joined with a module's.
        The rate of skin is left to these, since a jump of the display is an idealisation.

    Raises
    ------
    PauseError
        For an impossible pause.

    """
    check_pause(pause_s)
    under, limits_held = Under.of(rig), rig.limits if limits is None else limits
    limits_held, rates = limits_held if module else limits_without_module(limits_held), not module
    once: list[tuple[tuple[Check, ...], float | None, dict[str, float]]] = []
    for ways in drives:
        judged, recoveries, after = [], [], {}
        for course in ways:
            tallies, ended = tally_once(under, course, limits_held, rates)
            judged += [tally.checks() for tally in tallies]
            recoveries.append(under.recovery_s(course, ended))
            minute = np.array([ENDING_S])
            last = under.hold(float(course.display_C[-1]), ended, minute), under.let_go(ended, minute)
            after = {name: float(values[0, 0, 0]) for name, values in zip(DISPLAY_ENDINGS, last, strict=True)}
        known = [time for time in recoveries if time is not None]
        once.append((worst_of(judged), max(known) if len(known) == len(recoveries) else None, after))
    pause = pause_s
    if pause is None:
        times = [LONGEST_PAUSE_S if recovery is None else recovery for _, recovery, _ in once]
        pause = max(times)
    repeatedly = _again(under, drives, limits_held, pause, rates)
    faultless = shortest = None
    if _safe([checks for checks, _, _ in once]):  # no pause mends a play that is red by itself
        faultless = _shortest_s(under, drives, limits_held, rates)
    faults = partial(_faults, under, drives, limits_held, stuck_C)
    if faultless is not None:
        longest = max(faultless, *(LONGEST_PAUSE_S if recovery is None else recovery for _, recovery, _ in once))
        needed = np.minimum(PRACTICAL_S, [each.quickest_s for each in faults(longest)])
        shortest = lengthened_s(
            faultless, longest, lambda wait_s: bool(([each.quickest_s for each in faults(wait_s)] >= needed).all())
        )
    verdicts = []
    for ways, (checks, recovery, after), repeated_checks, fault in zip(
        drives, once, repeatedly, faults(shortest), strict=True
    ):
        plays = _plays(ways[0], pause, limits_held.session_s)
        repeated = Repeated(pause, recovery, shortest, plays, limits_held.session_s, repeated_checks, faultless)
        every = [check for each in (*(single for single, _, _ in once), *repeatedly) for check in each]
        verdicts.append(
            Gate(
                rig.name,
                ways[0].end_s,
                rig.uncertainty,
                limits_held,
                len(under.corners) * len(ways) * len(DISPLAY_ENDINGS),
                worst_of([checks, repeated_checks]),
                checks,
                after,
                None,
                repeated,
                _demands(fault, limits_held, repeated, every),
            )
        )
    return tuple(verdicts)


def _again(
    under: Under, drives: Sequence[Ways], limits: Limits, pause_s: float, rates: bool
) -> list[tuple[Check, ...]]:
    """Every rule for each drive in its steady cycle, and between the bounds on any sequence of all drives."""
    shows = [course for ways in drives for course in ways]
    begun = under.steady(float(shows[0].display_C[0]))
    sides = Before("warm", pause_s), Before("cold", pause_s)
    bounds = {before: under.bound(shows, pause_s, before.plays == "warm") for before in sides}
    skin = under.hold(float(shows[0].display_C[0]), begun, np.array([0.0]))[0, :, 0]
    all_checks = []
    for ways in drives:
        judged = []
        for course in ways:
            cycle = under.cycle(course, pause_s)
            judged.append(_cycle_checks(under, course, limits, Before("cycle", pause_s), cycle, skin, (rates, rates)))
            judged += [
                _cycle_checks(under, course, limits, before, states, skin, (False, rates))
                for before, states in bounds.items()
            ]
        all_checks.append(worst_of(checks for group in judged for checks in group))
    return all_checks


def _cycle_checks(
    under: Under,
    course: DisplayCourse,
    limits: Limits,
    before: Before,
    states: Sequence[Array],
    begun_C: Array,
    rates: tuple[bool, bool],
) -> list[tuple[Check, ...]]:
    """Every rule for one play among many and for its endings; `rates`: whether they are judged in each of the two."""
    run, pause_s = Scenario(way=course.way, before=before), before.pause_s
    values, ended = under.play(course, states)
    tally = Tally(limits, under.corners, run, plays=_plays(course, pause_s, limits.session_s), begun_C=begun_C)
    tally.add(course.rows_s, values, rates=rates[0])
    rows = np.append(0.0, pause_rows(course.left_s(pause_s)))
    if len(rows) > 1:
        tally.add(course.end_s + rows, under.hold(float(course.display_C[-1]), ended, rows), rates=False)
    endings = [Tally(limits, under.corners, replace(run, ending=ending), begun_C=begun_C) for ending in DISPLAY_ENDINGS]
    add_endings(under, course, ended, endings, sums=False, rates=rates[1])
    return [tally.checks(), *(ending.checks() for ending in endings)]


def _plays(course: DisplayCourse, pause_s: float, session_s: float) -> int:
    return max(1, math.floor((session_s + pause_s) / (course.end_s + course.left_s(pause_s)) + 1e-9))


def _safe(judged: Sequence[Sequence[Check]]) -> bool:
    return not any(hard_of(findings_of(checks)) for checks in judged)


def _shortest_s(under: Under, drives: Sequence[Ways], limits: Limits, rates: bool) -> float | None:
    def safe(pause_s: float) -> bool:
        return _safe(_again(under, drives, limits, pause_s, rates))

    return 0.0 if safe(0.0) else shortest_of(safe)


@dataclass(frozen=True, slots=True)
class _Faults:
    """Set-points that hang, and ends of a range at which a loop is stuck: level in °C, time in s to a limit."""

    hangs: list[tuple[float, float]]
    stuck: list[tuple[float, float]]

    @property
    def quickest_s(self) -> tuple[float, float]:
        """How quickly a watchdog and a cut-off must act, in s."""
        hang, stuck = (MARGIN * min(time for _, time in each) for each in (self.hangs, self.stuck))
        return hang, stuck


def _faults(
    under: Under, drives: Sequence[Ways], limits: Limits, stuck_C: tuple[float, float], pause_s: float | None
) -> list[_Faults]:
    """Faults of each drive in any play after a pause; without one, in drives that are not safe, from rest."""
    shows = [course for ways in drives for course in ways]
    found = []
    for ways in drives:
        cold = warm = under.steady(float(ways[0].display_C[0]))
        if pause_s is not None:
            cold, warm = (under.farthest(ways, under.bound(shows, pause_s, up), up) for up in (False, True))
        levels = [float(level) for course in ways for level in (course.display_C.min(), course.display_C.max())]
        hangs, stuck = (
            [
                (level, time_to_limit_s(under, limits, level, begun))
                for level, begun in zip(ends, (cold, warm), strict=True)
            ]
            for ends in ((min(levels), max(levels)), stuck_C)
        )
        found.append(_Faults(hangs, stuck))
    return found


def _demands(fault: _Faults, limits: Limits, repeated: Repeated, checks: Sequence[Check]) -> Demands:
    """What the device itself must prevent: a stuck set-point, and a loop that runs to the end of its range."""
    hangs, stuck = fault.hangs, fault.stuck
    watchdog = min(time for _, time in hangs)
    watchdog = watchdog if watchdog >= ENDING_S else round(MARGIN * watchdog, 2)
    react = min(time for _, time in stuck)
    display = [check.value for check in checks if check.quantity == "display"]
    hard = {
        rule.upper: rule.limit
        for rule in limits.rules
        if rule.quantity == "display" and rule.severity == "hard" and rule.above_C is None
    }
    cut = CutOff(
        round(max(hard[False], min(display) - BEYOND_K), 1),
        round(min(hard[True], max(display) + BEYOND_K), 1),
        round(MARGIN * react, 3),
    )
    held_C, ends_C = ([level for level, _ in each] for each in (hangs, stuck))
    faults = (
        SingleFault(
            "set-point hang",
            "red" if watchdog < ENDING_S else "green",
            {"levels_C": held_C, "watchdog_s": watchdog},
        ),
        SingleFault(
            "loop stuck",
            "red" if react < ENDING_S else "green",
            {"levels_C": ends_C, "passed_s": react, "cut_off": cut},
        ),
    )
    return Demands(watchdog, cut, None, 0.0, repeated.shortest_pause_s, None, faults)
