"""What a benchmark finds: timings in sections, and curves of growth."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .measure import Timing


@dataclass(frozen=True, slots=True)
class Entry:
    """One thing that was timed; `times` is its processor time over that of what it is compared with, `against`."""

    name: str
    timing: Timing
    times: float | None = None
    against: str = ""


@dataclass(frozen=True, slots=True)
class Section:
    """Entries under a title, with a sentence on what each does."""

    title: str
    about: str
    entries: tuple[Entry, ...]


@dataclass(frozen=True, slots=True)
class Curve:
    """Timings over the size of a problem."""

    title: str
    axis: str
    sizes: tuple[int, ...]
    timings: tuple[Timing, ...]

    @property
    def growth(self) -> float:
        """Exponent of processor time over size, from the two largest sizes: 1 where it is proportional."""
        (a, b), (s, t) = self.sizes[-2:], (each.processor_s for each in self.timings[-2:])
        return math.log(t / s) / math.log(b / a)


@dataclass(frozen=True, slots=True)
class BenchResult:
    """Everything that one run of the benchmark found; `machine` are facts in words."""

    machine: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]
    curves: tuple[Curve, ...]
