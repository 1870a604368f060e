"""Checks of a module under every control loop that may play it.

The skin moves fastest where a loop swings from one cut-off to the other at its current limits. Every temperature of
skin lies between those of a display held at either cut-off for as long as the second one allows, since more heat in
means warmer everywhere; from there the driver gets stuck at its limit until the cut-off on a second sensor acts. The
hot plate gets hottest on the way from the upper cut-off to the lower. A loop may also run to its limit from a start
that is too warm, and stay there, where more current cools less. The worst swing was searched for, not proven; a margin
covers this.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.base.words.number_text import signed

from ..safety.checks import Before, Check, Scenario, worst_of
from ..safety.demands import CutOff, SingleFault
from ..safety.ensemble import LaneDrives
from ..safety.fault_limits import FaultLimits
from ..safety.held import BEYOND_K, SENSOR_K, Span, Stages
from ..safety.single_faults import AFTER_ROWS_S, HANG_ROWS_S
from ..safety.stuck_rate import RATE
from ..safety.tally import HOTTEST_C, WATCHED, Tally
from ..solver.batch_inputs import Bank, State, run_follow
from ..solver.inverse import regulated
from ..solver.modes import modes_of
from ..solver.network import COLD, COMPLIANCE_V, HIGHEST_A, LOWEST_A, SKIN
from ..solver.steady import state_under_current
from .delivered_drive import loss_limit
from .samples import Samples
from .temperatures import FollowingModule, rest_of_a_loop, updates_of

SWINGS_S = (3.0, 3.0, 1.0, 1.0, 0.3, 0.3, 0.1, 0.1)
"""For how long a loop swings to the lower, then to the upper cut-off, and so on: it arrives, stays, or turns before."""
STUCK_S = 3.0
"""Within which a current at its limit moves the skin fastest: by then the cut-off of the other side has acted."""
ROOM = 0.97
"""Share of a limit that the worst of these swings may reach."""
STEP_A, TRIES = 0.01, 12
"""Current limits are sought in such steps, and so often."""
HEATS = 1.1
"""Factor by which an upper current limit comes down that heats too much."""
ANY_V = 1e4
"""A supply that holds no current back."""
BEYONDS_K = (1.0, 0.5)
"""How far beyond what the display reaches a cut-off may be: more than its sensor may be wrong."""
REACTIONS_S = (0.2, 0.1, 0.05, 0.02)
"""Reactions of cut-offs that are tried, the slowest first, with the sensor's own lag."""
WARMER = "what it reaches without a fault: a loop does not know that more current than its module's best cools less"

Limits_A = Span


