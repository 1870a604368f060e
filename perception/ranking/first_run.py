"""The first run of an installation: other processes compile what this one needs later, and leave it in the cache.

numba compiles one function at a time in a process. A ranking comes to its compiled code in a known order, so that each
further core can prepare a part of it in time, by a run that is as small as possible. Nothing depends on them.

``python -m thermicon.perception.ranking.first_run PART`` prepares one part and notes that it did.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from thermicon.circuit.cores import cores


def prepare_people() -> None:
    """Compile what judges people, on two people and three short icons."""
    from thermicon.circuit import Rig
    from thermicon.circuit.solver.batch import Batch
    from thermicon.icons import load_library

    from ..identification.population import PROBES
    from ..identification.run_end import RATE_HZ
    from ..observer.observer_model import ObserverModel
    from .batches import Job, judge_people

    icons, end_s = tuple(load_library("six-icons"))[:3], 4.0
    clock = np.arange(round(end_s * RATE_HZ) + 1) / RATE_HZ
    felt = 33.0 + np.outer([-1.0, 1.0, 0.5], np.clip(2.0 * (clock - 1.0), 0.0, 3.0))
    values = np.broadcast_to(felt, (len(PROBES), 2, *felt.shape)).copy()
    values.setflags(write=False)
    model = ObserverModel.of(None)
    job = Job(icons, Rig.load("thenar"), end_s, 2, 0, 48, None, "episodes")
    judge_people(job, model.people(2, 0), Batch(clock, PROBES, values), model, 0)


def prepare_limits() -> None:
    """Compile the checks of a run against the limits of safety, and the superposition of responses."""
    from thermicon.circuit import Rig, simulate_many
    from thermicon.circuit.safety.limits import checks_of
    from thermicon.circuit.safety.tally import WATCHED
    from thermicon.icons import parse

    from ..identification.population import PROBES

    rig = Rig.load("thenar")
    clock = 0.01 * np.arange(3, dtype=np.float64)
    clock.setflags(write=False)
    checks_of(rig.limits, clock, {name: np.full((1, 3), 33.0) for name in WATCHED})
    icons = tuple(parse("cue 1\nset s { control display }\nicon dip { cool by 0.1 °C at 1 °C/s }\n"))
    simulate_many(icons, [rig] * 4, nominal=rig, end_s=0.2, probes=PROBES)


PARTS: dict[str, Callable[[], None]] = {"people": prepare_people, "limits": prepare_limits}
"""By how long they take. This process begins with what solves the circuit, and meets the others where they are done."""


def begin() -> int:
    """Start a process for each part that was never prepared, as far as there are cores; returns how many.

    They end by themselves. Where code cannot be kept, or no process can be started, there are none.
    """
    from thermicon.circuit.compiled_ahead import brought

    started, ahead = 0, brought()
    for part in list(PARTS)[: cores() - 1]:
        note = _note(part)
        if note is None or note.exists() or (ahead is not None and (ahead / note.name).exists()):
            continue
        with suppress(OSError):
            # -P: a folder in which somebody works is no place to import from
            subprocess.Popen(
                [sys.executable, "-P", "-m", __name__, part],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            started += 1
    return started


def _note(part: str) -> Path | None:
    """The empty file that says that a part was prepared from the present sources; None where nothing can be kept."""
    from thermicon.circuit.compiled import kept_in, source_digest
    from thermicon.circuit.safety import tally_kernel
    from thermicon.circuit.solver import kernel_superposed

    from ..kernels import alignment, episodes, reports

    folder = kept_in()
    if folder is None:
        return None
    used = {
        "people": (reports.report, episodes.all_episodes, alignment.distances),
        "limits": (tally_kernel.count, kernel_superposed.superpose),
    }[part]
    digests = "".join(source_digest(each.py_func) for each in used)
    return folder / f"prepared-{part}-{hashlib.sha256(digests.encode()).hexdigest()[:24]}"


def main(part: str) -> None:
    """Prepare a part and note it."""
    from thermicon.icons.userfolder import write_private

    PARTS[part]()
    note = _note(part)
    if note is not None:
        write_private(note, b"")


if __name__ == "__main__":
    main(sys.argv[1])
