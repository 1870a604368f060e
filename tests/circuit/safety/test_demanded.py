"""Each step of the search for a pause and for demands, on the independent circuit: as it answers, and a step beyond."""

import json
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from tests.circuit.delivery.benches import Bench
from tests.circuit.delivery.independent import Array, Circuit, worlds_of
from tests.circuit.delivery.lanes import DOSE, LONGEST, NEVER, Lanes, joined
from tests.circuit.delivery.replay import Held
from tests.circuit.safety.test_single_faults import SLOW
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Drive, Rig
from thermicon.circuit.safety.current import CurrentPlant, CurrentPlay
from thermicon.circuit.safety.demanded import Search
from thermicon.circuit.safety.demands import CutOff
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.safety.held import LEAST_BEYOND_K, SENSOR_K
from thermicon.circuit.safety.plant import Single
from thermicon.circuit.safety.repeated import Repeating, shortest_pause_s
from thermicon.circuit.safety.single_faults import HANGS_S, REACTIONS_S
from thermicon.circuit.safety.starts import Starts

REST, PLAYS = 0.08, 20
PRACTICAL_S, LATER = 0.1, 1.25
"""A watchdog or a cut-off this quick is asked for rather than a longer pause; so many times as late may it act."""
SURE = sure_rig("thenar").with_(**SLOW, **{"skin.elements": [1] * 5})
UNSURE = sure_rig("thenar", "contact_resistance_relative").with_(**SLOW, **{"skin.elements": [1] * 5})
LIVELY = sure_rig("thenar", "plates_relative").with_(**SLOW, **{"skin.elements": [1] * 5})
NARROW = SURE.with_(**{"safety.display_highest_C": 41.4})
"""One corner; three, in which cut-offs are farther out; three of which the first is mild; and one corner in which no
pause makes a tenth of a second suffice."""
RIGS = pytest.mark.parametrize("rig", [SURE, UNSURE], ids=["sure", "unsure"])
DOSE_MIN, LIMITS_C = 0.5, np.array([[14.0, 40.5], [14.0, 40.5], [5.0, 42.0], [-NEVER, 60.0]])
"""What a fault may add on these rigs, and lead skin, receptors, display and hot plate to."""


def beyond_K(far: Array) -> float:
    """How far the worst lane passes a limit of a fault, in K or in shares of its dose; negative inside."""
    low_C, high_C = far[:, 0:8:2], far[:, 1:8:2]
    most_K = np.maximum(LIMITS_C[:, 0] - low_C, high_C - LIMITS_C[:, 1]).max()
    return float(max(most_K, far[:, DOSE].max() / DOSE_MIN - 1.0))


@dataclass(frozen=True)
class Searched:
    """A search from the shortest pause without faults on, beside its drive on the independent circuit."""

    begin_s: float
    search: Search
    bench: Bench

    def begun(self, pause_s: float) -> list[Array]:
        """States before a play: at rest, after many with a pause between them, and after no power and a rest."""
        later, first = self.bench.rest(), self.bench.unpowered()
        for _ in range(PLAYS):
            self.bench.run(later, 0.0, self.bench.end_s + pause_s)
        self.bench.wait(first, self.search.starts(pause_s).rest_s)
        return [self.bench.rest(), later, first]

    def shown(self, pause_s: float) -> tuple[float, float, float]:
        """The coldest and the warmest display of these plays, and its longest stay in s beyond where it may stay."""
        states = self.begun(pause_s)
        far = joined([self.bench.run(state, 0.0, self.bench.end_s + pause_s) for state in states], len(states[0]))
        return far[:, 4].min(), far[:, 5].max(), max(state[:, LONGEST].max() for state in states)

    def instants(self, pause_s: float) -> list[tuple[float, Array]]:
        """Times in plays, at and between the ends of currents, with the states then."""
        times_s = np.unique(np.concatenate([np.linspace(0.0, self.bench.end_s, 12)[1:], self.bench.edges_s]))
        instants = []
        for state in self.begun(pause_s):
            for before_s, time_s in zip([0.0, *times_s[:-1]], times_s, strict=True):
                self.bench.run(state, before_s, time_s)
                instants.append((float(time_s), state.copy()))
        return instants

    def hung_K(self, pause_s: float, hangs_s: float) -> float:
        """How far a current leads beyond a limit that hangs for so long at any instant, and after."""
        instants = self.instants(pause_s)
        return max(self._until_off_K(state, self.bench.hang(state, time_s, hangs_s)) for time_s, state in instants)

    def stuck_K(self, states: list[Array], cut: CutOff, react_s: float) -> float:
        """How far a driver that is stuck leads beyond a limit until a cut-off has acted so late, and after."""
        edges = np.tile([cut.low, cut.high, react_s, -NEVER, NEVER, NEVER], (len(self.bench.every), 1))
        flow = self.bench.flow(self.search.faults[0].ends_A[0])
        return max(
            self._until_off_K(state, self.bench.lanes.hold(state, self.bench.every, flow, 60.0, edges))
            for state in (state.copy() for state in states)
        )

    def stuck_in_plays_K(self, pause_s: float, react_s: float) -> float:
        """The same at any instant of a play, with the cut-offs that are placed around plays with this pause."""
        cut = CutOff(*self.search.cut_off_around(pause_s).ends_C, react_s)
        return self.stuck_K([state for _, state in self.instants(pause_s)], cut, react_s)

    def _until_off_K(self, state: Array, far: Array) -> float:
        return beyond_K(joined([far, self.bench.off(state, self.bench.every, 30.0)], len(far)))