@dataclass(frozen=True, slots=True, eq=False)
class AnyLoop:
    """A module in its corners, under loops that send any current within limits."""

    module: FollowingModule
    bank: Bank

    def within(self, limits_A: Limits_A) -> Bank:
        """The corners with current limits as commanded, and a supply of any voltage."""
        plates, gain = self.bank.plates.copy(), self.module.ensemble.gain
        plates[:, LOWEST_A], plates[:, HIGHEST_A], plates[:, COMPLIANCE_V] = *np.outer(limits_A, gain), ANY_V
        return replace(self.bank, plates=plates)

    def limits_A(self, cut: CutOff, plays: Sequence[Samples]) -> tuple[Limits_A, tuple[Check, ...]]:
        """The widest current limits at which no loop moves skin too fast, or the driver's where needed, and checks.

        They are alike for both signs where the set-points need no more, so that swapped poles are no faster.
        """
        driver = self.module.ensemble.rig.driver
        given = driver.current_min_A, driver.current_max_A
        slow, checks = self.slowed(cut, given)
        alike_A = min(-slow[0], slow[1])
        shown_C = [self._shown_C(play, given) for play in plays]
        for limits_A in dict.fromkeys([(-alike_A, alike_A), slow]):
            if self.suffices(limits_A, plays, shown_C):
                return limits_A, checks
        cure = f", as its set-points need; a driver.current_limit_A of {alike_A:g} A slows them"
        return given, tuple(
            replace(check, run=replace(check.run, way=f"{check.run.way}{cure}"))
            for check in self.checks(cut, self.ends(cut), given)
        )

    def slowed(self, cut: CutOff, given: Limits_A) -> tuple[Limits_A, tuple[Check, ...]]:
        """Current limits that come down from others until no loop passes a limit, as far as tried, and the checks."""
        ends, limits_A = self.ends(cut), given
        checks = self.checks(cut, ends, limits_A)
        for _ in range(TRIES):
            below, above = too_wide(checks)
            if max(below, above) <= 1.0:
                break
            limits_A = -_whole_A(-limits_A[0] / max(1.0, below)), _whole_A(limits_A[1] / max(1.0, above))
            checks = self.checks(cut, ends, limits_A)
        return limits_A, checks

    def suffices(self, limits_A: Limits_A, plays: Sequence[Samples], shown_C: Sequence[Array]) -> bool:
        """Whether set-points are followed as well within limits as they are `shown_C` within the driver's own."""
        loss_K = loss_limit("receptor difference")
        for play, as_given_C in zip(plays, shown_C, strict=True):
            slower_K = self._shown_C(play, limits_A) - as_given_C
            if float(np.sqrt(np.mean(slower_K**2))) > loss_K:
                return False
        return True

    def _shown_C(self, play: Samples, limits_A: Limits_A) -> Array:
        """The display of the rig as given that its loop takes along set-points within current limits."""
        rig = self.module.rigs[0]
        rest, goals = rest_of_a_loop(rig, float(play.command[0])), updates_of(play, 1.0 / rig.driver.update_Hz)
        return regulated(rig, self.within(limits_A), goals, rest)[1]

    def checks(self, cut: CutOff, ends: tuple[State, State], limits_A: Limits_A) -> tuple[Check, ...]:
        """What any loop within current limits leads to: rates of skin, the hot plate, and where a display stays.

        `ends` are those of the cut-off, which are the same for all limits.
        """
        rates, hot_plate = self.rates(cut, ends, limits_A), self._hot_plate(cut, ends, limits_A[1])
        return (*rates, *hot_plate, self._for_good(cut, limits_A[1]))

    def rates(self, cut: CutOff, ends: tuple[State, State], limits_A: Limits_A) -> tuple[Check, ...]:
        """Rates of skin under a loop that swings between the cut-offs, or goes from one to a limit and stays there."""
        ensemble = self.module.ensemble
        way = f"under any loop of {limits_A[0]:g} … {limits_A[1]:g} A".replace("-", "−")
        runs = [(self._swinging(cut, limits_A), ensemble.at_rest(0.0))]
        for end, limit_A in zip(ends, limits_A, strict=True):
            stuck: Array = np.linspace(0.0, STUCK_S, 2)
            runs.append((LaneDrives(stuck, np.full((len(ensemble.lanes), 2), limit_A)), end))
        judged = []
        for drives, begun in runs:
            tally = Tally(ensemble.rig.limits, ensemble.corners, Scenario(way=way))
            for (rows, values), _ in ensemble.play(drives, begun):
                tally.add(rows, values, sums=False)
            judged.append(tally.checks())
        return tuple(check for check in worst_of(judged) if check.quantity == RATE)

    def _swinging(self, cut: CutOff, limits_A: Limits_A) -> LaneDrives:
        """The fastest currents from no power to the lower cut-off, then to the upper, and so on."""
        ensemble = self.module.ensemble
        lanes, period_s = ensemble.lanes, 1.0 / ensemble.rig.driver.update_Hz
        counts = [max(1, round(swing_s / period_s)) for swing_s in SWINGS_S]
        levels = [level for level, _ in zip(itertools.cycle((cut.low, cut.high)), counts, strict=False)]
        goals = np.repeat(levels, counts)[np.newaxis]
        flows_A, _, _ = run_follow(
            self.within(limits_A), lanes, np.zeros_like(lanes), period_s, goals, False, ensemble.at_rest(0.0).nodes_C
        )
        currents_A: Array = np.append(flows_A, flows_A[:, -1:], axis=1)
        times_s: Array = np.arange(currents_A.shape[1], dtype=np.float64) * period_s
        return LaneDrives(times_s, currents_A / ensemble.gain[:, np.newaxis])

    def swapped(self, cut: CutOff, limits_A: Limits_A) -> tuple[SingleFault, ...]:
        """The fault of wires that are swapped in mid-play, where limits are not alike and the skin is then too fast."""
        turned_A = -limits_A[1], -limits_A[0]
        if turned_A == limits_A:
            return ()
        rates = self.rates(cut, self.ends(cut), turned_A)
        told = {"rate": max(abs(check.value) for check in rates), "kept": False, "limit_A": limits_A}
        return () if all(check.passed for check in rates) else (SingleFault("swapped fast", "red", told),)

    def _hot_plate(self, cut: CutOff, ends: tuple[State, State], limit_A: float) -> tuple[Check, ...]:
        """The hot plate of a driver stuck at its limit until the lower cut-off has acted.

        It begins with every node as warm as in any display inside the cut-offs.
        """
        ensemble, (cold, warm) = self.module.ensemble, ends
        warmest = replace(warm, nodes_C=np.maximum(cold.nodes_C, warm.nodes_C))
        values, _ = ensemble.hold(limit_A, warmest, HANG_ROWS_S)
        out = values[WATCHED.index("display_C")] < cut.low - SENSOR_K
        acted_s = np.where(out.any(axis=1), HANG_ROWS_S[out.argmax(axis=1)] + REACTIONS_S[0], np.inf)
        way = f"display at the upper cut-off, then {signed(limit_A, 'g')} A until the lower has acted"
        tally = Tally(ensemble.rig.limits, ensemble.corners, Scenario(way=way, before=Before("any")))
        until = np.where(acted_s[:, np.newaxis] >= HANG_ROWS_S, values, values[:, :, :1])
        tally.add(HANG_ROWS_S, until, rates=False, sums=False)
        return tuple(check for check in tally.checks() if check.quantity == "hot plate")

    def _for_good(self, cut: CutOff, limit_A: float) -> Check:
        """Where a loop that stays at its limit takes the display, against what is reached without a fault."""
        ensemble, display_C = self.module.ensemble, []
        for network, gain in zip(ensemble.networks, ensemble.gain, strict=True):
            try:
                display_C.append(float(state_under_current(network, limit_A * gain)[COLD]))
            except ArithmeticError:  # it heats without limit
                display_C.append(HOTTEST_C)
        most_C, reach_C = max(display_C), cut.high - BEYOND_K
        hottest = ensemble.corners[display_C.index(most_C)]
        return Check(
            "display of a loop at its limit", "hard", most_C, reach_C, "°C", math.nan,
            math.nan if most_C > reach_C else None, WARMER,
            run=Scenario(hottest.deviations, f"{signed(limit_A, 'g')} A for good"),
        )  # fmt: skip

    def cut_off(
        self, every: Sequence[Stages], limits_A: Limits_A, used_A: Limits_A, may: FaultLimits
    ) -> tuple[CutOff, Stages, Limits_A, tuple[Check, ...]]:
        """The slowest cut-off, of several, that holds every temperature; current limits may come down half-way to what
        is used.
        """
        begun = [self.stayed(stages) for stages in every]
        narrow_A = narrowed_A(limits_A, used_A)
        for reaction_s in REACTIONS_S:
            for stages, states in zip(every, begun, strict=True):
                for within_A in (limits_A, narrow_A):
                    checks = self.stuck(states, within_A, reaction_s, may)
                    if all(check.passed for check in checks):
                        return CutOff(*stages.ends_C, reaction_s), stages, within_A, checks
        return CutOff(*stages.ends_C, 0.0), stages, within_A, checks  # the nearest is not quick enough either

    def ends(self, cut: CutOff) -> tuple[State, State]:
        """Each corner whose display has been at the lower, or the upper, cut-off for good."""
        return self.stayed(Stages((cut.low, cut.high), (cut.low, cut.high), (cut.low, cut.high)))

    def stayed(self, stages: Stages) -> tuple[State, State]:
        """Each corner whose display a fault has held at the lower, or the upper, cut-off for as long as that allows."""
        states = []
        for end_C, lasting_C, wrong_K in zip(stages.ends_C, stages.lasting, (-SENSOR_K, SENSOR_K), strict=True):
            level_C, nodes_C = end_C + wrong_K, []
            for rig in self.module.rigs:
                nodes = rest_of_a_loop(rig, level_C)[1].copy()
                if stages.brief_s is not None:
                    skin = modes_of(rig)
                    after = skin.after(stages.brief_s, level_C, skin.steady(lasting_C + wrong_K))
                    nodes[SKIN : SKIN + len(after)] = skin.deep_C + skin.lumps @ after
                nodes_C.append(nodes)
            states.append(State(self.bank.states(nodes_C)))
        return states[0], states[1]

    def stuck(
        self, begun: Sequence[State], limits_A: Limits_A, reaction_s: float, may: FaultLimits
    ) -> tuple[Check, ...]:
        """The limits of a fault with a driver at its limit from either state, and without current afterwards.

        Wires that are swapped in mid-play turn the limit of the other sign into one of this sign.
        """
        ensemble, judged, most_A = self.module.ensemble, [], max(-limits_A[0], limits_A[1])
        for state, current_A in zip(begun, (most_A, -most_A), strict=True):
            what = f"display at the cut-off, then {signed(current_A, 'g')} A for {reaction_s:g} s"
            tally = Tally(may.limits, ensemble.corners, Scenario(way=what, before=Before("any")))
            rows: Array = np.linspace(0.0, reaction_s, 5)
            for start_s, amperes, times in ((0.0, current_A, rows), (reaction_s, 0.0, AFTER_ROWS_S)):
                values, state = ensemble.hold(amperes, state, times)
                tally.add(start_s + times, values, rates=False)
            judged.append(tally.checks())
        return worst_of(judged)


def too_wide(checks: Sequence[Check]) -> tuple[float, float]:
    """By what factors the lower and the upper current limit are too wide for checks; where at most 1, they are not."""
    share = {(check.quantity, check.upper): check.value / check.limit / ROOM for check in checks}
    heats = any(check.unit == "°C" and not check.passed for check in checks)
    return share[RATE, True], max(share[RATE, False], HEATS if heats else 0.0)


def narrowed_A(limits_A: Limits_A, used_A: Limits_A) -> Limits_A:
    """Current limits half-way between others and what is used."""
    half = [0.5 * (limit + used) for limit, used in zip(limits_A, used_A, strict=True)]
    return -_whole_A(-max(limits_A[0], half[0])), _whole_A(min(limits_A[1], half[1]))


def _whole_A(limit_A: float) -> float:
    return round(STEP_A * math.floor(limit_A / STEP_A + 1e-9), 2)
