"""Rules about all elements of a layout together that the gate of each does not ask.

What is drawn from one supply is the largest of each element, added, whatever their clocks do; only where that is too
much it is the sum on one clock, and then the hardware must have one. So it is with warm and cold elements near each
other on one piece of skin. A single fault takes one element to its limit, or all where the host is lost; it is cut off
after a moment, so what it does to sums and neighbours is reported and refuses nothing. A channel that is late changes
no element, only sums and neighbours, which is what an offset is allowed for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import ceil, inf, nan
from typing import NamedTuple

import numpy as np

from thermicon.base.files.records import Record, RecordTable, shipped_records
from thermicon.base.numbers.arrays import Array

from ..rig.layout import Layout
from .checks import Check, Judged, Scenario

STEP_S = 0.01
"""Rows of loads; no two channels are closer in time than this."""
OFFSETS_S = (10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, STEP_S)
"""Offsets between channels that are tried, the largest first."""
APART = "smaller changes, the qualities one after the other, or elements farther apart"
ANY_CLOCK, ONE_CLOCK = "any offset between elements", "all elements on one clock"


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """What one element does in one icon, in the worst of its corners, in rows of STEP_S on the clock of all.

    `current_A` and `power_W` (rows,) are what it draws from the supply, `warm_C` (rows,) its display while it is warmer
    than at rest, `chill_C` (rows,) minus its display while it is colder, both −∞ else. `stuck` is what its driver draws
    at its limit, in A and W, `cut_C` between which temperatures in °C a cut-off keeps its display.
    """

    plays: bool
    current_A: Array
    power_W: Array
    warm_C: Array
    chill_C: Array
    stuck: tuple[float, float] = (0.0, 0.0)
    cut_C: tuple[float, float] = (-inf, inf)


class Bound(NamedTuple):
    """A limit of what all elements do together."""

    quantity: str
    severity: str
    limit: float
    unit: str
    source: str


Icons = Sequence[Sequence[Load]]
"""What each element does in each icon: icons, then elements in the order of the layout."""


@dataclass(frozen=True, slots=True)
class Whole(Judged):
    """The verdict on all elements together; `offset_s`: how far apart in s channels may be at most, None: at will."""

    checks: tuple[Check, ...]
    offset_s: float | None = None

    @property
    def cure(self) -> str:
        """What keeps the first hard limit that is exceeded."""
        worst = self.findings[0]
        if "supply" not in worst.quantity:
            return f"use {APART}"
        enough = ceil(100.0 * worst.value) / 100.0
        return f"use less current, fewer elements at one time, or a [supply] of {enough:g} {worst.unit} or more"

    def to_dict(self) -> dict[str, object]:
        """All of it in the form of a sidecar."""
        return {
            "largest_offset_s": self.offset_s,
            "together": {
                "colour": self.colour,
                "reason": self.reason,
                "checks": [check.to_dict() for check in self.checks],
            },
        }


def judge_whole(layout: Layout, icons: Icons) -> Whole:
    """Check what the elements of a layout do together, in any of the icons and with single faults."""
    checks: list[Check] = []
    offsets: list[float] = []
    for check, offset_s in (*_supply(layout, icons), *_opposite(layout, icons)):
        checks.append(check)
        if offset_s is not None:
            offsets.append(offset_s)
    faulty = [check for check in _faults(layout, icons) if not check.passed]
    return Whole((*checks, _area(layout, icons), *faulty), min(offsets, default=None))


def _check(bound: Bound, value: float, way: str, at_s: float = nan) -> Check:
    since_s = at_s if value > bound.limit else None
    run = Scenario(way=way)
    return Check(bound.quantity, bound.severity, value, bound.limit, bound.unit, at_s, since_s, bound.source, run=run)


def _bound(record: Record) -> Bound:
    return Bound(record.quantity, str(record.get("severity")), record.central, record.unit, record.source)


def _table() -> RecordTable:
    return shipped_records("whole-limits.toml", "severity", "cold_C")


def _late(icons: Icons, what: str, offset_s: float) -> Iterator[list[Array]]:
    """In each icon the greatest of each element (rows,) that is late by up to an offset.

    Before its first row it may still be in the end of any icon, since a pause may be shorter than the offset.
    """
    count = round(offset_s / STEP_S)
    courses = [[getattr(load, what) for load in icon] for icon in icons]
    padded = [[np.pad(each, (count, 0), mode="edge")[-count:] for each in icon] for icon in courses]
    ends = [np.max(each, axis=0) for each in zip(*padded, strict=True)]
    for icon in courses:
        longer = [np.concatenate(both) for both in zip(ends, icon, strict=True)]
        yield [np.lib.stride_tricks.sliding_window_view(each, count + 1).max(axis=-1) for each in longer]


def _judged(bound: Bound, any_clock: float, courses: Callable[[float], Iterable[Array]]) -> tuple[Check, float | None]:
    """What is reached whatever the clocks do or, where that is too much, with channels an offset apart; and the offset.

    `courses` gives what is reached in rows at an offset in s; 0 is returned where none is small enough.
    """
    if any_clock <= bound.limit:
        return _check(bound, any_clock, ANY_CLOCK), None
    for offset_s in OFFSETS_S:
        worst = max(courses(offset_s), key=lambda course: float(course.max()))
        check = _check(bound, float(worst.max()), ONE_CLOCK, STEP_S * int(worst.argmax()))
        if check.passed:
            return check, offset_s
    return check, 0.0


def _supplied(layout: Layout) -> list[tuple[str, Bound]]:
    """What the supply limits: the attribute of a load, and the limit."""
    if layout.supply is None:
        return []
    limits = (("current", layout.supply.current_limit_A, "A"), ("power", layout.supply.power_limit_W, "W"))
    return [
        (f"{what}_{unit}", Bound(f"{what} from the supply", "hard", limit, unit, "[supply] of the layout"))
        for what, limit, unit in limits
    ]


def _supply(layout: Layout, icons: Icons) -> Iterator[tuple[Check, float | None]]:
    """What all drivers together draw from the supply."""
    for what, bound in _supplied(layout):

        def sums(offset_s: float, what: str = what) -> Iterator[Array]:
            return (np.sum(icon, axis=0) for icon in _late(icons, what, offset_s))

        yield _judged(bound, sum(_most(icons, what)), sums)


def _most(icons: Icons, what: str) -> list[float]:
    """The greatest value of each element in any icon."""
    return [max(float(getattr(load, what).max()) for load in loads) for loads in zip(*icons, strict=True)]


def _near(layout: Layout) -> list[tuple[int, int]]:
    """Places of a warm and a cold element that are near each other on one piece of skin."""
    if layout.surfaces == "apart":
        return []
    return [pair for a, b in layout.near for pair in ((a, b), (b, a))]


def _opposite(layout: Layout, icons: Icons) -> Iterator[tuple[Check, float | None]]:
    """Warm and cold at one time near each other: how far apart they are, and how warm beside what is cold."""
    pairs, beside = _near(layout), _table().one("warm beside cold")
    cold_C = float(beside.get("cold_C"))
    warmest, coldest = _most(icons, "warm_C"), [-each for each in _most(icons, "chill_C")]

    def apart_K(warm_C: Array, cold_C: Array) -> Array:
        return warm_C - cold_C

    def warm_C(warm_C: Array, beside_C: Array) -> Array:
        return np.where(beside_C <= cold_C, warm_C, -inf)

    rules = [(record, apart_K) for record in _table().select("opposite qualities")]
    for record, rule in (*rules, (beside, warm_C)):
        most = max((float(rule(np.array(warmest[a]), np.array(coldest[b]))) for a, b in pairs), default=-inf)
        if most == -inf:
            continue

        def courses(offset_s: float, rule: Callable[[Array, Array], Array] = rule) -> Iterator[Array]:
            both = zip(_late(icons, "warm_C", offset_s), _late(icons, "chill_C", offset_s), strict=True)
            return (rule(warm[a], -chill[b]) for warm, chill in both for a, b in pairs)

        check, offset_s = _judged(_bound(record), most, courses)
        yield check, offset_s if check.severity == "hard" else None


def _area(layout: Layout, icons: Icons) -> Check:
    """The skin that elements touch that play in one icon."""
    areas = [element.rig.contact.area_m2 * 1e4 for element in layout.elements]
    most = max(sum(area for area, load in zip(areas, icon, strict=True) if load.plays) for icon in icons)
    return _check(_bound(_table().one("area at once")), most, "")


def _faults(layout: Layout, icons: Icons) -> Iterator[Check]:
    """What one element at its limit, or all at their cut-offs where the host is lost, does to sums and neighbours."""
    names = [element.name for element in layout.elements]
    for place, (what, bound) in enumerate(_supplied(layout)):
        largest = _most(icons, what)
        for name, own, loads in zip(names, largest, zip(*icons, strict=True), strict=True):
            if (stuck := max(load.stuck[place] for load in loads)) > own:
                way = f"{name} stuck at the limit of its driver"
                yield _check(bound._replace(severity="soft"), sum(largest) - own + stuck, way)
    warmest, coldest = _most(icons, "warm_C"), [-each for each in _most(icons, "chill_C")]
    *_, hard = map(_bound, _table().select("opposite qualities"))
    for a, b in _near(layout):
        (_, high_C), (low_C, _) = icons[0][a].cut_C, icons[0][b].cut_C
        for warm_C, cold_C, way in (
            (high_C, coldest[b], f"{names[a]} stuck warm until it is cut off"),
            (warmest[a], low_C, f"{names[b]} stuck cold until it is cut off"),
        ):
            if np.isfinite(warm_C - cold_C):
                yield _check(hard._replace(severity="soft"), warm_C - cold_C, way)
