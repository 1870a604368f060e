"""Constants of memory by name: no published posterior has them, but draws of one laboratory may.

What a laboratory's own answers say of memory stands beside the constants of each draw, in columns of these names.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from .channels import NORMS, noise_norm, trace_norm
from .observer import Observer

SHARE, MISSING, ONSET = "share of the scatter of ratings", "cost of a missing episode", "onset uncertainty"
BAR = "bar of an episode"


def noise_name(norm: str) -> str:
    """Name of the memory noise of a norm.

    >>> noise_name("episodes")
    'memory noise (episodes)'
    """
    return f"memory noise ({norm})"


NOISES = tuple(dict.fromkeys(noise_name(noise_norm(norm)) for norm in NORMS))
MEMORY_NAMES = (*NOISES, SHARE, MISSING, BAR, ONSET)
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
    changes: dict[str, Any] = {}
    if ONSET in values:
        changes["onset_uncertainty_s"] = values[ONSET]
    for norm in NORMS:
        if (trace := trace_norm(norm)) is not None and noise_name(trace) in values:
            changes[f"memory_{trace}"] = values[noise_name(trace)]
    own = observer.memory
    changes["memory"] = replace(
        own,
        timing=values.get(noise_name("episodes"), own.timing),
        share=values.get(SHARE, own.share),
        missing=values.get(MISSING, own.missing),
        bar=values.get(BAR, own.bar),
    )
    return replace(observer, **changes)
