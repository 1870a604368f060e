"""Single faults of a drive played open loop: a host that stops, a start without rest, swapped poles.

They do not make a drive unsafe by themselves, since hardware prevents them. Simulating them in the worst corners gives
what the hardware must do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from thermicon.icons.number_text import signed

from ..arrays import Array, Index
from ..rig.rules import Limits, Rule
from ..solver.batch_inputs import Intervals, State, run_on
from ..solver.drive import Drive
from .checks import colour_of, findings_of
from .demands import CutOff, PolarityCheck, SingleFault
from .ensemble import Ensemble, between, held_currents
from .tally import WATCHED, Tally

HANG_S, INSTANTS = 60.0, 16
"""How long a stuck current is followed, and at how many instants of a drive it may get stuck."""
SAME_S = 1e-9
"""Instants closer than this differ by rounding only."""
HANG_ROWS_S = np.concatenate([np.arange(500) * 0.01, 5.0 + np.arange(551) * 0.1])
AFTER_ROWS_S = np.concatenate([np.arange(100) * 0.01, 1.0 + np.arange(291) * 0.1])
"""Rows of a stuck current, and of 30 s without any after it was cut: fine after a jump, coarse later."""
MARGIN = 0.8
"""A watchdog acts after this share of the time to a limit."""
LEAST_WATCHDOG_S = 0.05
"""A quicker watchdog is not demanded, but a cut-off on the measured temperature: assumed, a host is no quicker."""
LONGEST_REST_S = 600.0
REACTIONS_S = (2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02)
"""Reaction times of cut-offs that are tried, the slowest first."""
LIMITS_TRIED = 6
"""Current limits between the driver's own and the peak of the drive."""
TEST_A, TEST_S = 0.3, 2.0
"""A current small enough for any module and skin, for long enough to be seen by any thermistor."""
BEYOND_K = 1.0
"""Cut-offs are this far beyond what the display reaches in any corner, so that they act only on a fault."""


