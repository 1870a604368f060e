"""The request for a choice, the icons that can be chosen, and why others cannot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.icons.number_text import count_of

from ..arrays import Array
from ..ranking.assemble import energy_J, objection
from .subset_identification import OBJECTIVES, Objective

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon


class ChoiceError(ValueError):
    """The requested choice cannot be made; the text states why and what would help.

    Examples
    --------
    >>> Selection(1)
    Traceback (most recent call last):
    ...
    thermicon.perception.selection.request.ChoiceError: 1 cannot be chosen: ...
    """


@dataclass(frozen=True, slots=True)
class Selection:
    """A request: how many icons to choose, and what for.

    Attributes
    ----------
    count
        Number of icons, 2 or more.
    objective
        What is maximised: `worst` (d′ of the worst pair), `correct`, `bits` or `bits-per-s`.
    must
        Names of icons that are in any choice.
    most_s
        Most time that all chosen icons together last, s; None: any.
    most_J
        Most energy that they take of the driver, J; None: any.

    Raises
    ------
    ChoiceError
        For what cannot be requested of any set.

    Examples
    --------
    >>> Selection(3, must=("a", "a")).must
    ('a',)
    """

    count: int
    objective: Objective = "worst"
    must: tuple[str, ...] = ()
    most_s: float | None = None
    most_J: float | None = None

    def __post_init__(self) -> None:
        if isinstance(self.must, str):
            raise ChoiceError(f"must is a tuple of names, such as must=({self.must!r},)")
        if self.count != int(self.count):
            raise ChoiceError(f"{self.count:g} icons cannot be chosen: give a whole number")
        object.__setattr__(self, "must", tuple(dict.fromkeys(self.must)))
        if self.objective not in OBJECTIVES:
            raise ChoiceError(f"the objective is one of {', '.join(OBJECTIVES)}, not {self.objective!r}")
        if self.count < 2:
            raise ChoiceError(f"{self.count} cannot be chosen: at least 2 icons are needed to be distinguished")
        if len(self.must) > self.count:
            raise ChoiceError(f"{len(self.must)} icons must be among {self.count}: choose more, or ask for fewer")
        for name, most, unit in (("time", self.most_s, "s"), ("energy", self.most_J, "J")):
            if most is not None and not (math.isfinite(most) and most > 0):
                raise ChoiceError(f"the total {name} must be above 0, not {most:g} {unit}")


@dataclass(frozen=True, slots=True)
class UsableIcons:
    """Places of the icons that can be chosen from, duration (s) and energy (J) of each, and why others cannot."""

    places: tuple[int, ...]
    durations_s: Array
    energies_J: Array
    excluded: tuple[tuple[str, str], ...]


def usable_icons(asked: Selection, icons: Sequence[Icon], traces: Sequence[Trace], rig: Rig) -> UsableIcons:
    """Exclude icons that are unsafe, cannot be reached, or move like an earlier icon.

    Raises `ChoiceError` for an icon that must be in and is unknown or sorted out, and where too few are left.
    """
    check_selection(asked, [icon.name for icon in icons])
    if asked.most_J is not None and rig.thermode is not None:
        raise ChoiceError(
            f"rig {rig.name} is a thermode, which states no energy: leave out energy of the goal, or most_J"
        )
    shapes: dict[object, str] = {}
    excluded: dict[str, str] = {}
    wanted = sorted(range(len(icons)), key=lambda k: (icons[k].name not in asked.must, k))
    for k in wanted:
        why = objection(traces[k])
        twin = None if why else shapes.setdefault(shape_of(icons[k], rig), icons[k].name)
        if why is not None:
            excluded[icons[k].name] = why
        elif twin != icons[k].name:
            excluded[icons[k].name] = f"moves in the same way as {twin}"
    for name in asked.must:
        if name in excluded:
            raise ChoiceError(f"{name} must be among the chosen but cannot be: it {excluded[name]}")
    places = tuple(k for k, icon in enumerate(icons) if icon.name not in excluded)
    if len(places) < asked.count:
        raise ChoiceError(
            _too_few(asked.count, len(icons), len(places), [i.name for i in icons if i.name in excluded], excluded)
        )
    from thermicon.circuit.solver.simulate import duration_s

    durations = np.array([duration_s(icons[k], rig) for k in places])
    energies = np.array([energy_J(traces[k], d) for k, d in zip(places, durations.tolist(), strict=True)])
    listed = tuple((icon.name, excluded[icon.name]) for icon in icons if icon.name in excluded)
    return UsableIcons(places, durations, energies, listed)


def shape_of(icon: Icon, rig: Rig) -> object:
    """What two icons share that play alike: control and corner points."""
    from thermicon.circuit.solver.inverse import baseline_C
    from thermicon.circuit.solver.steady import steady_state

    base = baseline_C(icon, rig)
    start = steady_state(rig, "display", base)[0] if icon.context.control == "current" else base
    corners = icon.corners(start)
    return icon.context.control, base, corners


def check_selection(asked: Selection, names: Sequence[str]) -> None:
    """Raise `ChoiceError` for more icons than there are, or one that must be in and is not there."""
    from thermicon.icons.model.words import nearest

    if asked.count > len(names):
        raise ChoiceError(_too_few(asked.count, len(names), len(names), [], {}))
    for name in asked.must:
        if name not in names:
            near = nearest(name, names)
            hint = (
                f"did you mean {near}?" if near else f"there are {', '.join(names[:20])}" + (" …" if names[20:] else "")
            )
            raise ChoiceError(f"no icon is called {name!r}, which must be among the chosen; {hint}")


def _too_few(count: int, all_: int, left: int, names: Sequence[str], excluded: dict[str, str]) -> str:
    if not excluded:
        there = f"there {'is' if all_ == 1 else 'are'} only {count_of(all_, 'icon')}"
        return f"{count} icons cannot be chosen: {there}"
    reasons = "; ".join(f"{name} {excluded[name]}" for name in names[:3])
    more = f"; and {len(names) - 3} more" if len(names) > 3 else ""
    rest = "none is left" if left == 0 else f"only {left} of {all_} are left"
    return f"{count} icons cannot be chosen: {rest} ({reasons}{more})"
