"""A first ranking compiles in two processes: its own, and one beside it for what is needed after the first percepts."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from thermicon.base.numbers.compiled import kept_in
from thermicon.icons import parse

from ..identification.confusion import confuse, name_directly
from ..identification.episodes import Episodes, episode_distances
from ..observer.observer import Observer
from .scores import objection

LONGEST_S = 120.0
"""A process that takes longer is ended; who waits for it then compiles."""


def compiled_beside(cores: int) -> Callable[[], None]:
    """Begin to compile in a process beside this one, and return what waits for it.

    There is none on one core, nor where code cannot be kept or is there already. One that fails leaves the work undone.
    """
    folder = kept_in() if cores > 1 and sys.executable else None
    if folder is None or any(folder.glob("*/alignment.*.nbi")):
        return lambda: None
    nothing, command = subprocess.DEVNULL, [sys.executable, "-P", "-m", __name__]  # -P: nothing of the working folder
    try:
        process = subprocess.Popen(command, stdin=nothing, stdout=nothing, stderr=nothing)
    except OSError:
        return lambda: None

    def wait() -> None:
        with process, suppress(subprocess.TimeoutExpired):
            try:
                process.wait(LONGEST_S)
            finally:
                process.kill()

    return wait


def compile_late() -> None:
    """Compile what finds, compares and names episodes, and what judges a trace: by using it on next to nothing."""
    from thermicon.circuit import Rig, simulate

    observer, nothing = Observer.load(), np.zeros((1, 3, 2))
    felt = Episodes.of(nothing, nothing, 1.0, observer)
    confuse(episode_distances(felt, felt, observer, "episodes"), samples=1)
    name_directly(felt, observer, samples=1)
    objection(
        simulate(parse("cue 1; icon dip { cool by 1 °C at 1 °C/s; return at 1 °C/s }")["dip"], Rig.load("thenar"))
    )


if __name__ == "__main__":
    compile_late()
