"""The two channels and the norms of memory: names that every stage shares."""

from __future__ import annotations

from typing import Literal, get_args

Channel = Literal["cold", "warm"]
Norm = Literal["episodes", "naming"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)
NORMS: tuple[Norm, ...] = get_args(Norm)
"""How the episodes of an icon are remembered: in logarithms, or as ratings that are named directly."""
USUAL_NORM: Norm = "episodes"


def check_norm(norm: str) -> Norm:
    """The norm itself, or an error that lists the norms there are."""
    for known in NORMS:
        if norm == known:
            return known
    raise ValueError(f"there is no norm {norm!r}: choose one of {', '.join(NORMS)}")


def sign_of(channel: Channel) -> float:
    """Direction that a channel answers to: −1 cooling, +1 warming."""
    return -1.0 if channel == "cold" else 1.0
