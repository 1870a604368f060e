"""Work beside the caller."""

import threading
import time

import pytest

from thermicon.base.numbers.cores import at_most, cores
from thermicon.perception.kernels.parallel import beside, in_order


@pytest.mark.parametrize("threads", [1, 2, None])
def test_what_it_gives_and_what_it_raises_reach_the_caller(threads: int | None) -> None:
    def failing() -> int:
        raise ValueError("no such icon")

    assert beside(lambda: 3, threads)() == 3
    result = beside(failing, threads)
    with pytest.raises(ValueError, match="no such icon"):
        result()


def test_who_stops_waits_for_nothing_that_is_still_at_work() -> None:
    done = threading.Event()
    each = in_order(lambda k: k == 0 or done.wait(60.0), range(4), 2)
    assert next(each)
    begun = time.monotonic()
    each.close()  # type: ignore[attr-defined]
    assert time.monotonic() - begun < 30.0
    done.set()


def test_it_keeps_to_the_cores_that_the_caller_may_use() -> None:
    with at_most(1):
        assert beside(cores, 2)() == 1
        assert beside(threading.current_thread)() is threading.current_thread(), "one core: no thread"
    assert beside(threading.current_thread, 2)() is not threading.current_thread()
