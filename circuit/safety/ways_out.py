"""What a laboratory can do where a display reaches farther without a fault than a fault may hold it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .checks import Check
from .held import LEAST_BEYOND_K, STAYS, Span

BY_A_LOOP_K = 0.5
"""So far beside its set-points a controller's display is judged: what remains of a rig that is hardly known."""


def with_ways_out(
    failed: Sequence[Check], shown_C: Span, thermode_C: Span, known_C: Span, *, open_loop: bool
) -> tuple[Check, ...]:
    """Failed checks of `stays`, each with what would pass.

    `shown_C` is the display of the rig as given, `thermode_C` where a thermode may stay, and `known_C` where the
    display of a rig that was measured may go.
    """
    return tuple(
        replace(check, source=f"{STAYS}: {_ways(check, shown_C, thermode_C, known_C, open_loop)}") for check in failed
    )


def _ways(check: Check, shown_C: Span, thermode_C: Span, known_C: Span, open_loop: bool) -> str:
    end, side = int(check.upper), 1.0 if check.upper else -1.0
    within_K = side * (check.limit - shown_C[end])
    ways = []
    if open_loop and within_K >= BY_A_LOOP_K:
        ways.append("play set-points by a controller (closed-loop-controller)")
    if side * (thermode_C[end] - shown_C[end]) >= LEAST_BEYOND_K:
        ways.append("use a thermode (qst-tcs2)")
    if open_loop and within_K >= 0.0:
        farther_K = side * (check.value - shown_C[end])
        ways.append(f"measure what [uncertainty] states, which takes the display {farther_K:.1f} K farther")
    elif not open_loop and side * (known_C[end] - check.value) >= LEAST_BEYOND_K:
        ways.append("measure the contact, of which uncertainty.contact_resistance_relative states too little")
    return ", or ".join(ways) or "use a smaller or shorter change"
