"""Spans of what the experiments behind the constants play.

A laboratory that writes down what is played in it runs each experiment once, so that a row with other conditions moves
a span by itself. Experiments whose rows are all signs move none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from thermicon.base.numbers.arrays import Array

from ..experiments.laboratory import Corner, Laboratory
from ..experiments.published import AGES_YEARS, EXPERIMENTS
from ..experiments.tasks import Key
from ..observer.channels import Channel
from ..observer.constants import Both
from ..observer.observer import Observer
from ..observer.priors import LABORATORIES
from ..sensation.coverage import RESPECTS, EvidenceSpan
from .rows import load_rows

FEW = 2
"""People in the laboratory: who is asked changes nothing of what is played."""
Simulated = Callable[[Laboratory], Iterator[tuple[Key, float]]]


@dataclass(frozen=True)
class WritingLaboratory(Laboratory):
    """A laboratory in which each stimulus is written down, as a respect with its value."""

    played: list[tuple[str, float]] = field(default_factory=list, kw_only=True, compare=False)

    def drive(
        self, site_rig: str, channel: Channel, baseline_C: float, corners: Sequence[Corner], end_s: float
    ) -> Array:
        """Receptor drive; the resting temperature, and size, rate and duration of what is played, are written down."""
        if corners:
            course = [(0.0, 0.0), *corners]
            rates = [abs(level - before) / (time - start) for (start, before), (time, level) in pairwise(course)]
            self.played.append(("rest", baseline_C))
            self.played.append(("size", max(abs(level) for _, level in corners)))
            self.played.extend(("rate", rate) for rate in rates if rate > 0.0)
            self.played.append(("duration", end_s))
        return super().drive(site_rig, channel, baseline_C, corners, end_s)

    def gain(self, channel: Channel, area_cm2: float, laboratory: str, site: str, age_years: float) -> float:
        """Multiples of threshold per unit of drive; area and age are written down."""
        self.played.extend([("area", area_cm2), ("age", age_years)])
        return super().gain(channel, area_cm2, laboratory, site, age_years)


def spans_of(experiments: Iterable[Simulated] = EXPERIMENTS) -> tuple[EvidenceSpan, ...]:
    """The span of each respect over some experiments, with the experiments at its ends."""
    signs = {row.key for row in load_rows() if row.kind == "sign"}
    offsets = dict.fromkeys(LABORATORIES, Both(0.0, 0.0))
    values: dict[str, list[tuple[float, str]]] = {}
    for experiment in experiments:
        laboratory = WritingLaboratory.of(Observer.load(), offsets, FEW)
        keys = [key for key, _ in experiment(laboratory)]
        # A direction says next to nothing of the conditions it was found under, some of which are assumed.
        if signs.issuperset(keys):
            continue
        names = dict.fromkeys(key[0] for key in keys)
        ages = [("age", years) for name in names for years in AGES_YEARS.get(name, ())]
        for respect, value in (*laboratory.played, *ages):
            values.setdefault(respect, []).append((value, ", ".join(names)))
    return tuple(EvidenceSpan(name, unit, *min(values[name]), *max(values[name])) for name, unit in RESPECTS.items())
