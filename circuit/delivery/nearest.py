"""The nearest cue that a rig can reach for one that it cannot."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from thermicon.base.checks.arguments import checked
from thermicon.icons import Icon
from thermicon.icons.model.format import statement_text
from thermicon.icons.model.statements import (
    Broken,
    Play,
    Pulse,
    Ramp,
    Repeat,
    Return,
    Statement,
    Step,
    Total,
    Wave,
    all_played,
)

from ..rig.rig import AnyRig, Rig
from ..rig.rigfile import RigError
from ..solver.inverse import baseline_C
from ..solver.simulate import simulate

FARTHEST = 64.0
"""Factor by which a cue is slowed down, or made smaller, at most; assumed."""
STEPS = 14
"""Bisections in the logarithm of the factor: ln 64 / 2^14 is below the three digits that are returned."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """A reachable cue, its ramps `slower` times as slow or its changes `smaller` times as large; `lines`: old → new."""

    icon: Icon
    slower: float
    smaller: float
    lines: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"Nearest({self.icon.name!r}: {self.sentence})"

    @property
    def sentence(self) -> str:
        """What to change, in one sentence with the lines."""
        if self.slower > 1:
            how = f"ramps {self.slower:.3g} times as slow"
        else:
            how = f"changes {self.smaller:.3g} times as large, in the same time"
        return f"it is reached with its {how}{': ' if self.lines else ''}{'; '.join(self.lines)}"


@checked
def nearest_reachable(icon: Icon, rig: AnyRig = None) -> Nearest | None:
    """Return the nearest cue that the rig reaches.

    Parameters
    ----------
    icon
        The cue.
    rig
        The rig, or the name or file of one; None: the shipped rig of the icons' site, else thenar.

    Returns
    -------
    Nearest or None
        None where the rig reaches the cue itself, where no such cue exists, and for a cue that prescribes current.

    Notes
    -----
    Searched by bisection, to about 1 %, in two ways: slower ramps between the same levels, and smaller changes in the
    same time.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> cue = load_library("cooling-step-skin").icons[0]
    >>> nearest_reachable(cue, Rig.load("thenar").with_(**{"driver.current_limit_A": 1.0})).sentence
    'it is reached with its changes 0.8 times as large, in the same time: cool by 6 °C at 3 °C/s → ...'
    """
    on = Rig.of(rig, icon.context.site)
    if icon.context.control == "current" or _reached(icon, on):
        return None
    base = baseline_C(icon, on)
    slower = _least(lambda by: _reached(changed(icon, base, slower=by), on))
    smaller = _least(lambda by: _reached(changed(icon, base, smaller=1.0 / by), on))
    if slower is not None and (smaller is None or slower <= smaller):
        found = changed(icon, base, slower=slower)
        return Nearest(found, slower, 1.0, _lines(icon, found))
    if smaller is None:
        return None
    least = _three_digits(1.0 / smaller, math.floor)  # never rounded towards what is not reached
    found = changed(icon, base, smaller=least)
    return Nearest(found, 1.0, least, _lines(icon, found))


def _lines(old: Icon, new: Icon) -> tuple[str, ...]:
    """The lines that differ, each once; none where an icon that is played has its lines elsewhere."""
    if any(all_played(old.statements)):
        return ()
    kept = ([part for part in icon.statements if not isinstance(part, Total)] for icon in (old, new))
    texts = ("\n".join(statement_text(part, old.context.control) for part in parts).splitlines() for parts in kept)
    return tuple(dict.fromkeys(f"{a.strip()} → {b.strip()}" for a, b in zip(*texts, strict=True) if a != b))


def changed(icon: Icon, base_C: float, *, slower: float = 1.0, smaller: float = 1.0) -> Icon:
    """The cue with ramps `slower` times as long, and changes `smaller` times as large in the same time."""

    def all_of(body: Sequence[Statement | Broken]) -> tuple[Statement, ...]:
        # A total is what the cue was meant to last: slower, it would only be in the way.
        return tuple(one(part) for part in body if not isinstance(part, Total | Broken))

    factors = {"by_K": smaller, "rate_K_per_s": smaller / slower, "rate_per_s": smaller / slower}
    slowed = {"duration_s": slower, "period_s": slower}

    def one(statement: Statement) -> Statement:
        if isinstance(statement, Repeat):
            return replace(statement, body=all_of(statement.body))
        if isinstance(statement, Play):
            return Repeat(1, all_of(statement.icon.statements))
        if not isinstance(statement, Ramp | Return | Wave | Step | Pulse):
            return statement
        by = factors if isinstance(statement, Step | Pulse) else factors | slowed
        held = {name: old for name in by if (old := getattr(statement, name, None)) is not None}
        new: dict[str, Any] = {name: float(f"{by[name] * old:.6g}") for name, old in held.items()}
        if (level := getattr(statement, "to_C", None)) is not None:
            new["to_C"] = float(f"{base_C + smaller * (level - base_C):.6g}")
        if isinstance(statement, Wave):  # as many periods as before, however their length is rounded
            new["duration_s"] = float(f"{new['period_s'] * statement.duration_s / statement.period_s:.12g}")
        return replace(statement, **new)

    return replace(icon, statements=all_of(icon.statements))


def _reached(icon: Icon, rig: Rig) -> bool:
    try:
        return simulate(icon, rig, rate_Hz=10).reachable
    except RigError:
        return False


def _least(works: Callable[[float], bool]) -> float | None:
    """Least factor above 1 that works, with three digits; None where even the farthest does not work."""
    if not works(FARTHEST):
        return None
    low, high = 0.0, math.log(FARTHEST)
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if works(math.exp(middle)) else (middle, high)
    return _three_digits(math.exp(high), math.ceil)


def _three_digits(value: float, towards: Callable[[float], int]) -> float:
    digits = 10.0 ** (2 - math.floor(math.log10(value)))
    return towards(value * digits - 1e-9 if towards is math.ceil else value * digits + 1e-9) / digits
