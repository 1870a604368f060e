"""Bounds for every control loop around a module.

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
STUCK_S = 1.0
"""Within which a current at its limit moves the skin fastest: heat passes a contact and the stratum corneum sooner."""
ROOM = 0.97
"""Share of a limit that the worst of these swings may reach."""
STEP_A, TRIES = 0.01, 12
"""Current limits are sought in such steps, and so often."""
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
        given = limits = driver.current_min_A, driver.current_max_A
        ends = self.ends(cut)
        warm = replace(ends[1], nodes_C=np.maximum(ends[0].nodes_C, ends[1].nodes_C))
        checks = wide = (*self._rates(cut, ends, given), *self._at_limit(cut, warm, given[1]))
        for _ in range(TRIES):
            share = {(check.quantity, check.upper): check.value / check.limit / ROOM for check in checks}
            warming, cooling = share["rate of skin temperature", True], share["rate of skin temperature", False]
            hot = 1.1 if any(check.unit == "°C" and not check.passed for check in checks) else 0.0
            if max(warming, cooling, hot) <= 1.0:
                break
            limits = -_whole_A(-limits[0] / max(1.0, warming)), _whole_A(limits[1] / max(1.0, cooling, hot))
            checks = (*self._rates(cut, ends, limits), *self._at_limit(cut, warm, limits[1]))
        alike_A = min(-limits[0], limits[1])
        shown = [self._shown(play, given) for play in plays]
        if alike_A < max(-limits[0], limits[1]) and self._suffices((-alike_A, alike_A), plays, shown):
            return (-alike_A, alike_A), checks
        if self._suffices(limits, plays, shown):
            return limits, checks
        cure = f", as its set-points need; a driver.current_limit_A of {min(-limits[0], limits[1]):g} A slows them"
        return given, tuple(replace(check, run=replace(check.run, way=f"{check.run.way}{cure}")) for check in wide)

    def _suffices(self, limits_A: Limits_A, plays: Sequence[Samples], shown: Sequence[Array]) -> bool:
        """Whether set-points are followed as well within limits as they are `shown` within the driver's own."""
        loss_K = loss_limit("receptor difference")
        for play, as_given in zip(plays, shown, strict=True):
            slower_K = self._shown(play, limits_A) - as_given
            if float(np.sqrt(np.mean(slower_K**2))) > loss_K:
                return False
        return True

    def _shown(self, play: Samples, limits_A: Limits_A) -> Array:
        """The display of the rig as given that its loop takes along set-points within current limits."""
        rig = self.module.rigs[0]
        rest, goals = rest_of_a_loop(rig, float(play.command[0])), updates_of(play, 1.0 / rig.driver.update_Hz)
        return regulated(rig, self.within(limits_A), goals, rest)[1]

    def _rates(self, cut: CutOff, ends: Sequence[State], limits_A: Limits_A) -> tuple[Check, ...]:
        """Rates where a loop swings between the cut-offs, from a display without power on; and where it goes to a limit
        at once and stays there, from the cut-off of the other side.
        """
        ensemble = self.module.ensemble
        period = 1.0 / ensemble.rig.driver.update_Hz
        counts = [max(1, round(swing / period)) for swing in SWINGS_S]
        levels = [level for level, _ in zip(itertools.cycle((cut.low, cut.high)), counts, strict=False)]
        goals, start = np.repeat(levels, counts)[np.newaxis], ensemble.at_rest(0.0)
        lanes = ensemble.lanes
        flows, _, _ = run_follow(
            self.within(limits_A), lanes, np.zeros_like(lanes), period, goals, False, start.nodes_C
        )
        currents: Array = np.append(flows, flows[:, -1:], axis=1)
        times: Array = np.arange(currents.shape[1], dtype=np.float64) * period
        runs = [(LaneDrives(times, currents / ensemble.gain[:, np.newaxis]), start)]
        stuck: Array = np.linspace(0.0, STUCK_S, 2)
        for end, limit_A in zip(ends, limits_A, strict=True):
            runs.append((LaneDrives(stuck, np.full((len(lanes), 2), limit_A)), end))
        what = Scenario(way=f"under any loop of {limits_A[0]:g} … {limits_A[1]:g} A".replace("-", "−"))
        judged = []
        for drives, begun in runs:
            tally = Tally(ensemble.rig.limits, ensemble.corners, what)
            for (rows, values), _ in ensemble.play(drives, begun):
                tally.add(rows, values, sums=False)
            judged.append(tally.checks())
        return tuple(check for check in worst_of(judged) if check.quantity == "rate of skin temperature")

    def swapped(self, cut: CutOff, limits_A: Limits_A) -> tuple[SingleFault, ...]:
        """The fault of wires that are swapped in mid-play, where limits are not alike and the skin is then too fast."""
        turned_A = -limits_A[1], -limits_A[0]
        if turned_A == limits_A:
            return ()
        rates = self._rates(cut, self.ends(cut), turned_A)
        told = {"rate": max(abs(check.value) for check in rates), "kept": False, "limit_A": limits_A}
        return () if all(check.passed for check in rates) else (SingleFault("swapped fast", "red", told),)

    def _at_limit(self, cut: CutOff, warm: State, limit_A: float) -> tuple[Check, ...]:
        """The hot plate of a driver stuck at its limit, from nodes as `warm` as in any display inside the cut-offs;
        and where a loop that stays there for good takes the display.
        """
        ensemble, amperes = self.module.ensemble, signed(limit_A, "g")
        values, _ = ensemble.hold(limit_A, warm, HANG_ROWS_S)
        out = values[WATCHED.index("display_C")] < cut.low - SENSOR_K
        acted_s = np.where(out.any(axis=1), HANG_ROWS_S[out.argmax(axis=1)] + REACTIONS_S[0], np.inf)
        what = f"display at the upper cut-off, then {amperes} A until the lower has acted"
        tally = Tally(ensemble.rig.limits, ensemble.corners, Scenario(way=what, before=Before("any")))
        until = np.where(acted_s[:, np.newaxis] >= HANG_ROWS_S, values, values[:, :, :1])
        tally.add(HANG_ROWS_S, until, rates=False, sums=False)
        shown_C = []
        for network, gain in zip(ensemble.networks, ensemble.gain, strict=True):
            try:
                shown_C.append(float(state_under_current(network, limit_A * gain)[COLD]))
            except ArithmeticError:  # it heats without limit
                shown_C.append(HOTTEST_C)
        most_C, reach_C = max(shown_C), cut.high - BEYOND_K
        stays = Check(
            "display of a loop at its limit", "hard", most_C, reach_C, "°C", math.nan,
            math.nan if most_C > reach_C else None, WARMER,
            run=Scenario(ensemble.corners[shown_C.index(most_C)].deviations, f"{amperes} A for good"),
        )  # fmt: skip
        return (*(check for check in tally.checks() if check.quantity == "hot plate"), stays)

    def cut_off(
        self, every: Sequence[Stages], limits_A: Limits_A, used_A: Limits_A, may: FaultLimits
    ) -> tuple[CutOff, Stages, Limits_A, tuple[Check, ...]]:
        """The slowest cut-off, of several, that holds every temperature; current limits may come down half-way to what
        is used.
        """
        narrow_A = narrowed_A(limits_A, used_A)
        begun = [self.stayed(stages) for stages in every]
        for reaction, number, within_A in itertools.product(REACTIONS_S, range(len(every)), (limits_A, narrow_A)):
            checks = self._stuck(begun[number], within_A, reaction, may)
            if all(check.passed for check in checks):
                return CutOff(*every[number].ends_C, reaction), every[number], within_A, checks
        return CutOff(*every[-1].ends_C, 0.0), every[-1], within_A, checks

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
            states.append(State.settled(self.bank.states(nodes_C)))
        return states[0], states[1]

    def _stuck(
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


def narrowed_A(limits_A: Limits_A, used_A: Limits_A) -> Limits_A:
    """Current limits half-way between others and what is used."""
    half = [0.5 * (limit + used) for limit, used in zip(limits_A, used_A, strict=True)]
    return -_whole_A(-max(limits_A[0], half[0])), _whole_A(min(limits_A[1], half[1]))


def _whole_A(limit_A: float) -> float:
    return round(STEP_A * math.floor(limit_A / STEP_A + 1e-9), 2)
