"""The gap between icons and the landing of the hand by simulation."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.circuit import Rig
from thermicon.circuit.solver.settling import LONGEST_S, settling
from thermicon.circuit.solver.simulate import duration_s
from thermicon.icons import Icon
from thermicon.perception.identification.carry_over import carry_over
from thermicon.perception.identification.population import TAIL_S
from thermicon.perception.kernels.parallel import step_counter

from .study_file import StudyError, Timing

GAPS_S = (0.0, 5.0, 10.0, 15.0, *np.arange(20.0, 121.0, 10.0).tolist(), 150.0, 180.0, 240.0, 300.0, 420.0, 600.0)
"""Gaps tried, the longest first: what is left behind may rise before it falls, when after-sensations come late."""


@dataclass(frozen=True, slots=True)
class Gap:
    """The least time between icons in s, why it is that long, and the largest d′ carried over, from which to which.

    `tried` has the d′ beside every gap that was looked at.
    """

    gap_s: float
    reason: str
    carry_over_d_prime: float
    carried_by: tuple[str, str]
    tried: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Landing:
    """The rest of the hand on the display before a block, and what is then left of its own temperature.

    `left_K` is of skin and receptors at the end, `left_at_10_s_K` after 10 s, for skin that arrives `from_K` off.
    """

    landing_s: float
    derived: bool
    from_K: float
    left_K: float
    left_at_10_s_K: float


def carried_over(icons: Sequence[Icon], rig: Rig, gap_s: float, held: bool) -> tuple[float, tuple[str, str]]:
    """Largest d′ by which an icon differs from itself alone, after which icon, and which one it is."""
    end_s = max(duration_s(icon, rig) for icon in icons) + TAIL_S
    left = carry_over(icons, rig, end_s, gap_s, tracking=None if held else "replay")
    d_prime = left.apart[0]
    before, after = divmod(int(d_prime.argmax()), len(icons))
    return float(d_prime.max()), (icons[before].name, icons[after].name)


def find_gap(
    icons: Sequence[Icon], rig: Rig, timing: Timing, held: bool, progress: Callable[[int, int], None] | None = None
) -> Gap:
    """Return the given gap, or the shortest from which on no icon carries over by more than the wanted d′.

    Raises StudyError where no gap up to 10 min suffices.
    """
    wanted, step = timing.carry_over_d_prime, step_counter(progress, len(GAPS_S))
    seen: dict[float, tuple[float, tuple[str, str]]] = {}

    def carried(gap_s: float) -> tuple[float, tuple[str, str]]:
        if gap_s not in seen:
            seen[gap_s] = carried_over(icons, rig, gap_s, held)
            step()
        return seen[gap_s]

    if timing.gap_s is not None:
        d_prime, pair = carried(timing.gap_s)
        return Gap(timing.gap_s, "given", d_prime, pair)
    gap_s = shortest_gap_s(lambda gap_s: carried(gap_s)[0] <= wanted)
    if gap_s is None:
        worst, (before, after) = carried(GAPS_S[-1])
        raise StudyError(
            f"timing.carry_over_d_prime = {wanted:g}: after {GAPS_S[-1]:g} s {before} still changes {after} by d′ = "
            f"{worst:.2g}; allow more, or give timing.gap_s"
        )
    d_prime, pair = carried(gap_s)
    tried = tuple((each, carried(each)[0]) for each in sorted(seen))
    return Gap(gap_s, f"carry-over falls below d′ = {wanted:g}", d_prime, pair, tried)


def shortest_gap_s(passes: Callable[[float], bool]) -> float | None:
    """The shortest gap in whole seconds from which on every tried gap passes; None where the longest does not."""
    last = None
    for gap_s in reversed(GAPS_S):
        if not passes(gap_s):
            break
        last = gap_s
    else:
        return last
    if last is None:
        return None
    low, high = math.floor(gap_s), math.ceil(last)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if passes(float(middle)) else (middle, high)
    return float(high)


def find_landing(icon: Icon, rig: Rig, timing: Timing, held: bool) -> Landing:
    """Return the given landing, or the time until a hand that arrives too warm or too cold has settled."""
    times, away = settling(icon, rig, timing.landing_from_K, held)
    if timing.landing_s is not None:
        seconds = timing.landing_s
    else:
        late = np.flatnonzero(away > timing.landing_within_K)
        if len(late) and late[-1] + 1 == len(away):
            raise StudyError(
                f"timing.landing_within_K = {timing.landing_within_K:g} K: skin that arrives {timing.landing_from_K:g} "
                f"K away is still {away[-1]:.2g} K off after {LONGEST_S:g} s; allow more, or give landing_s"
            )
        seconds = float(times[late[-1] + 1]) if len(late) else 0.0
    left, early = (float(np.interp(at, times, away)) for at in (seconds, 10.0))
    return Landing(seconds, timing.landing_s is None, timing.landing_from_K, left, early)
