"""What a laboratory can do where a display reaches farther without a fault than a fault may hold it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .checks import Check
from .held import LEAST_BEYOND_K, STAYS, Span

BY_A_LOOP_K = 0.5
"""So far beside its set-points a controller's display is judged: what remains of a rig that is hardly known."""


def with_ways_out_of_drives(failed: Sequence[Check], shown_C: Span, thermode_C: Span) -> tuple[Check, ...]:
    """Failed checks of currents that nothing corrects, each with what would pass.

    `shown_C` is the display of the rig as given, `thermode_C` where a thermode may stay, in °C.
    """
    told = []
    for check in failed:
        ways, within_K = _by_thermode(check, shown_C, thermode_C), _inside_K(check, check.limit, shown_C)
        if within_K >= BY_A_LOOP_K:
            ways.insert(0, "play set-points by a controller (closed-loop-controller)")
        if within_K >= 0.0:
            farther_K = abs(check.value - shown_C[int(check.upper)])
            ways.append(f"measure what [uncertainty] states, which takes the display {farther_K:.1f} K farther")
        told.append(_told(check, ways))
    return tuple(told)


def with_ways_out_of_set_points(
    failed: Sequence[Check], shown_C: Span, thermode_C: Span, known_C: Span, played_C: Span
) -> tuple[Check, ...]:
    """Failed checks of set-points, likewise.

    `known_C` is where a display may go whose contact was measured, `played_C` where displays go in plays.
    """
    told = []
    for check in failed:
        ways = _by_thermode(check, shown_C, thermode_C)
        if _inside_K(check, check.limit, played_C) >= 0.0:
            ways.insert(0, "use a quicker loop, which comes nearer to its baseline after no power")
        if _inside_K(check, known_C[int(check.upper)], (check.value, check.value)) >= LEAST_BEYOND_K:
            ways.append("measure the contact, and state uncertainty.contact_resistance_relative")
        told.append(_told(check, ways))
    return tuple(told)


def _inside_K(check: Check, limit_C: float, shown_C: Span) -> float:
    """How far a display stays inside a limit on the side of a check."""
    return limit_C - shown_C[1] if check.upper else shown_C[0] - limit_C


def _by_thermode(check: Check, shown_C: Span, thermode_C: Span) -> list[str]:
    inside_K = _inside_K(check, thermode_C[int(check.upper)], shown_C)
    return ["use a thermode (qst-tcs2)"] if inside_K >= LEAST_BEYOND_K else []


def _told(check: Check, ways: Sequence[str]) -> Check:
    return replace(check, source=f"{STAYS}: {', or '.join(ways) or 'use a smaller or shorter change'}")
