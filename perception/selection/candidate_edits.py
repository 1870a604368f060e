"""Candidate edits that may separate a pair.

An edit changes one of the numbers that stand in an icon's statements, or repeats all of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, product

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array
from thermicon.circuit.solver.inverse import baseline_C
from thermicon.circuit.solver.simulate import duration_s
from thermicon.icons import CueErrors, Icon
from thermicon.icons.model.changes import Number, line_of, numbers_of, repeated, with_number
from thermicon.icons.model.statements import all_played

from ..identification.population import run_end_s
from ..observer.observer import MemoryForm, Observer
from ..ranking.scores import objection
from .pool import POOL_HZ, Pool

PER_SECOND = 0.1
TOLERANCE = 0.1
FAR = 2.0
"""A pair that falls by more than 0.1 d′ is made worse, unless it stays beyond twice the wanted d′."""
GRID = 6
ROUNDS = 4
"""Changes that every number is tried with in each direction, and how often the interval that is left is halved."""
DEARER = 1.5
"""Numbers whose change must be more than so many times the smallest one that is enough are not followed."""
REPEATS = (2, 3)
MOST_LONGER_S = 30.0
"""By more than this no edit makes an icon longer."""


Way = tuple[int, Number, bool]
"""Which icon, which of its numbers, and whether it becomes larger."""


@dataclass(frozen=True, slots=True)
class CandidateEdit:
    """An edit that is looked at: which icon, its line before and after, what it costs, and how much longer it is, s.

    `way` is the place of its number in the list of ways, None for a repeat, and `step` which of its trials this is;
    `apart` (icons,) is its d′ to the icons as they are, once it was felt.
    """

    place: int
    icon: Icon
    old: str
    new: str
    cost: float
    added_s: float
    way: int | None
    step: int
    apart: Array


@dataclass(frozen=True, slots=True)
class Screening:
    """The set as the nominal person feels it, with d′ (icons, icons), and the pair that is to be separated."""

    kept: Pool
    now: Array
    pair: tuple[int, int]
    wanted: float
    memory: MemoryForm
    observer: Observer


@dataclass(slots=True)
class Rejections:
    """Results of rejected edits: the largest d′ of a playable one, and whether any edit made another pair worse."""

    closest: float = 0.0
    opposed: bool = False


def worse(before: Array, after: Array, wanted: float) -> NDArray[np.bool_]:
    """Which pairs an edit makes worse."""
    return (after < before - TOLERANCE) & (after < FAR * wanted)


def offers(of: Screening, target: float, largest: float, rejected: Rejections) -> list[CandidateEdit]:
    """Edits that bring the pair to a target d′ for the nominal person, the cheapest first."""
    icons = of.kept.icons
    # An icon that another one plays would change that one too.
    played = {one.name for icon in icons for one in all_played(icon.statements)}
    free = [place for place in of.pair if icons[place].name not in played]
    ways = list[Way]()
    for place in free:
        ways += product([place], numbers_of(icons[place], baseline_C(icons[place], of.kept.rig)), (True, False))
    logs = np.log(largest) * np.linspace(0.0, 1.0, GRID + 1)[1:] ** 2
    tried = list[CandidateEdit]()
    for (w, way), (g, log) in product(enumerate(ways), enumerate(logs)):
        tried += changed(of.kept, way, w, g, log)
    for place in free:
        tried += _repeats(of.kept, place)
    good = _good(of, tried, target, rejected)
    repeats = [one for one in good if one.way is None]
    first: dict[int, int] = {}
    for one in good:
        if one.way is not None:
            first[one.way] = min(first.get(one.way, GRID), one.step)
    spans = {w: (0.0 if g == 0 else float(logs[g - 1]), float(logs[g])) for w, g in first.items()}
    # A number that is far from enough where another is dear already cannot become the cheapest.
    most = DEARER * min((high for _, high in spans.values()), default=0.0)
    spans = {w: (low, high) for w, (low, high) in spans.items() if low <= most}
    for _ in range(ROUNDS):
        middle = {w: 0.5 * (low + high) for w, (low, high) in spans.items()}
        trial = list(chain.from_iterable(changed(of.kept, ways[w], w, 0, log) for w, log in middle.items()))
        done = {one.way for one in _good(of, trial, target, rejected)}
        spans = {w: (low, middle[w]) if w in done else (middle[w], high) for w, (low, high) in spans.items()}
    last = list[CandidateEdit]()
    for (w, (_, high)), digits in product(spans.items(), (2, 3)):
        last += changed(of.kept, ways[w], w, digits, high, digits)
    # Of each number the edit with the fewest digits; those come first.
    shortest: dict[int | None, CandidateEdit] = {}
    for one in _good(of, last, target, rejected):
        shortest.setdefault(one.way, one)
    best = {(one.place, one.new): one for one in sorted([*repeats, *shortest.values()], key=lambda one: -one.cost)}
    return sorted(best.values(), key=lambda one: (one.cost, one.place, one.new))


def changed(kept: Pool, way: Way, w: int, step: int, log: float, digits: int = 4) -> list[CandidateEdit]:
    """The icon with one number changed by a log ratio; nothing where the language or the whole icon forbids it."""
    place, number, up = way
    value = number.times(math.exp(log if up else -log))
    value = _outwards(value, number, digits) if number.field != "count" else value
    if value == number.value or (number.field == "count" and value < 1):
        return []
    icon = kept.icons[place]

    def made() -> tuple[Icon, str, str]:
        new = with_number(icon, number, value)
        return new, line_of(icon, number.path), line_of(new, number.path)

    ratio = abs(math.log((value - number.above) / (number.value - number.above)))
    return _valid(kept, place, made, ratio, w, step)


def _repeats(kept: Pool, place: int) -> list[CandidateEdit]:
    icon = kept.icons[place]
    once = "its one statement" if len(icon.statements) == 1 else f"its {len(icon.statements)} statements"

    def made(count: int) -> tuple[Icon, str, str]:
        return repeated(icon, count), once, f"repeat {count} {{ {once} }}"

    edits = (_valid(kept, place, partial(made, n), math.log(n), None, n) for n in REPEATS)
    return list(chain.from_iterable(edits))


def _valid(
    kept: Pool, place: int, make: Callable[[], tuple[Icon, str, str]], ratio: float, way: int | None, step: int
) -> list[CandidateEdit]:
    """The edit of an icon into another, with its line before and after, unless that cannot be run or lasts too long."""
    try:
        new, old, line = make()
        added = duration_s(new, kept.rig) - float(kept.durations_s[place])
    except (CueErrors, ValueError):
        return []
    if added > MOST_LONGER_S:
        return []
    cost = ratio + PER_SECOND * max(added, 0.0)
    return [CandidateEdit(place, new, old, line, cost, added, way, step, np.empty(0))]


def _good(of: Screening, tried: Sequence[CandidateEdit], target: float, rejected: Rejections) -> list[CandidateEdit]:
    """Those that part the pair for the nominal person, are safe and reached, and leave the others apart."""
    if not tried:
        return []
    longest = max(float(of.kept.durations_s[edit.place]) + edit.added_s for edit in tried)
    end_s = max(of.kept.end_s, run_end_s([longest], POOL_HZ))
    felt = Pool.of([edit.icon for edit in tried], of.kept.rig, of.observer, end_s=end_s)
    good = []
    for trace, edit, row in zip(felt.traces, tried, felt.dprimes(of.kept, of.memory, of.observer), strict=True):
        other = of.pair[1] if edit.place == of.pair[0] else of.pair[0]
        fallen = worse(of.now[edit.place], row, of.wanted)
        fallen[[edit.place, other]] = False
        parted = bool(row[other] >= target)
        # Judged only where it matters, since it takes long.
        if not (parted or row[other] > rejected.closest) or objection(trace) is not None:
            continue
        if not parted:
            rejected.closest = max(rejected.closest, float(row[other]))
        elif fallen.any():
            rejected.opposed = True
        else:
            good.append(replace(edit, apart=row))
    return good


def _outwards(value: float, number: Number, digits: int) -> float:
    """A value with `digits` digits, rounded away from the old one so that its effect is kept."""
    if value == 0:
        return value
    place = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    rounded = math.ceil if value > number.value else math.floor
    return rounded(value * place - (1e-9 if value > number.value else -1e-9)) / place
