"""One thread for linear algebra as a setting of the process."""

import threading

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from thermicon.base.numbers.cores import quiet_blas


def threads() -> set[int]:
    np.linalg.eigh(np.eye(2))
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_linear_algebra_has_its_threads_back_whoever_leaves_last() -> None:
    inside, leave = threading.Event(), threading.Event()

    def other() -> None:
        with quiet_blas():
            inside.set()
            leave.wait()

    with threadpool_limits(limits=2, user_api="blas"):
        if not (before := threads()):
            pytest.skip("this library of linear algebra has no threads to limit")
        thread = threading.Thread(target=other)
        with quiet_blas():
            thread.start()
            inside.wait()
            assert threads() == {1}
        leave.set()
        thread.join()
        assert threads() == before