@dataclass(frozen=True, slots=True, eq=False)
class Faulty:
    """A drive in its worst corners, ready for its single faults; `start` is the state of rest there."""

    ensemble: Ensemble
    drive: Drive
    rest_A: float
    start: State
    limits: Limits

    def watchdog_s(self) -> tuple[float, SingleFault]:
        """How long a stuck current may last before it is cut, and its effect within a minute."""
        state, amps, rigs = self._hanging()
        values, _ = _constant(self.ensemble, amps, state, HANG_ROWS_S, rigs)
        worst, beyond = _passed(self.limits, values)
        first = HANG_S if not beyond.any() else float(HANG_ROWS_S[int(np.argmax(beyond.any(axis=0)))])
        after = first if first >= HANG_S else MARGIN * first
        while after > LEAST_WATCHDOG_S and first < HANG_S and not self._safe_after(state, amps, rigs, after):
            after *= 0.5
        after = round(after, 2) if after > LEAST_WATCHDOG_S else 0.0
        text = f"the current hangs for {HANG_S:g} s: {worst}"
        prevented = f"a watchdog that cuts the current after {after:g} s without a message from the host"
        if after == 0.0:
            prevented = "a cut-off on the measured temperature; no watchdog is quick enough"
        return after, SingleFault("host hangs in mid-play", _colour(beyond), text, prevented)

    def _hanging(self) -> tuple[State, Array, Index]:
        """States, currents with their gain, and corners, each (lanes,), for instants at which it may get stuck."""
        end, corners = float(self.drive.time_s[-1]), len(self.ensemble.corners)
        extremes = [float(self.drive.time_s[k]) for k in (self.drive.current_A.argmin(), self.drive.current_A.argmax())]
        even = [
            instant
            for instant in np.linspace(0.0, end, INSTANTS)[1:-1].tolist()
            if all(abs(instant - extreme) > SAME_S for extreme in extremes)
        ]
        instants = sorted({*even, *extremes} - {0.0, end})
        state, before, nodes, sinks, amps = self.start, 0.0, [], [], []
        for instant in instants:
            state = self.ensemble.end_of(between(self.drive, before, instant), state)
            before = instant
            nodes.append(state.nodes_C)
            sinks.append(state.sink)
            amps.append(self.ensemble.gain * float(self.drive.at(np.array([instant]))[0]))
        rigs = np.tile(np.arange(corners, dtype=np.int64), len(instants))
        return State(np.concatenate(nodes), np.concatenate(sinks)), np.concatenate(amps), rigs

    def _safe_after(self, state: State, amps: Array, rigs: Index, hang_s: float) -> bool:
        times = np.array([0.0, *np.arange(0.1, hang_s, 0.1), hang_s])
        _, then = _constant(self.ensemble, amps, state, np.unique(times), rigs)
        values, _ = _constant(self.ensemble, np.zeros_like(amps), then, AFTER_ROWS_S, rigs)
        return not bool(_passed(self.limits, values)[1].any())

    def rest_before(self) -> tuple[float | None, SingleFault]:
        """For how long in s rest must be held on a display that was without power, before the first play."""
        cold = self.ensemble.at_rest(0.0)

        def tally_after(rest_s: float) -> Tally:
            state = cold
            if rest_s > 0:
                state = self.ensemble.rest(self.rest_A, cold, rest_s)
            tally = Tally(self.limits, self.ensemble.corners)
            for (rows, values), _ in self.ensemble.play(self.drive, state):
                tally.add(rows, values)
            return tally

        at_once = tally_after(0.0)
        findings = findings_of(at_once.checks())
        text = "; ".join(str(check) for check in findings[:1]) or "no limit is passed"
        rest: float | None = 0.0
        if not at_once.passes():
            low, high = 0, int(LONGEST_REST_S)
            while high - low > 1:
                middle = (low + high) // 2
                low, high = (low, middle) if tally_after(float(middle)).passes() else (middle, high)
            rest = float(high) if tally_after(float(high)).passes() else None
        prevented = "nothing need be" if rest == 0.0 else "nothing up to 10 min of rest; warm up another way"
        if rest:
            prevented = f"holding the rest for {rest:g} s before the first play, without contact or with"
        colour = colour_of(findings)
        return rest, SingleFault("first play on a display that was without power", colour, text, prevented)

    def polarity(self) -> tuple[PolarityCheck, SingleFault]:
        """The effect of swapped poles, and the wiring check that detects them."""
        swapped = Drive(self.drive.time_s, -self.drive.current_A, self.drive.held)
        tally = Tally(self.limits, self.ensemble.corners, ", poles swapped")
        low, high = np.inf, -np.inf
        for (rows, values), _ in self.ensemble.play(swapped, self.ensemble.at_rest(0.0)):
            tally.add(rows, values)
            skin = np.nan_to_num(values[WATCHED.index("skin_C")], nan=999.0)
            low, high = min(low, float(skin.min())), max(high, float(skin.max()))
        test_A = min(TEST_A, self.ensemble.rig.driver.current_max_A)
        values, _ = self.ensemble.hold(test_A, self.ensemble.at_rest(0.0), np.array([0.0, TEST_S]))
        display = values[WATCHED.index("display_C")]
        fall = float((display[:, 0] - display[:, -1]).min())
        needed = not tally.passes()
        check = PolarityCheck(needed, round(test_A, 3), TEST_S, round(0.5 * fall, 2), (round(low, 1), round(high, 1)))
        text = f"skin {signed(low, '.1f')} … {signed(high, '.1f')} °C"
        prevented = (
            f"{signed(test_A, '.3g')} A for {TEST_S:g} s before the first play: the display must cool by "
            f"{check.display_change_at_least_K:g} K or more"
        )
        return check, SingleFault("poles swapped", colour_of(findings_of(tally.checks())), text, prevented)

    def cut_off(self, display_C: tuple[float, float]) -> tuple[CutOff, SingleFault]:
        """The cut-off around the display temperatures reached without a fault, and its reaction time with the driver
        at its limit.
        """
        limit = {rule.upper: rule.limit for rule in self.limits.rules if _is_hard_display(rule)}
        low, high = max(limit[False], display_C[0] - BEYOND_K), min(limit[True], display_C[1] + BEYOND_K)
        driver = self.ensemble.rig.driver
        least, most = driver.current_min_A, driver.current_max_A
        if self.ensemble.bridge_A is not None:
            least, most = -self.ensemble.bridge_A, self.ensemble.bridge_A
        slowest, harms = REACTIONS_S[0], []
        for full in (least, most):
            reaction, values = self._stuck(full, low, high)
            slowest = min(slowest, reaction)
            text, beyond = _passed(self.limits, values)
            if beyond.any():
                harms.append(f"{text} at {signed(full, '.3g')} A")
        worst, colour = " and ".join(harms) or "no limit is passed", "red" if harms else "green"
        cut = CutOff(round(low, 1), round(high, 1), slowest)
        prevented = f"a cut-off at {cut.low:g} and {cut.high:g} °C on the measured display, within {slowest:g} s"
        if slowest == 0.0:
            prevented = self._limit_instead(low, high)
        return cut, SingleFault("driver stuck at its limit", colour, worst, prevented)

    def _limit_instead(self, low: float, high: float) -> str:
        """What prevents harm where no cut-off is quick enough: a smaller current limit that still plays the drive."""
        driver, peak = self.ensemble.rig.driver, float(np.abs(self.drive.current_A).max())
        full = max(driver.current_max_A, -driver.current_min_A)
        for most in np.linspace(full, peak, LIMITS_TRIED)[1:].tolist():
            shares = (driver.current_min_A / full, driver.current_max_A / full)
            if all(self._stuck(share * most, low, high)[0] > 0 for share in shares if share):
                prevented = f"a current limit of {most:.2g} A in the driver's hardware"
                return f"{prevented}; no cut-off is quick enough at {full:g} A"
        return (
            "a smaller or shorter drive: no cut-off is quick enough, and no current limit that still plays this one "
            "is low enough"
        )

    def _stuck(self, current_A: float, low: float, high: float) -> tuple[float, Array]:
        """The longest safe reaction of a cut-off in s with the driver stuck at a current, and WATCHED until then."""
        amps = current_A * self.ensemble.gain
        values, _ = _constant(self.ensemble, amps, self.start, HANG_ROWS_S, self.ensemble.lanes)
        return self._reaction_s(amps, values[WATCHED.index("display_C")], low, high), values

    def _reaction_s(self, amps: Array, display: Array, low: float, high: float) -> float:
        """The longest reaction time of a cut-off that is safe for given courses of the display (lanes, rows)."""
        out = ~((display > low) & (display < high))
        trips = [float(HANG_ROWS_S[int(row.argmax())]) if row.any() else HANG_S for row in out]
        for reaction in REACTIONS_S:
            if all(self._safe_after_lane(lane, amps, trip + reaction) for lane, trip in enumerate(trips)):
                return reaction
        return 0.0

    def _safe_after_lane(self, lane: int, amps: Array, time_s: float) -> bool:
        lanes = np.array([lane], dtype=np.int64)
        return self._safe_after(self.start.take(lanes), amps[lanes], lanes, time_s)


