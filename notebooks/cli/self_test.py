"""The self-test: one shipped icon through circuit and perception, compared with numbers that are stored beside it.

It runs in a process of its own, so that compiled code that crashes is reported like any other fault.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from time import perf_counter

from .packages import Finding, run_program

STORED = "self-test.toml"
WAITS_S = 600.0
"""Given up after this time. Without compiled code in the cache it takes up to a minute, on a busy machine some."""
REINSTALL = (
    "install thermicon again in a new environment; if that does not help, report it with thermicon doctor --json"
)


@dataclass(frozen=True, slots=True)
class Stored:
    """A stored number, its unit, and by how much it may differ between machines and versions of libraries."""

    name: str
    value: float
    unit: str
    tolerance: float

    def differs(self, computed: Mapping[str, float]) -> str | None:
        """Return a sentence where the computed number is another one, None where it agrees.

        >>> Stored("onset", 1.13, "s", 0.01).differs({"onset": 1.125})
        >>> Stored("onset", 1.13, "s", 0.01).differs({"onset": 1.2})
        'onset is 1.2 s and should be 1.13 ± 0.01 s'
        """
        value = computed.get(self.name, math.nan)
        if abs(value - self.value) <= self.tolerance:
            return None
        return f"{self.name} is {value:g} {self.unit} and should be {self.value:g} ± {self.tolerance:g} {self.unit}"


@dataclass(frozen=True, slots=True)
class Case:
    """The icon that is played, the rig, and the stored numbers."""

    set_name: str
    icon: str
    rig: str
    numbers: tuple[Stored, ...]

    @classmethod
    def shipped(cls) -> Case:
        """Read the stored case."""
        text = resources.files("thermicon.notebooks").joinpath("data", STORED).read_text("utf-8")
        data = tomllib.loads(text)
        return cls(data["set"], data["icon"], data["rig"], tuple(Stored(**each) for each in data["number"]))


def compute(case: Case) -> dict[str, float]:
    """Play the icon of a case and predict what is felt; the numbers by their names in the stored case."""
    from thermicon.circuit import Rig, simulate
    from thermicon.icons import load_library
    from thermicon.perception import perceive

    trace = simulate(load_library(case.set_name)[case.icon], Rig.load(case.rig), tail_s=10.0)
    percept = perceive(trace)
    return {
        "largest current": float(abs(trace.current_A).max()),
        "coldest skin": float(trace.skin_C.min()),
        "coldest cold receptor": float(trace.cold_receptor_C.min()),
        "detected probability": percept.detected_probability,
        "onset": math.nan if percept.onset_s is None else percept.onset_s,
        "peak of the cold channel": float(percept.psi_cold.max()),
    }


def check_self_test(command: Sequence[str] = ()) -> Iterator[Finding]:
    """Run the self-test in a process of its own and compare its numbers with the stored ones."""
    case = Case.shipped()
    begun = perf_counter()
    program = [*(command or (sys.executable, "-P", "-m", __name__))]
    try:
        run = run_program(program, WAITS_S, {**os.environ, "PYTHONIOENCODING": "utf-8"})
    except subprocess.TimeoutExpired:
        yield Finding("self-test", "fault", f"not ended after {WAITS_S:g} s", "end other programs and run it again")
        return
    if run.returncode != 0:
        last = next((line for line in reversed(run.stderr.splitlines()) if line.strip()), "without a message")
        end = (
            f"ended with exit code {run.returncode}" if run.returncode > 0 else f"was ended by signal {-run.returncode}"
        )
        yield Finding("self-test", "fault", f"{end}: {last.strip()}", f"mend the faults above; else {REINSTALL}")
        return
    computed = json.loads(run.stdout)
    differences = [words for each in case.numbers if (words := each.differs(computed))]
    played = f"{case.icon} of {case.set_name} on the {case.rig} rig"
    for words in differences:
        yield Finding("self-test", "fault", f"{played}: {words}", REINSTALL)
    if not differences:
        text = f"{played} gives the {len(case.numbers)} stored numbers ({perf_counter() - begun:.1f} s)"
        yield Finding("self-test", "ok", text)


if __name__ == "__main__":
    sys.stdout.write(json.dumps(compute(Case.shipped())) + "\n")
