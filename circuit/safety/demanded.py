"""What hardware must prevent so that currents stay safe with a single fault, in any play after the shortest pause."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import repeat

import numpy as np

from ..arrays import Array
from ..rig.rules import Limits
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .checks import Check, Scenario, colour_of, findings_of
from .current import CurrentPlant, CurrentPlay
from .demands import CutOff, Demands, PolarityCheck, SingleFault
from .ensemble import Ensemble
from .exposure import cem43_min
from .held import BEYONDS_K, around_C, held_C, stays
from .plant import Single
from .repeated import LONGEST_PAUSE_S, PAUSE_STEP_S, PRACTICAL_S, Repeating, lengthened_s
from .single_faults import STUCK_SHARES, Faulty
from .starts import Beginning
from .tally import HOTTEST_C, WATCHED, Tally

OFF_S = 10.0
"""So long the output is off before the polarity is tested."""
TEST_A, TEST_S = 0.3, 2.0
"""A current small enough for any module and skin, for long enough to be seen by any thermistor."""

Span = tuple[float, float]
Found = tuple[Demands, tuple[Check, ...]]
"""What the hardware must prevent, and checks that fail where it cannot."""


def demanded(
    plant: CurrentPlant,
    singles: Sequence[Single[CurrentPlay, State]],
    recovered_s: Sequence[float],
    repeating: Repeating[CurrentPlay, State],
    shortest_s: float | None,
) -> tuple[float | None, list[Found]]:
    """The shortest pause after which faults can be prevented in practice, and what prevents them in any play after it.

    Shorter pauses need a quicker watchdog and a quicker cut-off. Where these would be quicker than PRACTICAL_S, and are
    not with a pause in which display and skin recover, the pause is lengthened instead; so it is where a cut-off would
    act on plays. A set that no pause makes safe is judged with the longest.
    """
    display = [check.value for single in singles for check in single.checks if check.quantity == "display"]
    reach_C, faults = (min(display), max(display)), list[Faulty]()
    for single in singles:
        drive, rest_A = single.play.drive, float(single.play.rest_A)
        assert isinstance(drive, Drive)
        faults.append(Faulty(plant.ensemble, drive, rest_A, single.start, repeating.limits))
    held = held_C(plant.rig, repeating.limits)
    begin_s = LONGEST_PAUSE_S if shortest_s is None else shortest_s
    beginning = Beginning.of(repeating, begin_s, max(recovered_s))
    starts_of = cache(beginning.after)

    def after(pause_s: float) -> list[Faulty]:
        return [replace(one, bounds=starts_of(pause_s).bounds) for one in faults]

    @cache
    def reach_of(pause_s: float) -> Span:
        lows, highs = zip(reach_C, *(one.shown_C for one in after(pause_s)), strict=True)
        return min(lows), max(highs)

    def ends(pause_s: float, beyond_K: float) -> Span:
        return around_C(repeating.limits, reach_of(pause_s), held, beyond_K)

    longest_s = max(begin_s, *recovered_s)
    react_s = [_resting(after(longest_s)[0], ends(longest_s, one))[0].react_within_s for one in BEYONDS_K]
    beyond_K = BEYONDS_K[int(np.argmax(np.minimum(react_s, PRACTICAL_S)))]  # the farthest that suffices, or the slowest
    hardest = [one.hardest(ends(begin_s, beyond_K), PRACTICAL_S) for one in after(begin_s)]

    def holds(number: int, pause_s: float, within_s: Span) -> bool:
        if stays(reach_of(pause_s), held):
            return False
        if not any(within_s):
            return True
        faulty = after(pause_s)[number].at(hardest[number])
        cut = CutOff(*ends(pause_s, beyond_K), within_s[1])
        return bool(faulty.beyond_K(faulty.moments(), within_s[0], cut).max() <= 0.0)

    numbers, within = range(len(singles)), (PRACTICAL_S, PRACTICAL_S)

    def found(pause_s: float, needed: Sequence[Span] | None = None) -> list[_InPlays] | None:
        """Demands of each drive; None as soon as one needs something quicker than in `needed`."""
        at_C, faulty, demands = ends(pause_s, beyond_K), after(pause_s), {}
        for number in sorted(numbers, key=lambda number: not (needed and any(needed[number]))):  # may not suffice first
            one = demands[number] = _in_plays(faulty[number], hardest[number], at_C)
            if needed and np.less(one.within_s, needed[number]).any():
                return None
        return [demands[number] for number in numbers]

    def completed(in_plays: Sequence[_InPlays], pause_s: float) -> list[Found]:
        starts = starts_of(pause_s)
        rest_s = None if shortest_s is None else beginning.kept_s(starts, pause_s)
        failed = () if shortest_s is None else stays(reach_of(pause_s), held)
        said_s = None if shortest_s is None else pause_s
        resting = _resting(after(pause_s)[0], ends(pause_s, beyond_K))
        rows = zip(faults, singles, in_plays, numbers, strict=True)
        return [
            (_demands(faulty, single, one, resting, (rest_s, beginning.unpowered(k, 0.0)), said_s), failed)
            for faulty, single, one, k in rows
        ]

    if shortest_s is None:
        return None, completed(found(begin_s) or [], begin_s)
    needed = [(0.0, 0.0) if holds(k, shortest_s, within) else within for k in numbers]
    if not all(holds(k, longest_s, needed[k]) for k in numbers) and not stays(reach_of(longest_s), held):
        at_best = found(longest_s) or []
        needed = [
            (min(most[0], one.within_s[0]), min(most[1], one.within_s[1]))
            for most, one in zip(needed, at_best, strict=True)
        ]
    pause_s = lengthened_s(shortest_s, longest_s, lambda longer_s: all(map(holds, numbers, repeat(longer_s), needed)))
    added_s = max(PAUSE_STEP_S, 0.02 * pause_s)
    while (in_plays := found(pause_s, needed if pause_s < longest_s else None)) is None:
        pause_s, added_s = min(longest_s, math.ceil((pause_s + added_s) / PAUSE_STEP_S) * PAUSE_STEP_S), 2.0 * added_s
    return pause_s, completed(in_plays, pause_s)


@dataclass(frozen=True, slots=True)
class _InPlays:
    """Demands against a host that hangs and a driver stuck at its limit in plays, with both faults."""

    watchdog_s: float
    cut_off: CutOff
    hangs: SingleFault
    stuck: SingleFault

    @property
    def within_s(self) -> Span:
        """How quickly watchdog and cut-off must act, in s."""
        return self.watchdog_s, self.cut_off.react_within_s


def _in_plays(faulty: Faulty, hardest: list[int], ends_C: Span) -> _InPlays:
    """What prevents faults in plays between bounds: found in the `hardest` corners, again where too slow."""
    for current_A in faulty.ends_A if faulty.ensemble.ideal else ():
        faulty.ensemble.modes(current_A)  # once for all corners and icons
    few = faulty.at(hardest)
    moments = few.moments()
    watchdog_s, hangs = few.watchdog_s(moments)
    cut_off, stuck = few.cut_off(ends_C, moments, hangs=not watchdog_s)
    far_K = few.beyond_K(moments, watchdog_s, cut_off)
    worst = far_K.reshape(len(far_K), len(moments.instants), -1).max(axis=2).argmax(axis=1)
    everywhere = replace(faulty, instants=tuple(np.unique(worst).tolist()))
    moments = everywhere.moments()
    too_slow = (everywhere.beyond_K(moments, watchdog_s, cut_off) > 0.0).any(axis=0)
    if too_slow.any():
        there = faulty.at(np.unique(moments.rigs[too_slow]).tolist())
        moments = there.moments()
        watchdog_s, hangs = min((watchdog_s, hangs), there.watchdog_s(moments), key=lambda found: found[0])
        cut_off, stuck = min(
            (cut_off, stuck),
            there.cut_off(ends_C, moments, hangs=not watchdog_s),
            key=lambda found: found[0].react_within_s,
        )
    return _InPlays(watchdog_s, cut_off, hangs, stuck)


def _resting(faulty: Faulty, ends_C: Span) -> tuple[CutOff, SingleFault]:
    """Demands against a driver that gets stuck before a play, between the bounds or without power before."""
    ensemble, off = faulty.ensemble, faulty.ensemble.at_rest(0.0)
    test_A = testing_A(ensemble)
    unpowered = (off, faulty.rest_A), (ensemble.rest(test_A, off, TEST_S), test_A)
    return faulty.cut_off(ends_C, faulty.resting(unpowered), shares=STUCK_SHARES)


def _demands(
    faulty: Faulty,
    single: Single[CurrentPlay, State],
    found: _InPlays,
    resting: tuple[CutOff, SingleFault],
    first: tuple[float | None, Sequence[Check]],
    pause_s: float | None,
) -> Demands:
    """Demands of a drive on the hardware; `first`: the rest before a first play, and its effect."""
    ensemble, limits = faulty.ensemble, faulty.limits
    cut_off, stuck = min((found.cut_off, found.stuck), resting, key=lambda each: each[0].react_within_s)
    polarity, swapped = polarity_check(faulty)
    rest_s, findings = first
    begins = SingleFault("unpowered", colour_of(findings), {"finding": next(iter(findings), None), "rest_s": rest_s})
    zero = None
    if ensemble.ideal:
        dose = single.tallies[0].summed("thermal dose")
        zero = dose_time_s(ensemble, limits, single.end, dose, limits.session_s)
        zero = None if zero >= limits.session_s else float(math.floor(zero))
    faults = found.hangs, begins, swapped, stuck
    return Demands(found.watchdog_s, cut_off, polarity, rest_s, pause_s, zero, faults)


def polarity_check(faulty: Faulty) -> tuple[PolarityCheck, SingleFault]:
    """The effect of swapped poles, and the wiring check that detects them."""
    swapped = Drive(faulty.drive.time_s, -faulty.drive.current_A, faulty.drive.held)
    tally = Tally(faulty.limits, faulty.ensemble.corners, Scenario(way="poles swapped"))
    low, high = np.inf, -np.inf
    for (rows, values), _ in faulty.ensemble.play(swapped, faulty.ensemble.at_rest(0.0)):
        tally.add(rows, values)
        skin = np.nan_to_num(values[WATCHED.index("skin_C")], nan=999.0)
        low, high = min(low, float(skin.min())), max(high, float(skin.max()))
    test_A = testing_A(faulty.ensemble)
    values, _ = faulty.ensemble.hold(test_A, faulty.ensemble.at_rest(0.0), np.array([0.0, TEST_S]))
    display = values[WATCHED.index("display_C")]
    fall = float((display[:, 0] - display[:, -1]).min())
    needed = not tally.passes()
    least_K = math.floor(50.0 * fall) / 100.0
    check = PolarityCheck(needed, OFF_S, test_A, TEST_S, least_K, (round(low, 1), round(high, 1)))
    return check, SingleFault("swapped", colour_of(findings_of(tally.checks())), {"check": check})


def testing_A(ensemble: Ensemble) -> float:
    """The current in A by which the polarity is checked: in whole milliamperes, within the driver's."""
    return math.floor(1e3 * min(TEST_A, ensemble.rig.driver.current_max_A) + 1e-9) / 1e3


def dose_time_s(ensemble: Ensemble, limits: Limits, state: State, dose_before: Array, session_s: float) -> float:
    """How long in s zero current may last until the dose, `dose_before` (corners,) with it, reaches its limit."""
    most = next(rule.limit for rule in limits.rules if rule.quantity == "thermal dose")
    times = np.concatenate([[0.0], np.geomspace(1.0, session_s, 120)])
    values, _ = ensemble.hold(0.0, state, times)
    skin = np.clip(np.nan_to_num(values[WATCHED.index("skin_C")], nan=HOTTEST_C), None, HOTTEST_C)
    dose = cem43_min(times, skin).max(axis=0) + float(dose_before.max())
    over = np.flatnonzero(dose > most)
    return session_s if not len(over) else float(times[max(0, over[0] - 1)])
