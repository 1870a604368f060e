"""The nominal person beside a set: quick d′ between icons that are tried out and those that stay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..identification.from_memory import dprimes_from_memory
from ..identification.run_end import run_end_s
from ..observer.observer import Norm, Observer
from ..ranking.assemble import objection
from ..sensation.percept import perceive_many, uniform_clock

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon

RATE_HZ = 25.0
BLOCK = 4
"""Fewer icons are solved together with repetitions: by the code that people need anyway, not by another for one."""


@dataclass(frozen=True, slots=True)
class Sensed:
    """Sensations (icons, n_time) of the nominal person on one clock, and the traces that they come from."""

    cold: Array
    warm: Array
    dt_s: float
    traces: tuple[Trace, ...]

    def objection(self, place: int) -> str | None:
        """What speaks against playing an icon, None where nothing does; judged only when asked, since it takes long."""
        return objection(self.traces[place])

    def objections(self) -> tuple[str | None, ...]:
        """What speaks against each icon."""
        return tuple(map(objection, self.traces))


def sense(icons: Sequence[Icon], rig: Rig, end_s: float, observer: Observer | None = None) -> Sensed:
    """Play icons on the rig until `end_s` and feel them."""
    from thermicon.circuit.solver.simulate import simulate_all

    person = Observer.load() if observer is None else observer
    padded = [*icons, *[icons[-1]] * (BLOCK - len(icons))]
    traces = simulate_all(padded, rig, end_s=end_s, rate_Hz=RATE_HZ)[: len(icons)]
    dt, rows = uniform_clock(traces[0].time_s)
    cold, warm = perceive_many(
        np.array([trace.cold_receptor_C[:rows] for trace in traces]),
        np.array([trace.warm_receptor_C[:rows] for trace in traces]),
        dt,
        person,
        area_m2=rig.contact.area_m2,
        site=rig.site,
    )
    return Sensed(cold, warm, dt, tuple(traces))


def dprimes(tried: Sensed, kept: Sensed, norm: Norm, observer: Observer | None = None) -> Array:
    """d′ from memory (tried, kept) of every icon that is tried to every one that is kept, on the longer clock."""
    person = Observer.load() if observer is None else observer
    n = max(tried.cold.shape[1], kept.cold.shape[1])
    one, other = (_held(tried.cold, n), _held(tried.warm, n)), (_held(kept.cold, n), _held(kept.warm, n))
    names, kept_names = ([trace.icon or "" for trace in sensed.traces] for sensed in (tried, kept))
    return dprimes_from_memory(one, other, tried.dt_s, person, norm, (names, kept_names))


def end_of(durations_s: Sequence[float]) -> float:
    """When a run of the longest of them has faded, on a whole row: its end and 10 s."""
    return run_end_s(durations_s, RATE_HZ)


def _held(psi: Array, n: int) -> Array:
    return np.pad(psi, ((0, 0), (0, n - psi.shape[1])), mode="edge")