def _constant(ensemble: Ensemble, amps: Array, state: State, times_s: Array, rigs: Index) -> tuple[Array, State]:
    """Hold a current (lanes,) in every lane, gain included; WATCHED at times from now, and the last states."""
    rows = len(times_s) - 1
    bridge = None if ensemble.bridge_A is None else ensemble.bridge_A * ensemble.gain[rigs]
    start, end = held_currents(amps, rows, bridge)
    intervals = Intervals(times_s, np.arange(rows + 1), start, end)
    lanes = np.arange(len(rigs), dtype=np.int64)
    return run_on(ensemble.bank, rigs, lanes, intervals, state, WATCHED)


def _passed(limits: Limits, values: Array) -> tuple[str, Array]:
    """By how much hard temperature limits are exceeded, in words, and whether each lane exceeds any at each row."""
    beyond = np.zeros(values.shape[1:], dtype=bool)
    worst, text = -np.inf, "no limit is passed"
    columns = {"skin surface": "skin_C", "display": "display_C", "cold-receptor depth": "cold_receptor_C"}
    for rule in limits.rules:
        if rule.severity != "hard" or rule.relative or rule.quantity not in columns or rule.above_C is not None:
            continue
        column = np.nan_to_num(values[WATCHED.index(columns[rule.quantity])], nan=999.0)
        over = column - rule.limit if rule.upper else rule.limit - column
        beyond |= over > 0
        if over.max() > max(worst, 0.0):
            worst = float(over.max())
            reached = float(column.max() if rule.upper else column.min())
            text = f"{rule.quantity} reaches {signed(reached, '.1f')} °C"
    return text, beyond


def _is_hard_display(rule: Rule) -> bool:
    return rule.quantity == "display" and rule.severity == "hard" and rule.above_C is None


def _colour(beyond: Array) -> str:
    return "red" if beyond.any() else "green"
