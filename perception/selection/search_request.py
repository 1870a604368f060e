"""What a search may find: how many icons, which must stay, totals that are kept, and what a goal asks of every icon."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..observer.observer import Observer
from ..ranking.assemble import energy_J
from ..sensation.detection import detect
from .goal import SAFETY, Goal
from .max_min_subset import Limits
from .nominal import Sensed
from .request import ChoiceError

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Family, Icon, IconSet


@dataclass(frozen=True, slots=True)
class SearchRequest:
    """Limits of a search.

    Attributes
    ----------
    most_s, most_J
        Most time in s and energy in J of all icons together; None: any.
    goal
        What is wanted of the set; of it a search keeps `time`, `energy`, and what single icons must do: `safety`,
        `detected` and `onset` of the nominal person.
    """

    most_s: float | None = None
    most_J: float | None = None
    goal: Goal | None = None

    @property
    def totals(self) -> tuple[float | None, float | None]:
        """Most time and energy, by option or goal, whichever is less."""
        goal = Goal(()) if self.goal is None else self.goal
        pairs = ((self.most_s, goal.of("time")), (self.most_J, goal.of("energy")))
        time, energy = (min((each for each in pair if each is not None), default=None) for pair in pairs)
        return time, energy

    def limits(self, traces: Sequence[Trace], durations_s: Array) -> Limits | None:
        """Totals to keep as costs of every icon; None without one."""
        time, energy = self.totals
        rows: list[Array] = []
        most: list[float] = []
        if time is not None:
            rows, most = [*rows, np.asarray(durations_s)], [*most, time]
        if energy is not None:
            joule = [energy_J(trace, lasting) for trace, lasting in zip(traces, durations_s.tolist(), strict=True)]
            rows, most = [*rows, np.array(joule)], [*most, energy]
        return Limits(np.stack(rows), tuple(most)) if rows else None

    def least_totals(self, limits: Limits | None, good: Sequence[int], count: int) -> str:
        """What the `count` icons with the least of each total take, where that is more than there may be."""
        if limits is None:
            return ""
        names = [name for name, most in zip(("time", "energy"), self.totals, strict=True) if most is not None]
        said = ""
        for name, costs, most in zip(names, limits.costs, limits.most, strict=True):
            least, unit = math.fsum(np.sort(costs[list(good)])[:count]), "s" if name == "time" else "J"
            if least > most:
                said += f"; the {count} with the least {name} take {least:.3g} {unit}, the limit is {most:g} {unit}"
        return said

    def objections(self, felt: Sensed, observer: Observer, rig: Rig) -> tuple[str | None, ...]:
        """What speaks against each icon: it cannot be played, or it misses what the goal asks of single icons."""
        plain = felt.objections()
        if self.goal is None:
            return plain
        detected, onset = self.goal.of("detected"), self.goal.of("onset")
        asked = detected is not None or onset is not None
        found = detect(felt.cold, felt.warm, felt.dt_s, observer, path_m=observer.path_m(rig.site)) if asked else None
        made: list[str | None] = []
        for place, reason in enumerate(plain):
            why = reason
            if why is None and self.goal.of(SAFETY) == 0.0:
                soft = soft_finding(felt.traces[place])
                why = None if soft is None else f"is amber: {soft}"
            if why is None and found is not None:
                share, felt_s = float(found.probability[place]), float(found.onset_s[place])
                if detected is not None and share < detected:
                    why = f"is detected in {100.0 * share:.0f} % of trials only"
                elif onset is not None and not felt_s <= onset:
                    why = "is not felt" if math.isnan(felt_s) else f"is felt at {felt_s:.2f} s only"
            made.append(why)
        return tuple(made)


def soft_finding(trace: Trace) -> str | None:
    """The first soft limit of safety that an icon passes, in words; None for none."""
    from thermicon.circuit.safety.limits import judge_safety

    return next((str(each) for each in judge_safety(trace).findings if each.severity != "hard"), None)


def split_icons(
    icons: IconSet, count: int | None, must: Sequence[str] | None
) -> tuple[tuple[Icon, ...], tuple[Icon, ...], int]:
    """Plain icons that stay, plain icons that may be left out, and how many icons are free; `must` None: all stay.

    Raises `ChoiceError` for a file without families, unknown names, and numbers of icons that leave nothing to search.
    """
    from thermicon.icons import Icon
    from thermicon.icons.model.icon import played_icons
    from thermicon.icons.near_words import did_you_mean

    families: tuple[Family, ...] = icons.families
    if not families:
        raise ChoiceError("nothing to search: the file has no family, such as icon dip(depth in 1..6 step 1 °C) { … }")
    for family in families:
        if next(iter(played_icons(family.template)), None) is not None:
            raise ChoiceError(f"family {family.name} plays another icon, which a search cannot carry along")
    plain = tuple(entry for entry in icons.entries if isinstance(entry, Icon))
    names = [icon.name for icon in plain]
    for name in must or ():
        if name not in names:
            known = did_you_mean(name, names) if names else "the file has families only"
            raise ChoiceError(f"no plain icon is called {name!r}, which must be in the set: {known}")
    if must and count is None:
        raise ChoiceError("which icons must stay is a question only where some are chosen: give --choose K as well")
    fixed = plain if must is None else tuple(icon for icon in plain if icon.name in must)
    optional = tuple(icon for icon in plain if icon not in fixed)
    wanted = len(fixed) + len(families) if count is None else count
    if wanted < 2:
        raise ChoiceError("one icon is never confused: ask for 2 or more with --choose K, or give a second family")
    if wanted <= len(fixed):
        raise ChoiceError(f"{wanted} icons leave nothing to search: {len(fixed)} that are not families must stay")
    return fixed, optional, wanted - len(fixed)
