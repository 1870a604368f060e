"""Steps of a long computation, counted for whoever shows how far it has come."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Called with (steps done, steps in all)."""


def step_counter(progress: Progress | None, total: int) -> Callable[[], None]:
    """What is called after each of `total` steps; where there are more after all, the total grows.

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
