"""Carry-over from an icon to the next.

People who differ in their thresholds feel every icon after every other one: for a single person, what is left falls out
of memory at one gap. Between the display and the receptors the skin is linear, so that what is left of the icon before
adds to what the next one brings; adaptation, which is not, is then run over both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..kernels.parallel import in_order
from ..observer.channels import MEMORY_FORMS, MemoryForm
from ..observer.observer import Observer
from ..observer.people import draw_people
from ..sensation.percept import perceive_many
from ..sensation.received import received, uniform_clock
from .episodes import Episodes, episode_distances
from .task import USUAL, Task

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon

RATE_HZ = 25.0
PEOPLE = 32


@dataclass(frozen=True, slots=True)
class CarryOver:
    """d′ of every icon (column) after every other (row) from itself alone: `apart` (forms, icons, icons)."""

    names: tuple[str, ...]
    gap_s: float
    apart: Array

    def over(self, places: Sequence[int]) -> Array:
        """Root mean square (forms, icons) over some icons before, each of them as likely as the next."""
        return np.asarray(np.sqrt((self.apart[:, list(places)] ** 2).mean(axis=1)))

    def worst_of(self, place: int, form: MemoryForm, places: Sequence[int] = ()) -> tuple[str, float]:
        """After which icon (of some) one feels least like itself, and by how many d′ from memory."""
        k, some = MEMORY_FORMS.index(form), list(places or range(len(self.names)))
        before = some[int(self.apart[k, some, place].argmax())]
        return self.names[before], float(self.apart[k, before, place])


def carry_over(
    icons: Sequence[Icon],
    rig: Rig,
    end_s: float,
    gap_s: float,
    observer: Observer | None = None,
    *,
    tracking: str | None = None,
) -> CarryOver:
    """Let people feel every icon of a set after every other, each followed for `end_s`, which is after its end.

    The driver holds skin or display in the gap, or, with `tracking` `replay`, the resting current flows uncorrected.
    """
    from thermicon.circuit.solver.simulate import duration_s, simulate_all

    lasting = [duration_s(icon, rig) for icon in icons]
    person = Observer.load() if observer is None else observer
    waits = [max(1, round((lasted + gap_s) * RATE_HZ)) for lasted in lasting]
    rows = round(end_s * RATE_HZ) + 1
    last = (max(waits) + rows) / RATE_HZ
    traces = simulate_all(list(icons), rig, end_s=last, rate_Hz=RATE_HZ)
    leaving = [_replayed(icon, rig, last) for icon in icons] if tracking == "replay" else traces
    dt, _ = uniform_clock(traces[0].time_s)
    met, left = (np.stack([received(trace, person) for trace in each], axis=1) for each in (traces, leaving))

    def for_one(thresholds: tuple[float, float]) -> Array:
        def felt(at_cold: Array, at_warm: Array) -> Array:
            psi = perceive_many(
                at_cold, at_warm, dt, person, area_m2=rig.contact.area_m2, site=rig.site,
                threshold_cold=thresholds[0], threshold_warm=thresholds[1],
            )  # fmt: skip
            return np.stack(psi)

        alone = felt(*(received[:, :rows] for received in met))
        apart = np.empty((len(MEMORY_FORMS), len(icons), len(icons)))
        for before, wait in enumerate(waits):
            parts = zip(left, met, strict=True)
            after = felt(*(_after(own[before], received, wait, rows) for own, received in parts))[..., wait:]
            pairs = np.stack([alone, after], axis=2)
            episodes = Episodes.of(pairs[0], pairs[1], dt, person, [[icon.name] for icon in icons])
            for k, form in enumerate(MEMORY_FORMS):
                apart[k, before] = episode_distances(episodes, episodes, person, form)[:, 0, 1]
        return apart

    people = draw_people(PEOPLE)
    thresholds = list(zip(people.threshold_cold.tolist(), people.threshold_warm.tolist(), strict=True))
    apart = np.mean(list(in_order(for_one, thresholds)), axis=0)
    return CarryOver(tuple(icon.name for icon in icons), gap_s, apart)


def prepare_task(
    task: Task,
    icons: Sequence[Icon],
    rig: Rig,
    end_s: float,
    counted: Sequence[int] = (),
    tracking: str | None = None,
    observer: Observer | None = None,
) -> tuple[Task, CarryOver | None]:
    """A task filled in for some icons, of which `counted` (none: all) will be played; and what is left behind."""
    if task.gap_s is None:
        return USUAL, None
    played = tuple(counted or range(len(icons)))
    left = carry_over(icons, rig, end_s, task.gap_s, observer, tracking=tracking)
    return Task(task.gap_s, _rows(left.over(played)), played), left


def task_among(task: Task, left: CarryOver | None, places: Sequence[int]) -> Task:
    """The task for some icons of a set that are then asked for on their own."""
    return Task(task.gap_s, () if left is None else _rows(left.over(places)[:, list(places)]))


def _rows(values: Array) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(row) for row in values.tolist())


def _replayed(icon: Icon, rig: Rig, end_s: float) -> Trace:
    """The current of an icon open loop, and then its resting current until `end_s`, as exported drives are played."""
    from thermicon.circuit import Drive, design, simulate_current
    from thermicon.circuit.solver.simulate import duration_s

    plan = design(icon, rig, duration_s(icon, rig))
    times, currents = plan.drive.time_s, plan.drive.current_A
    if plan.drive.held:
        drive = Drive([*times, end_s], [*currents[:-1], plan.rest_A, plan.rest_A], held=True)
    else:
        drive = Drive([*times, times[-1] + 1e-3, end_s], [*currents, plan.rest_A, plan.rest_A])
    return simulate_current(drive, rig, rate_Hz=RATE_HZ, start_C=plan.start_C)


def _after(left: Array, received: Array, wait: int, rows: int) -> Array:
    """Every icon (icons, rows) begun `wait` rows into what another one leaves behind (rows,): (icons, wait + rows)."""
    whole = np.repeat(left[np.newaxis, : wait + rows], len(received), axis=0)
    whole[:, wait:] += received[:, :rows] - received[:, :1]
    return whole
