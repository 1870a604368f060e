"""Bounds for every control loop around a module, whatever its gains, lag, delay or supply.

The skin moves fastest where a loop swings from one cut-off to the other at its current limits. Every temperature of
skin lies between those of a display held at either cut-off indefinitely, since more heat in means warmer everywhere;
from there the driver gets stuck at its limit until the cut-off on a second sensor acts. The hot plate gets hottest on
the way from the upper cut-off to the lower. A loop may also run to its limit from a start that is too warm, and stay
there, where more current cools less. The worst swing was searched for, not proven; a margin covers this.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.icons.number_text import signed

from ..arrays import Array
from ..safety.checks import Before, Check, Scenario, worst_of
from ..safety.demands import CutOff
from ..safety.ensemble import LaneDrives
from ..safety.held import BEYOND_K, inwards
from ..safety.single_faults import AFTER_ROWS_S, HANG_ROWS_S
from ..safety.tally import HOTTEST_C, WATCHED, Tally
from ..solver.batch_inputs import Bank, State, run_follow
from ..solver.inverse import regulated
from ..solver.network import COLD, COMPLIANCE_V, HIGHEST_A, LOWEST_A
from ..solver.steady import state_under_current
from .delivered_drive import loss_limit
from .samples import Samples
from .temperatures import FollowingModule, rest_of_a_loop, updates_of

SENSOR_K = 0.3
"""Greatest offset of the sensors of loop and cut-off: what interchangeable thermistors promise (±0.2 K), and glue."""
SWINGS_S = (3.0, 3.0, 1.0, 1.0, 0.3, 0.3, 0.1, 0.1)
"""For how long a loop swings to the lower, then to the upper cut-off, and so on: it arrives, stays, or turns before."""
ROOM = 0.97
"""Share of a limit that the worst of these swings may reach."""
STEP_A, TRIES = 0.01, 12
"""Current limits are sought in such steps, and so often."""
ANY_V = 1e4
"""A supply that holds no current back."""
BEYONDS_K = ((1.0, 1.0), (1.0, 0.5), (0.5, 0.5))
"""How far below and above what the display reaches a cut-off may be: more than its sensor may be wrong."""
REACTIONS_S = (0.2, 0.1, 0.05, 0.02)
"""Reactions of cut-offs that are tried, the slowest first, with the sensor's own lag."""
WARMER = "what it reaches without a fault: a loop does not know that more current than its module's best cools less"

