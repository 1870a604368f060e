"""The demands on the hardware that keep given currents safe with a single fault.

Shorter pauses need a quicker watchdog and a quicker cut-off. Where these would be quicker than PRACTICAL_S, and are not
with a pause in which display and skin recover, the pause is lengthened instead; so it is where a single cut-off would
act on plays. Where no pause helps, a second cut-off is demanded (`held.py`). A set that no pause makes safe is judged
with the longest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import repeat
from typing import TYPE_CHECKING

import numpy as np

from ..rig.rules import Limits
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .checks import Check, colour_of
from .demands import CutOff, Demands, HeldCutOff, SingleFault
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

Found = tuple[Demands, tuple[Check, ...]]
"""What the hardware must prevent, and checks that fail where it cannot."""


def demanded(
    plant: CurrentPlant,
    singles: Singles,
    recovered_s: Sequence[float],
    repeating: Repeating[CurrentPlay, State],
    tallies: Sequence[list[Tally]],
    shortest_s: float | None,
) -> tuple[float | None, list[Found]]:
    """The shortest pause after which faults can be prevented in practice, and what prevents them in any play after."""
    every = [tally for own in tallies for tally in own] + [single.tallies[0] for single in singles]
    dose_before_min = max(float(tally.summed(DOSE).max()) for tally in every)
    may = FaultLimits.of(repeating.limits, dose_before_min)
    faults = []
    for single in singles:
        drive, rest_A = single.play.drive, float(single.play.rest_A)
        assert isinstance(drive, Drive)
        faults.append(Faulty(plant.ensemble, drive, rest_A, single.start, repeating.limits, may))
    once = [one.moments() for one in faults]
    slow = limited(faults, once)
    begin_s = LONGEST_PAUSE_S if shortest_s is None else shortest_s
    skin = HeldSkin.of(plant.rig, may)
    lasting = skin.lasting_C()
    beginning = Beginning.of(repeating, begin_s, max(recovered_s))
    first_s = longest_rest_s(faults, beginning.left, healthy_C(lasting))
    search = Search(
        singles,
        [replace(one, limit_A=slow.limit_A) for one in faults],
        replace(beginning, least_s=float(math.ceil(first_s)) if math.isfinite(first_s) else 0.0),
        skin,
        lasting,
        first_s,
        slow,
        least_fall_K(plant.ensemble, where_tests_begin(plant.ensemble, [single.start for single in singles], once)),
        max(begin_s, *recovered_s),
    ).chosen(begin_s)
    if shortest_s is None:
        return None, search.completed(search.in_plays(begin_s) or [], begin_s, None)
    pause_s, in_plays = search.shortest(shortest_s)
    return pause_s, search.completed(in_plays, pause_s, pause_s)


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """A search for demands on drives of a set, between pauses in s of which the longest lets all recover.

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
    _shown: dict[float, Shown] = field(default_factory=dict)
    _rests: dict[float, float | None] = field(default_factory=dict)

    @property
    def limits(self) -> Limits:
        """The limits of the rig, or those in their place."""
        return self.beginning.repeating.limits

    def starts(self, pause_s: float) -> Starts[State]:
        """The states between which plays begin."""
        if pause_s not in self._starts:
            self._starts[pause_s] = self.beginning.after(pause_s)
        return self._starts[pause_s]

    def faulty(self, pause_s: float) -> list[Faulty]:
        """Drives whose plays begin between the bounds of a pause."""
        bounds = self.starts(pause_s).bounds
        return [replace(one, bounds=bounds) for one in self.faults]

    def rest_s(self, pause_s: float) -> float | None:
        """The rest before a first play, after which no play passes a limit; None: 10 min do not suffice."""
        if pause_s not in self._rests:
            self._rests[pause_s] = self.beginning.kept_s(self.starts(pause_s), pause_s)
        return self._rests[pause_s]

    def shown(self, pause_s: float) -> Shown:
        """What the display reaches without a fault, and for how long in s it is beyond where it may stay."""
        if pause_s not in self._shown:
            singles = [check.value for one in self.singles for check in one.checks if check.quantity == "display"]
            once = Shown(min(singles), max(singles), self.first_s)
            later = (shown_between(one, healthy_C(self.lasting), pause_s) for one in self.faulty(pause_s))
            self._shown[pause_s] = Shown.of([once, *later])
        return self._shown[pause_s]

    def stages(self, pause_s: float, beyond_K: float | None = None) -> Stages:
        """The cut-offs around plays with a pause between them: one where the longest pause makes that suffice."""
        beyond = self.beyond_K if beyond_K is None else beyond_K
        shown = self.shown(pause_s)
        first = one_stage(self.limits, shown.reach_C, self.lasting, beyond)
        if not first.failed:
            return first
        if not one_stage(self.limits, self.shown(self.longest_s).reach_C, self.lasting, beyond).failed:
            return first
        return two_stages(self.limits, self.skin, shown.reach_C, self.lasting, shown.beyond_s, beyond)

    def chosen(self, begin_s: float) -> Search:
        """The search with cut-offs as far out as suffices for a driver stuck before a play, in the hardest corners."""
        first = self.faulty(self.longest_s)[0]
        react_s = [found_at_rest(first, self.stages(self.longest_s, one).ends_C)[0].react_within_s for one in BEYONDS_K]
        # The farthest that suffices, or the slowest.
        beyond_K = BEYONDS_K[int(np.argmax(np.minimum(react_s, PRACTICAL_S)))]
        ends_C = self.stages(begin_s, beyond_K).ends_C
        hardest = [one.hardest(ends_C, PRACTICAL_S) for one in self.faulty(begin_s)]
        return replace(self, beyond_K=beyond_K, hardest=hardest)

    def suffices(self, number: int, pause_s: float, within_s: Span) -> bool:
        """Whether a watchdog and a cut-off that act in time keep a drive safe after a pause, in the hardest corners."""
        stages = self.stages(pause_s)
        if stages.failed:
            return False
        if not any(within_s):
            return True
        faulty = self.faulty(pause_s)[number].at(self.hardest[number])
        cut = CutOff(*stages.ends_C, within_s[1])
        return bool(faulty.beyond_K(faulty.moments(), within_s[0], cut).max() <= 0.0)

    def in_plays(self, pause_s: float, needed: Sequence[Span] | None = None) -> list[InPlays] | None:
        """Demands of each drive; None as soon as one needs something quicker than in `needed`."""
        ends_C, faulty, demands = self.stages(pause_s).ends_C, self.faulty(pause_s), {}
        numbers = range(len(self.faults))
        for number in sorted(numbers, key=lambda number: not (needed and any(needed[number]))):  # may not suffice first
            demands[number] = found_in_plays(faulty[number], self.hardest[number], ends_C)
            if needed and np.less(demands[number].within_s, needed[number]).any():
                return None
        return [demands[number] for number in numbers]

    def shortest(self, shortest_s: float) -> tuple[float, list[InPlays]]:
        """The shortest pause from one on with practical demands, and these."""
        numbers, within = range(len(self.faults)), (PRACTICAL_S, PRACTICAL_S)
        longest_s = self.longest_s
        needed = [(0.0, 0.0) if self.suffices(k, shortest_s, within) else within for k in numbers]
        if not all(self.suffices(k, longest_s, needed[k]) for k in numbers) and not self.stages(longest_s).failed:
            at_best = self.in_plays(longest_s) or []
            needed = [
                (min(most[0], one.within_s[0]), min(most[1], one.within_s[1]))
                for most, one in zip(needed, at_best, strict=True)
            ]
        pause_s = lengthened_s(
            shortest_s, longest_s, lambda longer_s: all(map(self.suffices, numbers, repeat(longer_s), needed))
        )
        added_s = max(PAUSE_STEP_S, 0.02 * pause_s)
        while pause_s < longest_s:
            in_plays = self.in_plays(pause_s, needed)
            if in_plays is not None and self.rest_s(pause_s) is not None:
                return pause_s, in_plays
            longer_s = math.ceil((pause_s + added_s) / PAUSE_STEP_S) * PAUSE_STEP_S
            pause_s, added_s = min(longest_s, longer_s), 2.0 * added_s
        return pause_s, self.in_plays(pause_s) or []

    def completed(self, in_plays: Sequence[InPlays], pause_s: float, said_s: float | None) -> list[Found]:
        """The whole demands on each drive, and what fails; `said_s` is the pause where one is safe."""
        stages, failed = self.stages(pause_s), tuple[Check, ...]()
        if stages.failed and said_s is not None:
            thermode_C = for_good_C(self.skin.modes, self.limits)
            failed = with_ways_out_of_drives(stages.failed, self._as_given_C(), thermode_C)
        rest_s = None if said_s is None else self.rest_s(pause_s)
        resting = found_at_rest(self.faulty(pause_s)[0], stages.ends_C)
        found = []
        for number, one in enumerate(in_plays):
            found.append((self._demands(number, one, resting, stages, rest_s, said_s), failed))
        return found

    def _as_given_C(self) -> Span:
        """Between which temperatures in °C the display of the rig as given is in single plays."""
        given = np.zeros(len(self.limits.rules), dtype=np.int64)
        checks = [check for single in self.singles for check in single.tallies[0].checks(given)]
        levels = [check.value for check in checks if check.quantity == "display"]
        return min(levels), max(levels)

    def _demands(
        self,
        number: int,
        in_plays: InPlays,
        resting: tuple[CutOff, SingleFault],
        stages: Stages,
        rest_s: float | None,
        pause_s: float | None,
    ) -> Demands:
        """Demands of a drive on the hardware, with the rest before a first play and the pause after any."""
        single, faulty = self.singles[number], self.faults[number]
        cut_off, stuck = min((in_plays.cut_off, in_plays.stuck), resting, key=lambda each: each[0].react_within_s)
        polarity, swapped = polarity_check(faulty, self.fall_K)
        findings = self.beginning.unpowered(number, 0.0)
        first = {"finding": next(iter(findings), None), "rest_s": rest_s}
        begins = SingleFault("unpowered", colour_of(findings), first)
        faults = [in_plays.hangs, begins, swapped]
        if stages.held is not None:
            faults.append(inside_fault(stages.held, cut_off))
        slow = self.slow
        if slow.limit_A is not None:
            told = {"rate": slow.rate_K_per_s, "kept": slow.kept, "limit_A": slow.limit_A}
            faults.append(SingleFault("stuck fast", "red", told))
        dose_min = float(single.tallies[0].summed(DOSE).max()) + self.skin.worst_dose_min(stages)
        return Demands(
            watchdog_s=in_plays.watchdog_s,
            cut_off_display_C=cut_off,
            polarity_check=polarity,
            rest_before_first_play_s=rest_s,
            pause_at_least_s=pause_s,
            zero_current_at_most_s=zero_current_s(faulty.ensemble, self.limits, self.beginning.left[0], dose_min),
            faults=(*faults, stuck),
            held_cut_off_display_C=stages.held,
            current_limit_A=slow.limit_A,
        )


def inside_fault(held: HeldCutOff, cut_off: CutOff) -> SingleFault:
    """A driver that is stuck where the first cut-off does not act."""
    return SingleFault("stuck inside", "red", {"held": held, "cut_off": cut_off})


def zero_current_s(ensemble: Ensemble, limits: Limits, state: State, dose_before_min: float) -> float | None:
    """After how long in s contact must end at zero current, since the dose before adds up; None: a session is safe.

    `state` is as warm as a fault or a stop may leave each corner.
    """
    if not ensemble.ideal:
        return None
    most = next(rule.limit for rule in limits.rules if rule.quantity == DOSE)
    times = np.concatenate([[0.0], np.geomspace(1.0, limits.session_s, 120)])
    values, _ = ensemble.hold(0.0, state, times)
    skin = np.clip(np.nan_to_num(values[WATCHED.index("skin_C")], nan=HOTTEST_C), None, HOTTEST_C)
    dose = cem43_min(times, skin).max(axis=0) + dose_before_min
    over = np.flatnonzero(dose > most)
    return float(math.floor(times[max(0, over[0] - 1)])) if len(over) else None
