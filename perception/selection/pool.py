"""A pool: icons simulated once on a rig for many choices."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array, held
from thermicon.circuit import Rig, Trace
from thermicon.circuit.solver.inverse import baseline_C
from thermicon.circuit.solver.simulate import duration_s, simulate_all
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons import Icon

from ..criteria import FELT_FROM
from ..identification.episodes import dprimes_from_memory
from ..identification.population import run_end_s
from ..observer.observer import MemoryForm, Observer
from ..ranking.scores import energy_J, objection
from ..sensation.detection import detect
from ..sensation.percept import perceive_many
from ..sensation.received import received, uniform_clock
from .goal import SAFETY, Goal
from .max_min_subset import Totals
from .request import ChoiceError, Selection, check_selection, too_few

POOL_HZ = 25.0
"""Rows a second of a pool that is only tried out."""
BLOCK = 4
"""Fewer icons are solved together with repetitions: by the code that people need anyway, not by another for one."""


@dataclass(frozen=True, slots=True)
class Pool:
    """Icons with their traces on one clock and durations (s), and sensations (icons, n_time) of the nominal person."""

    icons: tuple[Icon, ...]
    rig: Rig
    end_s: float
    traces: tuple[Trace, ...]
    durations_s: Array
    cold: Array
    warm: Array
    dt_s: float

    @classmethod
    def of(
        cls,
        icons: Sequence[Icon],
        rig: Rig,
        observer: Observer,
        *,
        end_s: float | None = None,
        rate_Hz: float = POOL_HZ,
    ) -> Pool:
        """Play icons on the rig until `end_s`, by default until the longest of them has faded, and feel them."""
        durations = np.array([duration_s(icon, rig) for icon in icons])
        end = run_end_s(durations.tolist(), rate_Hz) if end_s is None else end_s
        padded = [*icons, *[icons[-1]] * (BLOCK - len(icons))]
        traces = simulate_all(padded, rig, end_s=end, rate_Hz=rate_Hz)[: len(icons)]
        dt, _ = uniform_clock(traces[0].time_s)
        at_cold, at_warm = zip(*(received(trace, observer) for trace in traces), strict=True)
        cold, warm = perceive_many(
            np.array(at_cold),
            np.array(at_warm),
            dt,
            observer,
            area_m2=rig.contact.area_m2,
            site=rig.site,
        )
        return cls(tuple(icons), rig, end, tuple(traces), durations, cold, warm, dt)

    def __len__(self) -> int:
        return len(self.icons)

    def some(self, places: Sequence[int]) -> Pool:
        """The icons at some places."""
        at = list(places)
        return replace(
            self,
            icons=tuple(self.icons[k] for k in at),
            traces=tuple(self.traces[k] for k in at),
            durations_s=self.durations_s[at],
            cold=self.cold[at],
            warm=self.warm[at],
        )

    @property
    def energies_J(self) -> Array:
        """Energy (J) that each icon takes of the driver; NaN on a thermode."""
        return np.array([energy_J(*each) for each in zip(self.traces, self.durations_s.tolist(), strict=True)])

    def dprimes(self, kept: Pool, memory: MemoryForm, observer: Observer) -> Array:
        """d′ from memory (these, kept) of the nominal person, on the longer clock."""
        n = max(self.cold.shape[1], kept.cold.shape[1])
        one, other = ((held(pool.cold, n), held(pool.warm, n)) for pool in (self, kept))
        names = [[trace.icon or "" for trace in pool.traces] for pool in (self, kept)]
        return dprimes_from_memory(one, other, self.dt_s, observer, memory, (names[0], names[1]))

    def limits(self, most_s: float | None, most_J: float | None) -> Totals:
        """The totals that a choice must keep, as costs of every icon."""
        both = (self.durations_s, most_s), (self.energies_J, most_J)
        kept = [(costs, most) for costs, most in both if most is not None]
        return Totals(np.array([costs for costs, _ in kept]).reshape(-1, len(self)), tuple(most for _, most in kept))

    def totals_text(self, count: int, most_s: float | None, most_J: float | None) -> str:
        """The totals that a choice must keep, each with the least that so many icons take."""
        words = [("s", "shortest last")] * (most_s is not None) + [("J", "most frugal take")] * (most_J is not None)
        limits = self.limits(most_s, most_J)
        totals = [
            f"{most:g} {unit} (the {count} {what} {math.fsum(np.sort(costs)[:count]):.3g} {unit})"
            for costs, most, (unit, what) in zip(limits.costs, limits.most, words, strict=True)
        ]
        return f"a total of {' and '.join(totals)}"

    @property
    def amber(self) -> tuple[str, ...]:
        """Names of the icons that pass a soft limit of safety, and no hard one."""
        found = zip(self.icons, self.traces, strict=True)
        return tuple(icon.name for icon, trace in found if objection(trace) is None and objection(trace, soft=True))

    def felt_by(self, observer: Observer) -> tuple[Array, Array]:
        """How often a nominal person reports each icon, and when, in s (NaN: not)."""
        felt = detect(self.cold, self.warm, self.dt_s, observer, path_m=observer.path_m(self.rig.site))
        return felt.probability, felt.onset_s

    def objections(
        self, goal: Goal | None, detected: Array, onset_s: Array, must: Sequence[str] = ()
    ) -> tuple[str | None, ...]:
        """Objections to each icon: it cannot be played, or misses what a goal asks of single icons.

        `detected` (icons,) is the mean over people, `onset_s` (icons,) theirs. Unless the goal says how often an icon
        is to be detected, half of plays are reported, but for those that `must` be in.
        """
        green = goal is not None and goal.of(SAFETY) == 0.0
        found = [objection(trace, soft=green) for trace in self.traces]
        wanted, onset = (None, None) if goal is None else (goal.least_detected, goal.of("onset"))
        for place, (share, felt_s) in enumerate(zip(detected.tolist(), onset_s.tolist(), strict=True)):
            least = wanted if wanted is not None else 0.0 if self.icons[place].name in must else FELT_FROM
            if found[place] is not None:
                continue
            if share < least:
                digits = 0 if round(share, 2) < least else 1  # 98.7 % is not the 99 % that was asked for
                found[place] = f"is detected in {100.0 * share:.{digits}f} % of trials only"
            elif onset is not None and not felt_s <= onset:
                found[place] = "is not felt" if math.isnan(felt_s) else f"is felt at {felt_s:.2f} s only"
        return tuple(found)

    def usable(
        self, asked: Selection, detected: Array, onset_s: Array, goal: Goal | None = None
    ) -> tuple[list[int], tuple[tuple[str, str], ...]]:
        """Places of the icons that can be chosen, and why others cannot: they move like an earlier one, or have an
        objection.

        Raises `ChoiceError` for an icon that must be in and is unknown or sorted out, and where too few are left.
        """
        names = [icon.name for icon in self.icons]
        check_selection(asked, names)
        if asked.most_J is not None and self.rig.thermode is not None:
            raise ChoiceError(
                f"rig {self.rig.name} is a thermode, which states no energy: leave out energy of the goal, or most_J"
            )
        shapes: dict[object, str] = {}
        excluded: dict[str, str] = {}
        objections = self.objections(goal, detected, onset_s, asked.must)
        for k in sorted(range(len(self)), key=lambda k: (names[k] not in asked.must, k)):
            why = objections[k]
            twin = None if why else shapes.setdefault(_shape_of(self.icons[k], self.rig), names[k])
            if why is not None:
                excluded[names[k]] = why
            elif twin != names[k]:
                excluded[names[k]] = f"moves in the same way as {twin}"
        for name in asked.must:
            if name in excluded:
                raise ChoiceError(f"{name} must be among the chosen but cannot be: it {excluded[name]}")
        listed = tuple((name, excluded[name]) for name in names if name in excluded)
        places = [k for k, name in enumerate(names) if name not in excluded]
        if len(places) < asked.count:
            raise ChoiceError(too_few(asked.count, len(self), listed))
        return places, listed

    def nothing_fits(self, asked: Selection) -> str:
        """Why no choice of these icons keeps the totals of a request."""
        forced = f" with {', '.join(asked.must)} among them" if asked.must else ""
        totals = self.totals_text(asked.count, asked.most_s, asked.most_J)
        return f"no {asked.count} of the {len(self)} icons{forced} stay within {totals}"


def _shape_of(icon: Icon, rig: Rig) -> object:
    """The common property of icons that play alike: control and corner points."""
    base = baseline_C(icon, rig)
    start = steady_state(rig, "display", base)[0] if icon.context.control == "current" else base
    return icon.context.control, base, icon.corners(start)