@cache
def searched(rig: Rig) -> Searched:
    """For a drive that warms, which is safe by itself."""
    drive = Drive([0, 0.1, 2.6, 3.6, 4.6], [REST, -0.3, 0.2, REST, REST], held=True)
    plant = CurrentPlant.of(Ensemble.of(rig))
    single = Single.of(plant, CurrentPlay(drive, REST), rig.limits)
    repeating = Repeating(plant, [[single.play]], rig.limits)
    begin_s, recovery_s = shortest_pause_s(repeating), single.recovery_s
    assert begin_s is not None and recovery_s is not None
    search, document = Search.of(plant, [single], repeating, 0.0, begin_s, recovery_s), json.loads(rig.document)
    low_C, high_C = search.lasting
    lanes = Lanes.of(Circuit.of(document, worlds_of(document)), (low_C + SENSOR_K, high_C - SENSOR_K))
    held = Held.of(drive.time_s, drive.current_A, drive.current_A**2)
    return Searched(begin_s, search, Bench(lanes, held, search.faults[0].ends_A))


@RIGS
def test_the_display_stays_inside_its_reach_and_leaves_it_after_a_shorter_pause(rig: Rig) -> None:
    one = searched(rig)
    for pause_s in (one.begin_s, 17.0):
        reach, (low_C, high_C, beyond_s) = one.search.reach(pause_s), one.shown(pause_s)
        assert reach.low_C <= low_C + 1e-3 and high_C <= reach.high_C < high_C + 0.35
        assert low_C < reach.low_C + 0.1 and beyond_s <= reach.beyond_s
        assert one.shown(0.8 * pause_s)[1] > reach.high_C


@RIGS
def test_cut_offs_let_plays_pass_and_a_single_one_stands_where_a_display_may_stay(rig: Rig) -> None:
    """It fails, for a longer pause to be found, where plays go so far; two stand around a drive that always does."""
    one = searched(rig)
    for pause_s, passes in ((one.begin_s, False), (20.0, True)):
        stages, (low_C, high_C, _) = one.search.cut_off_around(pause_s), one.shown(pause_s)
        assert stages.held is None and (not stages.failed) == passes
        assert (high_C < one.search.lasting[1] - LEAST_BEYOND_K) == passes, "the simulated plays pass it, or do not"
        assert stages.ends_C[0] < low_C and (not passes or high_C < stages.ends_C[1] <= one.search.lasting[1])
    always = replace(one.search, lasting=(one.search.lasting[0], 37.0), _reach={})
    both = always.cut_off_around(20.0)
    assert both.held is not None and both.held.high == 37.0 and both.ends_C[1] > one.shown(20.0)[1]


@RIGS
def test_what_suffices_keeps_every_limit_and_a_little_later_passes_one(rig: Rig) -> None:
    one = searched(rig)
    assert not one.search.suffices(0, one.begin_s, (0.0, 0.0)), "the plays do not even pass their cut-off"
    react_s = max(time_s for time_s in np.geomspace(0.02, 1.0, 80) if one.search.suffices(0, 20.0, (0.0, time_s)))
    assert one.stuck_in_plays_K(20.0, LATER * react_s) <= 0.0 < one.stuck_in_plays_K(20.0, LATER * react_s + 0.03)
    hangs_s = max(time_s for time_s in np.geomspace(0.1, 10.0, 80) if one.search.suffices(0, 20.0, (time_s, 0.0)))
    assert one.hung_K(20.0, LATER * hangs_s) <= 0.0 < one.hung_K(20.0, 1.25 * LATER * hangs_s)


