"""Parallel work on a number of cores that does not change its result."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from itertools import pairwise
from typing import TypeVar

from thermicon.base.numbers.cores import at_most, cores, quiet_blas

SMALL = 200_000
MOST_THREADS = 8
Item = TypeVar("Item")
Result = TypeVar("Result")


def over_rows(work: Callable[[slice], None], rows: int, size: int) -> None:
    """Call `work` on slices that cover `rows`; in threads when `size` (elements) is worth it.

    `work` must treat rows independently and release the interpreter lock, as the kernels do.
    """
    chunks = min(cores(), MOST_THREADS, rows) if size > SMALL else 1
    if chunks <= 1:
        work(slice(0, rows))
        return
    edges = [rows * k // chunks for k in range(chunks + 1)]
    pool = ThreadPoolExecutor(chunks)
    try:
        for done in [pool.submit(work, slice(a, b)) for a, b in pairwise(edges)]:
            done.result()
    finally:
        pool.shutdown(wait=False)  # who interrupts waits for no slice


def in_order(work: Callable[[Item], Result], each: Sequence[Item], workers: int | None = None) -> Iterator[Result]:
    """Results of `work` in the order of `each`, by `workers` threads (None: the cores there are, up to eight).

    The kernels let go of the interpreter lock. No more than two results a worker wait to be taken.

    >>> list(in_order(abs, [-2, 1]))
    [2, 1]
    """
    allowed = min(cores(), MOST_THREADS) if workers is None else workers
    threads = max(1, min(allowed, len(each)))

    def one(asked: Item) -> Result:
        with at_most(allowed // threads):
            return work(asked)

    with quiet_blas():
        if threads == 1:
            for asked in each:
                yield one(asked)
            return
        pool = ThreadPoolExecutor(threads)
        try:
            waiting = [pool.submit(one, asked) for asked in each[: 2 * threads]]
            for asked in each[2 * threads :]:
                yield waiting.pop(0).result()
                waiting.append(pool.submit(one, asked))
            while waiting:
                yield waiting.pop(0).result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)  # who interrupts waits for nothing that is still at work


def beside(work: Callable[[], Result], threads: int | None = None) -> Callable[[], Result]:
    """Begin work in a thread beside the caller, and return what waits for its result.

    Where no more than one thread is allowed, it is done when its result is asked for.

    >>> beside(lambda: 3)()
    3
    """
    if (cores() if threads is None else threads) <= 1:
        return work
    pool = ThreadPoolExecutor(1)
    result = pool.submit(copy_context().run, work)
    pool.shutdown(wait=False)
    return result.result


Progress = Callable[[int, int], None]
"""Called with (steps done, steps in all)."""


def step_counter(progress: Progress | None, total: int) -> Callable[[], None]:
    """A function to call after each of `total` steps; where there are more after all, the total grows.

    >>> step = step_counter(lambda done, total: print(f"{done} of {total}"), 2)
    >>> step(); step()
    1 of 2
    2 of 2
    """
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, max(done, total))

    return step
