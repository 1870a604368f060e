"""Constants of memory by name: no published posterior has them, but draws of one laboratory may.

What a laboratory's own answers say of memory stands beside the constants of each draw, in columns of these names.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from .observer import Observer

NOISE, SHARE = "memory noise (episodes)", "share of the scatter of ratings"
MISSING, BAR = "cost of a missing episode", "bar of an episode"
MEMORY_NAMES = (NOISE, SHARE, MISSING, BAR)
"""Every constant of memory that a table of draws may have a column for."""
LIMITS: Mapping[str, tuple[float, float]] = {
    SHARE: (0.0, 1.0), MISSING: (0.0, math.inf), "correlation of cold and warm": (-1.0, 1.0),
}  # fmt: skip
"""Least and largest value of constants that may be 0; the others must be above 0."""


def objection_to(name: str, value: float) -> str | None:
    """Why a constant of memory, or one that is positive, cannot have this value; None where it can.

    >>> objection_to("share of the scatter of ratings", 1.5)
    'must lie in 0 to 1'
    """
    if name in LIMITS:
        low, high = LIMITS[name]
        if low <= value <= high:
            return None
        return f"must lie in {low:g} to {high:g}" if math.isfinite(high) else f"must be {low:g} or more"
    return None if value > 0.0 else "must be above 0"


def with_memory(observer: Observer, values: Mapping[str, float]) -> Observer:
    """The observer with other constants of memory; other names among the values are passed over.

    >>> with_memory(Observer.load(), {"memory noise (episodes)": 0.25, "cold limit": 30.0}).memory.timing
    0.25
    """
    own = observer.memory
    memory = replace(
        own,
        timing=values.get(NOISE, own.timing),
        share=values.get(SHARE, own.share),
        missing=values.get(MISSING, own.missing),
        bar=values.get(BAR, own.bar),
    )
    return replace(observer, memory=memory)
