"""Times of runs: medians and spreads, of a function in this process or of a whole command."""

from __future__ import annotations

import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

LEAST_S, SHORTEST_S = 0.05, 1e-6
"""Some systems count processor time in ticks of 4 ms, so that a shorter run would count one or none."""
COMMAND = "from thermicon.notebooks.cli.main import main; main()"


@dataclass(frozen=True, slots=True)
class Timing:
    """Elapsed and processor times in s of several runs of one thing; `memory_MB` is the most that a process had.

    >>> Timing((0.2, 0.1, 0.4), (0.1, 0.1, 0.2)).processor_s
    0.1
    """

    seconds: tuple[float, ...]
    processor: tuple[float, ...]
    memory_MB: float | None = None

    def __post_init__(self) -> None:
        if not self.seconds or min(*self.seconds, *self.processor) < 0 or len(self.seconds) != len(self.processor):
            raise ValueError("a timing needs an elapsed and a processor time of each run, none of them below 0 s")

    @property
    def median_s(self) -> float:
        """Median elapsed time in s: what is waited for."""
        return statistics.median(self.seconds)

    @property
    def processor_s(self) -> float:
        """Median processor time in s of all threads and processes: what other programs change least."""
        return statistics.median(self.processor)

    def over(self, count: int) -> Timing:
        """The time of one of so many things that a run does."""
        seconds, processor = (tuple(each / count for each in times) for times in (self.seconds, self.processor))
        return Timing(seconds, processor, self.memory_MB)

    def times(self, count: int) -> Timing:
        """The time of so many of it."""
        seconds, processor = (tuple(each * count for each in times) for times in (self.seconds, self.processor))
        return Timing(seconds, processor, self.memory_MB)


def timed(run: Callable[[], Any], *, most: int = 10, budget_s: float = 2.0) -> Timing:
    """Time a function: runs that do not count, then up to `most` that do, fewer where `budget_s` is used up.

    What is quicker than `LEAST_S` is called several times in a run, which counts as their mean.

    >>> len(timed(lambda: None, most=3).seconds)
    3
    """
    run()
    start = time.perf_counter()
    run()
    calls = max(1, math.ceil(LEAST_S / max(time.perf_counter() - start, SHORTEST_S)))
    seconds: list[float] = []
    processor: list[float] = []
    while len(seconds) < most and (not seconds or sum(seconds) * calls < budget_s):
        start, used = time.perf_counter(), _processor_s()
        for _ in range(calls):
            run()
        seconds.append((time.perf_counter() - start) / calls)
        processor.append(max(0.0, _processor_s() - used) / calls)
    return Timing(tuple(seconds), tuple(processor))


def command_timed(
    words: Sequence[str], times: int, environment: Mapping[str, str] | None = None, code: str = COMMAND
) -> Timing:
    """Time a command of thermicon as it is typed, or other `code`, the start of Python included.

    Python keeps the byte code of what it imports, as it does by default. Raises `RuntimeError`
    with the command's own message where it fails.
    """
    seconds: list[float] = []
    processor: list[float] = []
    memory_MB = 0.0
    usual = dict(os.environ if environment is None else environment)
    usual.pop("PYTHONDONTWRITEBYTECODE", None)
    for _ in range(times):
        with tempfile.TemporaryFile() as messages:
            start, used = time.perf_counter(), _processor_s()
            run = subprocess.Popen(
                [sys.executable, "-P", "-c", code, *words],
                stdout=subprocess.DEVNULL,
                stderr=messages,
                env=usual,
            )
            memory_MB = max(memory_MB, _waited_MB(run))
            seconds.append(time.perf_counter() - start)
            processor.append(max(0.0, _processor_s() - used))
            if run.returncode:
                messages.seek(0)
                said = messages.read().decode(errors="replace").strip()[-300:]
                raise RuntimeError(f"thermicon {' '.join(words)} ended with {run.returncode}: {said}")
    return Timing(tuple(seconds), tuple(processor), memory_MB or None)


def _processor_s() -> float:
    """Processor time in s of this process, and of its children that have ended, where the system says."""
    try:
        import resource
    except ImportError:  # Windows
        return time.process_time()
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def _waited_MB(run: subprocess.Popen[bytes]) -> float:
    """Wait for a process; the most memory in MB that it had, 0 where the system does not say.

    A new process begins as a copy of this one, so that less than what this one had is not known.
    """
    if not hasattr(os, "wait4"):  # Windows
        run.wait()
        return 0.0
    import resource

    _, status, usage = os.wait4(run.pid, 0)
    run.returncode = os.waitstatus_to_exitcode(status)
    copied = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    most = usage.ru_maxrss if usage.ru_maxrss > copied else 0
    return float(most) / (1024.0 if sys.platform != "darwin" else 1024.0**2)
