"""Rows of arrays spread over the machine's cores; the result does not depend on how many."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

SMALL = 200_000


def over_rows(work: Callable[[slice], None], rows: int, size: int) -> None:
    """Call `work` on slices that cover `rows`; in threads when `size` (elements) is worth it.

    `work` must treat rows independently and release the interpreter lock, as the kernels do.
    """
    chunks = min(os.cpu_count() or 1, 8, rows) if size > SMALL else 1
    if chunks <= 1:
        work(slice(0, rows))
        return
    edges = [rows * k // chunks for k in range(chunks + 1)]
    with ThreadPoolExecutor(chunks) as pool:
        for done in [pool.submit(work, slice(a, b)) for a, b in pairwise(edges)]:
            done.result()
