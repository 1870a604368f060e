"""The demands on the hardware that keep given currents safe with a single fault.

Shorter pauses need a quicker watchdog and a quicker cut-off. Where these would be quicker than PRACTICAL_S, and are not
with a pause in which display and skin recover, the pause is lengthened instead; so it is where a single cut-off would
act on plays. Where no pause helps, a second cut-off is demanded (`held.py`). A set that no pause makes safe is judged
with the longest.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ..rig.rules import Limits
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .checks import Check, colour_of
from .demands import CutOff, Demanded, Demands, HeldCutOff, SingleFault
from .display import for_good_C
from .ensemble import Ensemble
from .exposure import cem43_min
from .fault_limits import DOSE, FaultLimits
from .held import BEYONDS_K, HeldSkin, Span, Stages, one_stage, two_stages
from .in_plays import InPlays, found_at_rest, found_in_plays
from .plant import Single
from .polarity import least_fall_K, polarity_check, where_tests_begin
from .repeated import LONGEST_PAUSE_S, PAUSE_STEP_S, Repeating, lengthened_s
from .shown import Shown, healthy_C, longest_rest_s, shown_between
from .single_faults import Faulty
from .spans import PRACTICAL_S
from .starts import Beginning, Starts
from .stuck_rate import Limited, limited
from .tally import HOTTEST_C, WATCHED, Tally
from .ways_out import with_ways_out_of_drives

if TYPE_CHECKING:
    from .current import CurrentPlant, CurrentPlay

    Singles = Sequence[Single[CurrentPlay, State]]

NOT_ASKED_S = 0.0, 0.0
"""Times of watchdog and cut-off where neither is asked for."""


def demanded(
    plant: CurrentPlant,
    singles: Singles,
    recovered_s: Sequence[float],
    repeating: Repeating[CurrentPlay, State],
    tallies: Sequence[list[Tally]],
    shortest_s: float | None,
) -> Demanded:
    """The shortest pause after which faults can be prevented in practice, and what prevents them in any play after."""
    judged = [*itertools.chain.from_iterable(tallies), *(single.tallies[0] for single in singles)]
    dose_before_min = max(float(tally.summed(DOSE).max()) for tally in judged)
    begin_s = LONGEST_PAUSE_S if shortest_s is None else shortest_s
    search = Search.of(plant, singles, repeating, dose_before_min, begin_s, max(recovered_s))
    if shortest_s is None:
        return search.completed(search.demands(begin_s), begin_s, is_safe=False)
    pause_s, in_plays = search.shortest(shortest_s)
    return search.completed(in_plays, pause_s, is_safe=True)


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """A search for the shortest pause, up to one in which all recover, after which faults are prevented in practice.

    Its steps, of a pause in s: between which states plays begin (`starts`), where the display then goes (`reach`), the
    cut-offs around that (`cut_off_around`), whether watchdog and cut-off suffice that act within a time (`suffices`),
    how quickly they must act (`demands_of`), and the shortest pause for which that is practical (`shortest`).

    `lasting` is where the display may stay, beyond which a first rest leaves it for `first_s`; `slow` is the current
    limit of the driver, `fall_K` how far the display falls in a test of the polarity. Cut-offs are `beyond_K` beyond
    what the display reaches, and `hardest` are the corners of each drive in which watchdog and cut-off are tried.
    """

    singles: Singles
    faults: Sequence[Faulty]
    beginning: Beginning[CurrentPlay, State]
    skin: HeldSkin
    lasting: Span
    first_s: float
    slow: Limited
    fall_K: float
    longest_s: float
    beyond_K: float = BEYONDS_K[0]
    hardest: Sequence[list[int]] = ()
    _starts: dict[float, Starts[State]] = field(default_factory=dict)
    _reach: dict[float, Shown] = field(default_factory=dict)
    _rests: dict[float, float | None] = field(default_factory=dict)

    @staticmethod
    def of(
        plant: CurrentPlant,
        singles: Singles,
        repeating: Repeating[CurrentPlay, State],
        dose_before_min: float,
        begin_s: float,
        recovery_s: float,
    ) -> Search:
        """For drives that have recovered after a time in s, with pauses from `begin_s` on."""
        may = FaultLimits.of(repeating.limits, dose_before_min)
        faults = [_faulty(plant.ensemble, single, repeating.limits, may) for single in singles]
        moments = [faulty.moments() for faulty in faults]
        slow = limited(faults, moments)
        skin = HeldSkin.of(plant.rig, may)
        lasting = skin.lasting_C()
        beginning = Beginning.of(repeating, begin_s, recovery_s)
        first_s = longest_rest_s(faults, beginning.left, healthy_C(lasting))
        tests = where_tests_begin(plant.ensemble, [single.start for single in singles], moments)
        return Search(
            singles,
            [replace(faulty, limit_A=slow.limit_A) for faulty in faults],
            replace(beginning, least_s=float(math.ceil(first_s)) if math.isfinite(first_s) else 0.0),
            skin,
            lasting,
            first_s,
            slow,
            least_fall_K(plant.ensemble, tests),
            max(begin_s, recovery_s),
        ).placed(begin_s)

    def placed(self, begin_s: float) -> Search:
        """The same with cut-offs as far out as a driver stuck before a play allows, and the hardest corners."""
        searches = [replace(self, beyond_K=beyond_K) for beyond_K in BEYONDS_K]
        react_s = [search.at_rest(self.longest_s)[0].react_within_s for search in searches]
        # The farthest that suffices, or the slowest.
        search = searches[int(np.argmax(np.minimum(react_s, PRACTICAL_S)))]
        ends_C = search.cut_off_around(begin_s).ends_C
        return replace(search, hardest=[faulty.hardest(ends_C, PRACTICAL_S) for faulty in search.faulty(begin_s)])

    @property
    def limits(self) -> Limits:
        """The limits of the rig, or those in their place."""
        return self.beginning.repeating.limits

    @property
    def numbers(self) -> range:
        """The numbers of the drives."""
        return range(len(self.faults))

    def starts(self, pause_s: float) -> Starts[State]:
        """The states between which plays begin."""
        if pause_s not in self._starts:
            self._starts[pause_s] = self.beginning.after(pause_s)
        return self._starts[pause_s]

    def faulty(self, pause_s: float) -> list[Faulty]:
        """Drives whose plays begin between the bounds of a pause."""
        bounds = self.starts(pause_s).bounds
        return [replace(faulty, bounds=bounds) for faulty in self.faults]

    def rest_s(self, pause_s: float) -> float | None:
        """The rest before a first play, after which no play passes a limit; None: 10 min do not suffice."""
        if pause_s not in self._rests:
            self._rests[pause_s] = self.beginning.kept_s(self.starts(pause_s), pause_s)
        return self._rests[pause_s]

    def reach(self, pause_s: float) -> Shown:
        """What the display reaches without a fault, and for how long in s it is beyond where it may stay."""
        if pause_s not in self._reach:
            checks = [check for single in self.singles for check in single.checks if check.quantity == "display"]
            levels = [check.value for check in checks]
            once = Shown(min(levels), max(levels), self.first_s)
            later = (shown_between(faulty, healthy_C(self.lasting), pause_s) for faulty in self.faulty(pause_s))
            self._reach[pause_s] = Shown.of([once, *later])
        return self._reach[pause_s]

    def cut_off_around(self, pause_s: float) -> Stages:
        """The cut-offs around what the display reaches: one where the longest pause makes that suffice, else two."""
        reach = self.reach(pause_s)
        single = one_stage(self.limits, reach.reach_C, self.lasting, self.beyond_K)
        if not single.failed:
            return single
        if not one_stage(self.limits, self.reach(self.longest_s).reach_C, self.lasting, self.beyond_K).failed:
            return single
        return two_stages(self.limits, self.skin, reach.reach_C, self.lasting, reach.beyond_s, self.beyond_K)

    def suffices(self, number: int, pause_s: float, within_s: Span) -> bool:
        """Whether a watchdog and a cut-off that act in time keep a drive safe after a pause, in the hardest corners.

        A cut-off must let the display pass in any case; a time of 0 asks for no more.
        """
        stages = self.cut_off_around(pause_s)
        if stages.failed:
            return False
        if within_s == NOT_ASKED_S:
            return True
        watchdog_s, react_s = within_s
        faulty = self.faulty(pause_s)[number].at(self.hardest[number])
        beyond_K = faulty.beyond_K(faulty.moments(), watchdog_s, CutOff(*stages.ends_C, react_s))
        return bool(beyond_K.max() <= 0.0)

    def demands_of(self, number: int, pause_s: float) -> InPlays:
        """How quickly watchdog and cut-off must act in plays of a drive after a pause."""
        ends_C = self.cut_off_around(pause_s).ends_C
        return found_in_plays(self.faulty(pause_s)[number], self.hardest[number], ends_C)

    def demands(self, pause_s: float) -> list[InPlays]:
        """How quickly they must act in plays of each drive."""
        return [self.demands_of(number, pause_s) for number in self.numbers]

    def at_rest(self, pause_s: float) -> tuple[CutOff, SingleFault]:
        """How quickly a cut-off must act before plays, which is the same for all drives."""
        return found_at_rest(self.faulty(pause_s)[0], self.cut_off_around(pause_s).ends_C)

    def shortest(self, shortest_s: float) -> tuple[float, list[InPlays]]:
        """The shortest pause from one on with practical demands, and these."""
        needed_s = self.needed_s(shortest_s)

        def suffice(pause_s: float) -> bool:
            return all(self.suffices(number, pause_s, needed_s[number]) for number in self.numbers)

        pause_s = lengthened_s(shortest_s, self.longest_s, suffice)
        added_s = max(PAUSE_STEP_S, 0.02 * pause_s)
        while pause_s < self.longest_s:  # a longer one where other corners, or the rest before plays, need it
            in_plays = self.demands_within(pause_s, needed_s)
            if in_plays is not None and self.rest_s(pause_s) is not None:
                return pause_s, in_plays
            longer_s = math.ceil((pause_s + added_s) / PAUSE_STEP_S) * PAUSE_STEP_S
            pause_s, added_s = min(self.longest_s, longer_s), 2.0 * added_s
        return pause_s, self.demands(pause_s)

    def needed_s(self, shortest_s: float) -> list[Span]:
        """How quickly watchdog and cut-off of each drive may have to act: in practice, or as the longest pause needs.

        Of a drive that is safe with them after the shortest pause nothing is asked, since longer ones need less.
        """
        practical_s = PRACTICAL_S, PRACTICAL_S
        suffice = [self.suffices(number, shortest_s, practical_s) for number in self.numbers]
        needed_s = [NOT_ASKED_S if already else practical_s for already in suffice]
        if self.cut_off_around(self.longest_s).failed:
            return needed_s
        if all(self.suffices(number, self.longest_s, needed_s[number]) for number in self.numbers):
            return needed_s
        at_best_s = [in_plays.within_s for in_plays in self.demands(self.longest_s)]
        return [
            (min(asked_s[0], best_s[0]), min(asked_s[1], best_s[1]))
            for asked_s, best_s in zip(needed_s, at_best_s, strict=True)
        ]

    def demands_within(self, pause_s: float, needed_s: Sequence[Span]) -> list[InPlays] | None:
        """Demands of each drive; None as soon as one needs something quicker than in `needed_s`."""
        demands = dict[int, InPlays]()
        for number in sorted(self.numbers, key=lambda number: needed_s[number] == NOT_ASKED_S):  # may not suffice first
            demands[number] = self.demands_of(number, pause_s)
            if np.less(demands[number].within_s, needed_s[number]).any():
                return None
        return [demands[number] for number in self.numbers]

    def completed(self, in_plays: Sequence[InPlays], pause_s: float, is_safe: bool) -> Demanded:
        """The whole demands on each drive after a pause, which is one of them where plays are safe, and what fails."""
        stages, resting = self.cut_off_around(pause_s), self.at_rest(pause_s)
        rest_s = self.rest_s(pause_s) if is_safe else None
        pause_at_least_s = pause_s if is_safe else None
        demands = [
            self._whole(number, drive_in_plays, resting, stages, rest_s, pause_at_least_s)
            for number, drive_in_plays in enumerate(in_plays)
        ]
        failed = tuple[Check, ...]()
        if stages.failed and is_safe:
            thermode_C = for_good_C(self.skin.modes, self.limits)
            failed = with_ways_out_of_drives(stages.failed, self._as_given_C(), thermode_C)
        return Demanded(pause_at_least_s, demands, failed)

    def _as_given_C(self) -> Span:
        """Between which temperatures in °C the display of the rig as given is in single plays."""
        given = np.zeros(len(self.limits.rules), dtype=np.int64)
        checks = [check for single in self.singles for check in single.tallies[0].checks(given)]
        levels = [check.value for check in checks if check.quantity == "display"]
        return min(levels), max(levels)

    def _whole(
        self,
        number: int,
        in_plays: InPlays,
        resting: tuple[CutOff, SingleFault],
        stages: Stages,
        rest_s: float | None,
        pause_s: float | None,
    ) -> Demands:
        """Demands of a drive on the hardware, with the rest before a first play and the pause after any."""
        cut_off, stuck = min((in_plays.cut_off, in_plays.stuck), resting, key=lambda pair: pair[0].react_within_s)
        polarity, swapped = polarity_check(self.faults[number], self.fall_K)
        inside = () if stages.held is None else (inside_fault(stages.held, cut_off),)
        begins = self._begins(number, rest_s)
        dose_min = float(self.singles[number].tallies[0].summed(DOSE).max()) + self.skin.worst_dose_min(stages)
        ensemble, left = self.faults[number].ensemble, self.beginning.left[0]
        return Demands(
            watchdog_s=in_plays.watchdog_s,
            cut_off_display_C=cut_off,
            polarity_check=polarity,
            rest_before_first_play_s=rest_s,
            pause_at_least_s=pause_s,
            zero_current_at_most_s=zero_current_s(ensemble, self.limits, left, dose_min),
            faults=(in_plays.hangs, begins, swapped, *inside, *self._fast(), stuck),
            held_cut_off_display_C=stages.held,
            current_limit_A=self.slow.limit_A,
        )

    def _begins(self, number: int, rest_s: float | None) -> SingleFault:
        """A first play at once on a display that was without power."""
        findings = self.beginning.unpowered(number, 0.0)
        told = {"finding": next(iter(findings), None), "rest_s": rest_s}
        return SingleFault("unpowered", colour_of(findings), told)

    def _fast(self) -> tuple[SingleFault, ...]:
        """A driver that moves the skin too fast where it gets stuck, if it does."""
        if self.slow.limit_A is None:
            return ()
        told = {"rate": self.slow.rate_K_per_s, "kept": self.slow.kept, "limit_A": self.slow.limit_A}
        return (SingleFault("stuck fast", "red", told),)


def _faulty(ensemble: Ensemble, single: Single[CurrentPlay, State], limits: Limits, may: FaultLimits) -> Faulty:
    """A drive in which faults happen, played from rest."""
    drive, rest_A = single.play.drive, float(single.play.rest_A)
    assert isinstance(drive, Drive)
    return Faulty(ensemble, drive, rest_A, single.start, limits, may)


def inside_fault(held: HeldCutOff, cut_off: CutOff) -> SingleFault:
    """A driver that is stuck where the first cut-off does not act."""
    return SingleFault("stuck inside", "red", {"held": held, "cut_off": cut_off})


def zero_current_s(ensemble: Ensemble, limits: Limits, state: State, dose_before_min: float) -> float | None:
    """After how long in s contact must end at zero current, since the dose before adds up; None: a session is safe.

    `state` is as warm as a fault or a stop may leave each corner.
    """
    most = next(rule.limit for rule in limits.rules if rule.quantity == DOSE)
    times = np.concatenate([[0.0], np.geomspace(1.0, limits.session_s, 120)])
    values, _ = ensemble.hold(0.0, state, times)
    skin = np.clip(np.nan_to_num(values[WATCHED.index("skin_C")], nan=HOTTEST_C), None, HOTTEST_C)
    dose = cem43_min(times, skin).max(axis=0) + dose_before_min
    over = np.flatnonzero(dose > most)
    return float(math.floor(times[max(0, over[0] - 1)])) if len(over) else None
