"""Events of a cue for markers: when its ramps begin, when a level is reached, when it returns, when it ends."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby, pairwise

from thermicon.icons.model.corners import Corners

STILL = 1e-9
"""A slope below this, in K/s or A/s, counts as level."""


@dataclass(frozen=True, slots=True)
class Event:
    """What the cue prescribes at a time in s; `level` in the unit of its corners (°C or A)."""

    name: str
    time_s: float
    level: float


def events_of(corners: Corners, lead_s: float = 0.0) -> tuple[Event, ...]:
    """Return the events of a cue that begins at `lead_s`: start and end of every stretch that rises or falls.

    A stretch that ends at the level the cue began with is a return. Times are those that the cue prescribes.

    >>> [(event.name, event.time_s) for event in events_of(Corners((0, 2, 6, 8), (32, 26, 26, 32), "temperature_C"))]
    [('ramp start', 0.0), ('target reached', 2.0), ('return start', 6.0), ('baseline reached', 8.0), ('end', 8.0)]
    """
    points = list(zip(corners.time_s, corners.value, strict=True))
    rest = corners.value[0]
    steps = [(_direction(a, b), a, b) for a, b in pairwise(points)]
    events: list[Event] = []
    for direction, stretch in groupby(steps, key=lambda step: step[0]):
        pieces = list(stretch)
        (begin, from_), (end, to) = pieces[0][1], pieces[-1][2]
        if direction:
            back = abs(to - rest) < 1e-9
            events.append(Event("return start" if back else "ramp start", lead_s + begin, from_))
            events.append(Event("baseline reached" if back else "target reached", lead_s + end, to))
    return (*events, Event("end", lead_s + corners.duration_s, corners.value[-1]))


def _direction(a: tuple[float, float], b: tuple[float, float]) -> int:
    slope = (b[1] - a[1]) / (b[0] - a[0])
    return 0 if abs(slope) < STILL else 1 if slope > 0 else -1
