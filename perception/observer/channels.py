"""The two channels and the norms of distance: names that every stage shares."""

from __future__ import annotations

from typing import Literal, get_args

Channel = Literal["cold", "warm"]
TraceNorm = Literal["max", "rms", "integral"]
Norm = Literal["episodes", "naming", "max", "rms", "integral"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)
TRACE_NORMS: tuple[TraceNorm, ...] = get_args(TraceNorm)
"""Norms of the difference of two traces of sensation on one clock."""
NORMS: tuple[Norm, ...] = get_args(Norm)
"""What is remembered of an icon: its episodes, in logarithms or as ratings that are named directly, or its traces."""
USUAL_NORM: Norm = "episodes"
MEMORY_NORMS: tuple[Norm, ...] = ("episodes", *TRACE_NORMS)
"""Norms with a memory noise of their own; both forms of episodes share one."""


def check_norm(norm: str) -> Norm:
    """The norm itself, or an error that lists the norms there are."""
    for known in NORMS:
        if norm == known:
            return known
    raise ValueError(f"there is no norm {norm!r}: choose one of {', '.join(NORMS)}")


def trace_norm(norm: str) -> TraceNorm | None:
    """The norm where it is one of the difference of two traces; None where episodes are remembered."""
    for known in TRACE_NORMS:
        if norm == known:
            return known
    return None


def noise_norm(norm: Norm) -> Norm:
    """The norm whose memory noise a norm uses: both forms of episodes have one.

    >>> noise_norm("naming"), noise_norm("max")
    ('episodes', 'max')
    """
    return "episodes" if norm == "naming" else norm


def sign_of(channel: Channel) -> float:
    """Direction that a channel answers to: −1 cooling, +1 warming."""
    return -1.0 if channel == "cold" else 1.0
