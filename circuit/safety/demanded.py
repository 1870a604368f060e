"""What hardware must prevent so that currents stay safe with a single fault, in any play after the shortest pause."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import repeat

import numpy as np

from ..arrays import Array
from ..rig.rules import Limits
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .checks import CutOff, Demands, PolarityCheck, Scenario, SingleFault, colour_of, findings_of
from .current import CurrentPlant, CurrentPlay
from .ensemble import Ensemble
from .plant import Single
from .repeated import PAUSE_STEP_S, PRACTICAL_S, Repeating, lengthened_s
from .single_faults import Faulty, around_C
from .tally import HOTTEST_C, WATCHED, Tally, cem43_min

LONGEST_REST_S = 600.0
TEST_A, TEST_S = 0.3, 2.0
"""A current small enough for any module and skin, for long enough to be seen by any thermistor."""

Span = tuple[float, float]


def demanded(
    plant: CurrentPlant,
    singles: Sequence[Single[CurrentPlay, State]],
    recovered_s: Sequence[float],
    repeating: Repeating[CurrentPlay, State],
    shortest_s: float | None,
) -> tuple[float | None, list[Demands]]:
    """The shortest pause after which faults can be prevented in practice, and what prevents them in any play after it.

    Shorter pauses need a quicker watchdog and a quicker cut-off. Where these would be quicker than PRACTICAL_S, and are
    not with a pause in which display and skin recover, the pause is lengthened instead. A set that no pause makes safe
    is judged in its first plays.
    """
    display = [check.value for single in singles for check in single.checks if check.quantity == "display"]
    reach_C, faults = (min(display), max(display)), [_faulty(plant, single, repeating.limits) for single in singles]
    if shortest_s is None:
        worst = [one.hardest(reach_C, PRACTICAL_S) for one in faults]
        return None, [_demands(*row, reach_C, None) for row in zip(faults, singles, worst, strict=True)]
    bounds_of = cache(lambda pause_s: repeating.bounds(pause_s)[1:])

    def after(pause_s: float) -> list[Faulty]:
        return [replace(one, bounds=bounds_of(pause_s)) for one in faults]

    reach_of = cache(lambda pause_s: _joined([reach_C, *(one.shown_C for one in after(pause_s))]))
    hardest = [one.hardest(reach_C, PRACTICAL_S) for one in after(shortest_s)]

    def holds(number: int, pause_s: float, within_s: Span) -> bool:
        if not any(within_s):
            return True
        faulty = after(pause_s)[number].at(hardest[number])
        cut = CutOff(*around_C(repeating.limits, reach_of(pause_s)), within_s[1])
        return bool(faulty.beyond_K(faulty.moments(), within_s[0], cut).max() <= 0.0)

    longest_s, numbers, practical = max(shortest_s, *recovered_s), range(len(singles)), (PRACTICAL_S, PRACTICAL_S)
    needed = [(0.0, 0.0) if holds(k, shortest_s, practical) else practical for k in numbers]
    for number, one in enumerate(after(longest_s)):
        if not holds(number, longest_s, needed[number]):
            few = hardest[number]
            found = _demands(one, singles[number], few, reach_of(longest_s), None).within_s
            needed[number] = min(PRACTICAL_S, found[0]), min(PRACTICAL_S, found[1])
    pause_s = lengthened_s(shortest_s, longest_s, lambda longer_s: all(map(holds, numbers, repeat(longer_s), needed)))
    added_s = max(PAUSE_STEP_S, 0.02 * pause_s)
    while True:
        there, reach, demands = after(pause_s), reach_of(pause_s), {}
        for number in sorted(numbers, key=lambda number: not any(needed[number])):  # what may not suffice first
            demand = _demands(there[number], singles[number], hardest[number], reach, pause_s)
            if pause_s < longest_s and np.less(demand.within_s, needed[number]).any():
                break
            demands[number] = demand
        else:
            return pause_s, [demands[number] for number in numbers]
        pause_s, added_s = min(longest_s, math.ceil((pause_s + added_s) / PAUSE_STEP_S) * PAUSE_STEP_S), 2.0 * added_s


def _demands(
    faulty: Faulty,
    single: Single[CurrentPlay, State],
    hardest: list[int],
    reach_C: Span,
    pause_s: float | None,
) -> Demands:
    """What the hardware must prevent in a drive, in all corners and between bounds; `reach_C` are extremes of displays.

    Watchdog and cut-off are found in the `hardest` corners, tried in all at the instants that decided, and found again
    where they are too slow. What concerns a first play is found in all corners.
    """
    ensemble, limits = faulty.ensemble, faulty.limits
    for current_A in faulty.ends_A if ensemble.ideal else ():
        ensemble.modes(current_A)  # once for all corners and icons
    few = faulty.at(hardest)
    moments = few.moments()
    watchdog_s, hangs = few.watchdog_s(moments)
    cut_off, stuck = few.cut_off(reach_C, moments, hangs=not watchdog_s)
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
            there.cut_off(reach_C, moments, hangs=not watchdog_s),
            key=lambda found: found[0].react_within_s,
        )
    first = replace(faulty, bounds=())
    rest, begins = rest_before(first)
    polarity, swapped = polarity_check(first)
    zero = None
    if ensemble.ideal:
        dose = single.tallies[0].summed("thermal dose")
        zero = dose_time_s(ensemble, limits, single.end, dose, limits.session_s)
        zero = None if zero >= limits.session_s else round(zero, 0)
    return Demands(watchdog_s, cut_off, polarity, rest, pause_s, zero, (hangs, begins, swapped, stuck))


def _faulty(plant: CurrentPlant, single: Single[CurrentPlay, State], limits: Limits) -> Faulty:
    play = single.play
    assert isinstance(play.drive, Drive)
    return Faulty(plant.ensemble, play.drive, float(play.rest_A), single.start, limits)


def _joined(spans: Sequence[Span]) -> Span:
    return min(low for low, _ in spans), max(high for _, high in spans)


def rest_before(faulty: Faulty) -> tuple[float | None, SingleFault]:
    """For how long in s rest must be held on a display that was without power, before the first play."""
    cold = faulty.ensemble.at_rest(0.0)

    def tally_after(rest_s: float) -> Tally:
        state = cold
        if rest_s > 0:
            state = faulty.ensemble.rest(faulty.rest_A, cold, rest_s)
        tally = Tally(faulty.limits, faulty.ensemble.corners)
        for (rows, values), _ in faulty.ensemble.play(faulty.drive, state):
            tally.add(rows, values)
        return tally

    at_once = tally_after(0.0)
    findings = findings_of(at_once.checks())
    rest: float | None = 0.0
    if not at_once.passes():
        low, high = 0, int(LONGEST_REST_S)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if tally_after(float(middle)).passes() else (middle, high)
        rest = float(high) if tally_after(float(high)).passes() else None
    told = {"finding": next(iter(findings), None), "rest_s": rest}
    return rest, SingleFault("unpowered", colour_of(findings), told)


def polarity_check(faulty: Faulty) -> tuple[PolarityCheck, SingleFault]:
    """The effect of swapped poles, and the wiring check that detects them."""
    swapped = Drive(faulty.drive.time_s, -faulty.drive.current_A, faulty.drive.held)
    tally = Tally(faulty.limits, faulty.ensemble.corners, Scenario(way="poles swapped"))
    low, high = np.inf, -np.inf
    for (rows, values), _ in faulty.ensemble.play(swapped, faulty.ensemble.at_rest(0.0)):
        tally.add(rows, values)
        skin = np.nan_to_num(values[WATCHED.index("skin_C")], nan=999.0)
        low, high = min(low, float(skin.min())), max(high, float(skin.max()))
    test_A = min(TEST_A, faulty.ensemble.rig.driver.current_max_A)
    values, _ = faulty.ensemble.hold(test_A, faulty.ensemble.at_rest(0.0), np.array([0.0, TEST_S]))
    display = values[WATCHED.index("display_C")]
    fall = float((display[:, 0] - display[:, -1]).min())
    needed = not tally.passes()
    check = PolarityCheck(needed, round(test_A, 3), TEST_S, round(0.5 * fall, 2), (round(low, 1), round(high, 1)))
    return check, SingleFault("swapped", colour_of(findings_of(tally.checks())), {"check": check})


def dose_time_s(ensemble: Ensemble, limits: Limits, state: State, dose_before: Array, session_s: float) -> float:
    """For how long in s zero current may last before the dose of skin reaches its limit, at most a session.

    `dose_before` (corners,) in min CEM43 is what the drive has added.
    """
    most = next(rule.limit for rule in limits.rules if rule.quantity == "thermal dose")
    times = np.concatenate([[0.0], np.geomspace(1.0, session_s, 120)])
    values, _ = ensemble.hold(0.0, state, times)
    skin = np.clip(np.nan_to_num(values[WATCHED.index("skin_C")], nan=HOTTEST_C), None, HOTTEST_C)
    dose = cem43_min(times, skin).max(axis=0) + float(dose_before.max())
    over = np.flatnonzero(dose > most)
    return session_s if not len(over) else float(times[max(0, over[0] - 1)])