Limits_A = tuple[float, float]


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
        """The widest current limits at which no loop moves skin too fast, or the driver's where needed, and checks."""
        driver = self.module.ensemble.rig.driver
        given = limits = driver.current_min_A, driver.current_max_A
        cold, warm = (self._held_at(level) for level in (cut.low - SENSOR_K, cut.high + SENSOR_K))
        warm = replace(warm, nodes_C=np.maximum(cold.nodes_C, warm.nodes_C))
        checks = wide = (*self._swings(cut, given), *self._at_limit(cut, warm, given[1]))
        for _ in range(TRIES):
            share = {(check.quantity, check.upper): check.value / check.limit / ROOM for check in checks}
            warming, cooling = share["rate of skin temperature", True], share["rate of skin temperature", False]
            hot = 1.1 if any(check.unit == "°C" and not check.passed for check in checks) else 0.0
            if max(warming, cooling, hot) <= 1.0:
                break
            limits = -_whole_A(-limits[0] / max(1.0, warming)), _whole_A(limits[1] / max(1.0, cooling, hot))
            checks = (*self._swings(cut, limits), *self._at_limit(cut, warm, limits[1]))
        slower_K = max(
            float(np.sqrt(np.mean((self._shown(one, limits) - self._shown(one, given)) ** 2))) for one in plays
        )
        if slower_K <= loss_limit("receptor difference"):
            return limits, checks
        cure = f", as its set-points need; a driver.current_limit_A of {min(-limits[0], limits[1]):g} A slows them"
        return given, tuple(replace(check, run=replace(check.run, way=f"{check.run.way}{cure}")) for check in wide)

    def _shown(self, play: Samples, limits_A: Limits_A) -> Array:
        """The display of the rig as given that its loop takes along set-points within current limits."""
        rig = self.module.rigs[0]
        rest, goals = rest_of_a_loop(rig, float(play.command[0])), updates_of(play, 1.0 / rig.driver.update_Hz)
        return regulated(rig, self.within(limits_A), goals, rest)[1]

    def _swings(self, cut: CutOff, limits_A: Limits_A) -> tuple[Check, ...]:
        """Rates where a loop swings between the cut-offs, from a display without power on."""
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
        drives = LaneDrives(times, currents / ensemble.gain[:, np.newaxis])
        what = Scenario(way=f"under any loop of {limits_A[0]:g} … {limits_A[1]:g} A".replace("-", "−"))
        tally = Tally(ensemble.rig.limits, ensemble.corners, what)
        for (rows, values), _ in ensemble.play(drives, start):
            tally.add(rows, values, sums=False)
        return tuple(check for check in tally.checks() if check.quantity == "rate of skin temperature")

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
        self, reach_C: tuple[float, float], limits_A: Limits_A, used_A: Limits_A
    ) -> tuple[CutOff, Limits_A, tuple[Check, ...]]:
        """The slowest cut-off around what the display reaches that holds every temperature; current limits may come
        down half-way to what is used.
        """
        hard = [rule for rule in self.module.ensemble.rig.limits.rules if rule.severity == "hard"]
        ends = {rule.upper: rule.limit for rule in hard if rule.quantity == "display" and rule.above_C is None}
        half = [0.5 * (limit + used) for limit, used in zip(limits_A, used_A, strict=True)]
        narrow_A = -_whole_A(-max(limits_A[0], half[0])), _whole_A(min(limits_A[1], half[1]))
        edges = [
            (max(ends[False], reach_C[0] - below), min(ends[True], reach_C[1] + above)) for below, above in BEYONDS_K
        ]
        begun = {edge: [self._held_at(level) for level in (edge[0] - SENSOR_K, edge[1] + SENSOR_K)] for edge in edges}
        for reaction, edge, within_A in itertools.product(REACTIONS_S, edges, (limits_A, narrow_A)):
            checks = self._stuck(begun[edge], within_A, reaction)
            if all(check.passed for check in checks):
                return CutOff(*inwards(*edge), reaction), within_A, checks
        return CutOff(*inwards(*edge), 0.0), within_A, checks

    def _held_at(self, level_C: float) -> State:
        """Each corner with its display held at a level indefinitely, or as near to it as the module can."""
        return State.settled(self.bank.states([rest_of_a_loop(rig, level_C)[1] for rig in self.module.rigs]))

    def _stuck(self, begun: Sequence[State], limits_A: Limits_A, reaction_s: float) -> tuple[Check, ...]:
        """Hard rules of temperature with a driver at its limit from either state, and without current afterwards."""
        ensemble, judged = self.module.ensemble, []
        for state, current_A in zip(begun, (limits_A[1], limits_A[0]), strict=True):
            what = f"display at the cut-off, then {signed(current_A, 'g')} A for {reaction_s:g} s"
            tally = Tally(ensemble.rig.limits, ensemble.corners, Scenario(way=what, before=Before("any")))
            rows: Array = np.linspace(0.0, reaction_s, 5)
            for start_s, amperes, times in ((0.0, current_A, rows), (reaction_s, 0.0, AFTER_ROWS_S)):
                values, state = ensemble.hold(amperes, state, times)
                tally.add(start_s + times, values, rates=False, sums=False)
            judged.append(tally.checks())
        return tuple(check for check in worst_of(judged) if check.severity == "hard" and check.unit == "°C")


def _whole_A(limit_A: float) -> float:
    return round(STEP_A * math.floor(limit_A / STEP_A + 1e-9), 2)
