"""The number of processor cores that a computation may use."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Lock

_allowed: ContextVar[int | None] = ContextVar("cores", default=None)
_quiet = Lock()


def cores() -> int:
    """Number of cores that this computation may use: all of this process unless `at_most` sets fewer."""
    if allowed := _allowed.get():
        return allowed
    if hasattr(os, "sched_getaffinity"):  # in a container there can be fewer than the machine has
        return max(1, len(os.sched_getaffinity(0)))
    return os.cpu_count() or 1


@contextmanager
def at_most(count: int) -> Iterator[None]:
    """Limit the work inside to this many cores; threads that it starts are not limited."""
    before = _allowed.set(max(1, count))
    try:
        yield
    finally:
        _allowed.reset(before)


@contextmanager
def quiet_blas() -> Iterator[None]:
    """Keep the linear algebra library on one thread: on matrices as small as ours its threads only wait, busily.

    That is a setting of the process: who finds it set leaves it alone, or would set it again when the first is done.
    """
    from threadpoolctl import threadpool_limits

    if not _quiet.acquire(blocking=False):
        yield
        return
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            yield
    finally:
        _quiet.release()
