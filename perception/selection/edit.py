"""The cheapest edit that separates a pair: one number of one statement changed, or one repeat added.

An edit costs the |log| of the ratio of the new number to the old, plus a tenth for every second that it adds, so that
a second is worth about 10 % of a number. Candidates are tried on the nominal person at the range and clock of the set,
by bisection for every number in both directions; the cheapest one that the virtual people confirm is returned.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..criteria import DISTINGUISHABLE_DPRIME
from ..identification.carry_over import prepare_task
from ..identification.task import USUAL, Task
from .appraise import population_dprime, population_response
from .edit_result import Edit, NoEdit
from .icon_numbers import Number, line_of, numbers_of, repeated, with_number
from .nominal import Sensed, dprimes, end_of, sense

if TYPE_CHECKING:
    from thermicon.icons import Icon

    from ..ranking.ranking import Ranking

PER_SECOND = 0.1
TOLERANCE = 0.1
FAR = 2.0
"""A pair that falls by more than 0.1 d′ is made worse, unless it stays beyond twice the wanted d′."""
LARGEST, FARTHEST = 4.0, 256.0
"""A number becomes at most four times larger or smaller; where that separates no pair, up to 256 times."""
GRID = 6
ROUNDS = 4
"""Changes that every number is tried with in each direction, and how often the interval that is left is halved."""
DEARER = 1.5
"""Numbers whose change must be more than so many times the smallest one that is enough are not followed."""
REPEATS = (2, 3)
MOST_LONGER_S = 30.0
"""By more than this no edit makes an icon longer."""
MOST_NEAR, NEAR = 5, 3.0
"""Up to 5 icons that an edit brings nearer are checked with people, if they end within three times the wanted d′."""
MOST_CONFIRMED = 8
"""Edits that are checked with people before the search gives up."""
MOST_RECOUNTED = 50
"""People whose episodes are counted again with the edit."""


@dataclass(frozen=True, slots=True)
class _CandidateEdit:
    """An edit that is looked at: which icon, which number (None: a repeat), what it becomes, what it costs."""

    place: int
    icon: Icon
    old: str
    new: str
    cost: float
    added_s: float
    way: tuple[int, int]


def cheapest_edit(ranking: Ranking, a: str, b: str, *, wanted: float = DISTINGUISHABLE_DPRIME) -> Edit | NoEdit:
    """Find the cheapest edit of one of two icons that separates them by a median d′.

    Every edit that is offered is read back from its text, simulated, safe and reachable, and makes no other pair worse
    by more than 0.1 d′ below twice `wanted`. The people of the ranking confirm it, in its task.

    Parameters
    ----------
    ranking
        The set as it was ranked.
    a, b
        Names of the two.
    wanted
        Median d′ to be reached; by default that of a distinguishable pair.

    Returns
    -------
    Edit or NoEdit
        The edit, or why there is none.

    Raises
    ------
    KeyError, ValueError
        For a name that is not there; for a `wanted` that is not above 0.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception import rank
    >>> ranking = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    >>> cheapest_edit(ranking, "cooling-step", "warming-step").reason
    'the pair is distinguishable already: d′ ..., criterion 2.56'
    """
    if not 0 < wanted < math.inf:
        raise ValueError(f"a pair is separated by a d′ above 0, not {wanted:g}")
    if a == b:
        raise ValueError(f"a pair is two icons, not {a} twice")
    names = ranking.labels
    for name in (a, b):
        if name not in names:
            raise KeyError(f"no icon is called {name!r}; there are {', '.join(names[:20])}{' …' if names[20:] else ''}")
    return _Search(ranking, (names.index(a), names.index(b)), wanted).run()


class _Search:
    def __init__(self, ranking: Ranking, pair: tuple[int, int], wanted: float) -> None:
        from thermicon.circuit.solver.simulate import duration_s

        job, model = ranking.job, ranking.model
        self.icons, self.rig, self.pair, self.wanted, self.norm = list(job.icons), job.rig, pair, wanted, job.norm
        self.tracking, self.task, self.before, self.observer = job.tracking, job.task, ranking.d_prime, model.nominal
        self.crowd = model.people(job.people, job.seed)
        self.rigs = self.crowd.rigs(job.rig)
        self.durations = [duration_s(icon, job.rig) for icon in job.icons]
        self.end_s = end_of(self.durations)
        self.kept = sense(job.icons, job.rig, self.end_s, self.observer)
        self.now = dprimes(self.kept, self.kept, job.norm, self.observer)
        self.target = wanted
        self.largest = LARGEST
        self.closest = self.confirmed = 0.0
        self.opposed = False
        self.refused: set[tuple[int, str]] = set()
        self.rows: dict[tuple[int, str], Array] = {}

    def run(self) -> Edit | NoEdit:
        (i, j), before = self.pair, self.before

        def medians(some: Sequence[Icon], end_s: float, asked: Task = USUAL) -> Array:
            found = population_dprime(
                some,
                self.rig,
                self.crowd,
                self.tracking,
                self.norm,
                rigs=self.rigs,
                end_s=end_s,
                task=asked,
                observer=self.observer,
            )[0]
            middle: Array = np.median(found, axis=0)
            return middle

        if before[i, j] >= self.wanted:
            return NoEdit(f"the pair is distinguishable already: d′ {before[i, j]:.1f}, criterion {self.wanted:.3g}")
        if self.now[i, j] > 0 and before[i, j] > 0:
            self.target = self.wanted * self.now[i, j] / before[i, j]
        refused = False
        for _ in range(MOST_CONFIRMED):
            offered = self._untried(self._offers())
            if not offered and self.largest < FARTHEST:
                self.largest = FARTHEST  # icons that nobody feels need more than four times a number
                offered = self._untried(self._offers())
            if not offered:
                break
            one = offered[0]
            end_s = max(self.end_s, end_of([self.durations[one.place] + one.added_s]))
            if self.task.plain:
                others = [j if one.place == i else i, *self._near(one)]
                after = medians([one.icon, *(self.icons[k] for k in others)], end_s)[0, 1:]
                parted, worse = float(after[0]), self._worse(before[one.place, others[1:]], after[1:])
            else:  # the range, and what is left behind, move every pair of the set
                edited = [one.icon if k == one.place else icon for k, icon in enumerate(self.icons)]
                count, person = self.task.counted, self.observer
                asked, _ = prepare_task(self.task, edited, self.rig, end_s, count, self.tracking, person)
                whole = medians(edited, end_s, asked)
                rest = np.triu(np.ones_like(whole, dtype=bool), 1)
                rest[min(i, j), max(i, j)] = False
                parted, worse = float(whole[i, j]), self._worse(before[rest], whole[rest])
            if parted >= self.wanted and not worse and _reads_back(one.icon):
                recounted = self._recounted(one, end_s)
                return Edit(one.icon.name, one.old, one.new, one.cost, one.added_s, parted, one.icon, recounted)
            refused |= worse
            self.refused.add((one.place, one.new))
            if parted < self.wanted:
                self.confirmed = max(self.confirmed, parted)
                self.target *= 1.002 * min(self.wanted / max(parted, 1e-6), 1.5)
        reason = "each one that separates them makes another pair worse" if refused or self.opposed else self._why_not()
        return NoEdit(f"no single edit separates them to d′ {self.wanted:.3g}: {reason}")

    def _recounted(self, one: _CandidateEdit, end_s: float) -> float:
        """Share of the first people whose number of episodes of the icon changes with the edit."""
        few, both = self.crowd.part(0, min(len(self.crowd), MOST_RECOUNTED)), [self.icons[one.place], one.icon]
        felt, _ = population_response(
            both,
            self.rig,
            few,
            self.tracking,
            rigs=self.rigs[: len(few)],
            rate_Hz=25.0,
            end_s=end_s,
            observer=self.observer,
        )
        before, after = felt.episodes.counts.T
        return float((before != after).mean())

    def _untried(self, offers: Sequence[_CandidateEdit]) -> list[_CandidateEdit]:
        return [one for one in offers if (one.place, one.new) not in self.refused]

    def _near(self, one: _CandidateEdit) -> list[int]:
        """Icons that an edit brings nearer for the nominal person, those that end nearest; people are asked of them."""
        row, now = self.rows[one.place, one.new], self.now[one.place]
        nearer = [k for k in range(len(row)) if k not in self.pair and row[k] < now[k] and row[k] < NEAR * self.wanted]
        return sorted(nearer, key=lambda k: (float(row[k]), k))[:MOST_NEAR]

    def _worse(self, before: Array, after: Array) -> bool:
        return bool(((after < before - TOLERANCE) & (after < FAR * self.wanted)).any())

    def _offers(self) -> list[_CandidateEdit]:
        """Edits that do it for the nominal person, the cheapest first."""
        ways = [
            (place, number, up)
            for place in self.pair
            if not self._played(place)
            for number in numbers_of(self.icons[place], self._baseline(place))
            for up in (True, False)
        ]
        logs = np.log(self.largest) * np.linspace(0.0, 1.0, GRID + 1)[1:] ** 2
        tried = [one for w, way in enumerate(ways) for g, log in enumerate(logs) for one in self._made(way, w, g, log)]
        tried += [one for place in self.pair if not self._played(place) for one in self._repeats(place)]
        good = self._good(tried)
        found = [one for one, fine in zip(tried, good, strict=True) if fine and one.way[0] < 0]
        first: dict[int, int] = {}
        for one, fine in zip(tried, good, strict=True):
            if fine and one.way[0] >= 0:
                first[one.way[0]] = min(first.get(one.way[0], GRID), one.way[1])
        spans = {w: (0.0 if g == 0 else float(logs[g - 1]), float(logs[g])) for w, g in first.items()}
        # A number that is far from enough where another is dear already cannot become the cheapest.
        most = DEARER * min((high for _, high in spans.values()), default=0.0)
        spans = {w: (low, high) for w, (low, high) in spans.items() if low <= most}
        for _ in range(ROUNDS):
            middle = {w: 0.5 * (low + high) for w, (low, high) in spans.items()}
            trial = [one for w, log in middle.items() for one in self._made(ways[w], w, 0, log)]
            done = {one.way[0] for one, ok in zip(trial, self._good(trial), strict=True) if ok}
            spans = {w: (low, middle[w]) if w in done else (middle[w], high) for w, (low, high) in spans.items()}
        last = [one for w, (_, high) in spans.items() for d in (2, 3) for one in self._made(ways[w], w, d, high, d)]
        found += self._shortest([one for one, ok in zip(last, self._good(last), strict=True) if ok])
        best = {(one.place, one.new): one for one in sorted(found, key=lambda one: -one.cost)}
        return sorted(best.values(), key=lambda one: (one.cost, one.place, one.new))

    @staticmethod
    def _shortest(good: Sequence[_CandidateEdit]) -> list[_CandidateEdit]:
        """Of each number the edit with the fewest digits; those come first."""
        first: dict[int, _CandidateEdit] = {}
        for one in good:
            first.setdefault(one.way[0], one)
        return list(first.values())

    def _made(self, way: tuple[int, Number, bool], w: int, g: int, log: float, digits: int = 4) -> list[_CandidateEdit]:
        """The icon with one number changed by a log ratio; nothing where the language or the whole icon forbids it."""
        place, number, up = way
        value = number.times(math.exp(log if up else -log))
        value = _outwards(value, number, digits) if number.field != "count" else value
        if value == number.value or (number.field == "count" and value < 1):
            return []
        icon = self.icons[place]
        return self._valid(
            lambda: with_number(icon, number, value),
            lambda new: (line_of(icon, number.path), line_of(new, number.path), number.ratio_to(value)),
            place,
            (w, g),
        )

    def _repeats(self, place: int) -> list[_CandidateEdit]:
        icon = self.icons[place]
        count_of = len(icon.statements)
        once = "its one statement" if count_of == 1 else f"its {count_of} statements"

        def tried(count: int) -> list[_CandidateEdit]:
            described = (once, f"repeat {count} {{ {once} }}", math.log(count))
            return self._valid(lambda: repeated(icon, count), lambda _: described, place, (-1, count))

        return [one for count in REPEATS for one in tried(count)]

    def _valid(self, make: Any, tell: Any, place: int, way: tuple[int, int]) -> list[_CandidateEdit]:
        from thermicon.circuit.solver.simulate import duration_s
        from thermicon.icons import CueErrors

        try:
            new = make()
            added = duration_s(new, self.rig) - self.durations[place]
        except (CueErrors, ValueError):
            return []
        if added > MOST_LONGER_S:
            return []
        old, line, ratio = tell(new)
        return [_CandidateEdit(place, new, old, line, ratio + PER_SECOND * max(added, 0.0), added, way)]

    def _good(self, tried: Sequence[_CandidateEdit]) -> list[bool]:
        """Whether each parts the pair for the nominal person, is safe and reached, and leaves the others apart."""
        if not tried:
            return []
        longest = max(self.durations[one.place] + one.added_s for one in tried)
        felt: Sensed = sense([one.icon for one in tried], self.rig, max(self.end_s, end_of([longest])), self.observer)
        found = dprimes(felt, self.kept, self.norm, self.observer)
        answers = []
        for at, (one, row) in enumerate(zip(tried, found, strict=True)):
            other = self.pair[1] if one.place == self.pair[0] else self.pair[0]
            self.rows[one.place, one.new] = row
            fallen = (row < self.now[one.place] - TOLERANCE) & (row < FAR * self.wanted)
            fallen[[one.place, other]] = False
            parted = bool(row[other] >= self.target)
            playable = (parted or row[other] > self.closest) and felt.objection(at) is None
            if playable and parted:
                self.opposed |= bool(fallen.any())
            elif playable:
                self.closest = max(self.closest, float(row[other]))
            answers.append(playable and parted and not fallen.any())
        return answers

    def _why_not(self) -> str:
        # A nominal person short of the target is people short of what is wanted: rounding up would say otherwise.
        reached = max(self.confirmed, self.closest * self.wanted / self.target)
        most = f"with numbers up to {self.largest:g} times larger or smaller"
        return f"the largest d′ of a safe and reachable one, {most}, is about {math.floor(10.0 * reached) / 10.0:.1f}"

    def _played(self, place: int) -> bool:
        """Whether another icon of the set plays this one, and would change with it."""
        from thermicon.icons.model.icon import all_played

        name = self.icons[place].name
        return any(one.name == name for icon in self.icons for one in all_played(icon.statements))

    def _baseline(self, place: int) -> float:
        from thermicon.circuit.solver.inverse import baseline_C

        return baseline_C(self.icons[place], self.rig)


def _outwards(value: float, number: Number, digits: int) -> float:
    """A value with `digits` digits, rounded away from the old one so that its effect is kept."""
    if value == 0:
        return value
    place = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    rounded = math.ceil if value > number.value else math.floor
    return rounded(value * place - (1e-9 if value > number.value else -1e-9)) / place


def _reads_back(icon: Icon) -> bool:
    from thermicon.icons import parse

    return parse(str(icon))[icon.name].statements == icon.statements