@pytest.mark.parametrize("rig", [SURE, LIVELY], ids=["sure", "lively"])
def test_demands_in_plays_keep_every_limit_in_all_corners_and_the_next_slower_ones_do_not(rig: Rig) -> None:
    """Also where the corner in which they are sought is not the worst."""
    one = searched(rig)
    watchdog_s, react_s = one.search.demands_of(0, 60.0).within_s
    assert replace(one.search, hardest=[[0]]).demands_of(0, 60.0).within_s == (watchdog_s, react_s)
    slower_s, later_s = HANGS_S[HANGS_S.index(watchdog_s) + 1], REACTIONS_S[REACTIONS_S.index(react_s) + 1]
    assert one.hung_K(60.0, LATER * watchdog_s) <= 0.0 < one.hung_K(60.0, LATER * slower_s)
    assert one.stuck_in_plays_K(60.0, LATER * react_s) <= 0.0 < one.stuck_in_plays_K(60.0, LATER * later_s)
    assert one.search.demands_within(60.0, [(watchdog_s, react_s)]) is not None
    assert not any(one.search.demands_within(60.0, [needed_s]) for needed_s in ((slower_s, 0.0), (0.0, later_s)))


def test_cut_offs_are_as_far_out_as_a_driver_stuck_before_a_play_allows() -> None:
    one, pause_s = searched(SURE), searched(SURE).search.longest_s
    states = [*one.begun(pause_s), one.bench.unpowered()]
    (cut, _), (farther, _) = (replace(one.search, beyond_K=beyond_K).at_rest(pause_s) for beyond_K in (0.2, 0.5))
    assert (one.search.beyond_K, cut.react_within_s) == (0.2, PRACTICAL_S)
    assert one.stuck_K(states, cut, LATER * PRACTICAL_S) <= 0.0 < one.stuck_K(states, cut, 2.0 * LATER * PRACTICAL_S)
    assert one.stuck_K(states, farther, LATER * PRACTICAL_S) > 0.0
    assert searched(UNSURE).search.beyond_K == 1.0, "where that is practical"


def test_the_shortest_pause_is_the_first_with_a_practical_cut_off() -> None:
    """By how quickly it must act on one rig, by what it lets pass on another, and by the rest before a first play."""
    sure, unsure = searched(SURE), searched(UNSURE)
    pause_s, (in_plays,) = sure.search.shortest(sure.begin_s)
    assert in_plays.within_s[1] == PRACTICAL_S < sure.begin_s < 0.5 * pause_s
    late_s = LATER * PRACTICAL_S
    assert sure.stuck_in_plays_K(pause_s, late_s) <= 0.0 < sure.stuck_in_plays_K(0.7 * pause_s, late_s)
    pause_s, _ = unsure.search.shortest(unsure.begin_s)
    most_C = unsure.search.lasting[1] - LEAST_BEYOND_K
    assert unsure.shown(pause_s)[1] < most_C < unsure.shown(0.8 * pause_s)[1]
    without_rest = replace(unsure.search, _rests={pause_s: None})
    assert without_rest.shortest(unsure.begin_s)[0] > pause_s, "after it no rest would keep a first play safe"


def test_where_no_pause_makes_a_tenth_of_a_second_suffice_what_the_longest_needs_is_asked_for() -> None:
    one = searched(NARROW)
    ((watchdog_s, react_s),) = one.search.needed_s(one.begin_s)
    assert watchdog_s == PRACTICAL_S > react_s
    quick_K, practical_K = (one.stuck_in_plays_K(one.search.longest_s, LATER * by_s) for by_s in (react_s, PRACTICAL_S))
    assert quick_K <= 41.4 - 42.0 < practical_K, "the limit of this rig lies lower"


def test_the_rest_before_a_first_play_keeps_its_limits_and_the_next_shorter_one_does_not() -> None:
    """Of rests that grow by half; none keeps what a play after the pause passes."""
    one = searched(UNSURE)
    rests_s = [0.0, 2.0, 3.0, 5.0, 8.0, 12.0, 18.0, 27.0, 41.0, 62.0]
    kept_s = one.search.beginning.kept_s(Starts(0.0, one.search.starts(60.0).bounds), 60.0)
    assert kept_s in rests_s[1:]

    def hottest_C(rest_s: float) -> float:
        state = one.bench.unpowered()
        one.bench.wait(state, rest_s)
        return float(one.bench.run(state, 0.0, one.bench.end_s)[:, 1].max())

    assert hottest_C(kept_s) <= 39.5 < hottest_C(rests_s[rests_s.index(kept_s) - 1])
    soon = one.search.beginning.after(0.8 * one.begin_s)
    assert one.search.beginning.kept_s(soon, 0.8 * one.begin_s) is None
