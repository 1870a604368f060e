"""How many cores a computation may use; results do not depend on it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_allowed: ContextVar[int | None] = ContextVar("cores", default=None)


def cores() -> int:
    """Number of cores that this computation may use: all of this process unless `at_most` sets fewer."""
    return _allowed.get() or available()


def available() -> int:
    """Cores that this process may run on, which in a container can be fewer than the machine has."""
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return os.cpu_count() or 1


@contextmanager
def at_most(count: int) -> Iterator[None]:
    """Limit the work inside to this many cores; threads that it starts are not limited.

    >>> with at_most(1):
    ...     cores()
    1
    """
    before = _allowed.set(max(1, count))
    try:
        yield
    finally:
        _allowed.reset(before)
