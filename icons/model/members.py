"""Checks of all members of a family."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import Any

from .check import Played, Problem, survey
from .context import Context, Metadata
from .errors import CueErrors
from .icon import problem_error, rest_level
from .parameter import Parameter, Path, Slot
from .statements import Broken, Repeat, Statement, Wave

HOLE = re.compile(r"\{([^{}\s]*)\}")
Places = Sequence[int]
# Statements that few members differ in are kept; beyond this many, each is made anew.
_MOST_KEPT = 65_536
MOST_FAILING = 1_000
"""Failing members after which the rest of a family is not checked."""
MOST_EFFORT = 500_000
"""Statements that are followed to check all families of a file: about ten seconds' work."""
# A parameter may raise the count of a repeat, of which at most two rounds are followed.
_ROUNDS = 2
# In terms of other statements.
_WAVE = 3


class Expander:
    """Makes the statements, name and metadata of a member from the places of its values in the parameters."""

    def __init__(
        self,
        family: str,
        parameters: tuple[Parameter, ...],
        template: tuple[Statement, ...],
        slots: tuple[Slot, ...],
        metadata: Metadata,
    ) -> None:
        self.family, self.parameters, self.template, self.means = family, parameters, template, metadata
        order = {parameter.name: place for place, parameter in enumerate(parameters)}
        # What varies in the statement at a path, and which parameters it and the statements in it depend on.
        self.varied: dict[Path, list[tuple[Slot, int]]] = {}
        self.used: dict[Path, list[int]] = {}
        for slot in slots:
            place = order[slot.parameter]
            self.varied.setdefault(slot.path, []).append((slot, place))
            for depth in range(1, len(slot.path) + 1):
                used = self.used.setdefault(slot.path[:depth], [])
                if place not in used:
                    used.append(place)
        self.known: dict[tuple[Path, tuple[int, ...]], Any] = {}

    def __len__(self) -> int:
        return prod(len(parameter) for parameter in self.parameters)

    def places(self, index: int) -> list[int]:
        """Return the place of each parameter's value in the member at an index; the last parameter runs fastest."""
        found = []
        for parameter in reversed(self.parameters):
            index, place = divmod(index, len(parameter))
            found.append(place)
        return found[::-1]

    def statements(self, places: Places) -> tuple[Statement, ...]:
        """Return the statements of a member; those that members have in common are made once."""
        return tuple([self._made(part, (n,), places) for n, part in enumerate(self.template)])

    def _made(self, part: Any, path: Path, places: Places) -> Any:
        used = self.used.get(path)
        if used is None:
            return part
        key = path, tuple([places[place] for place in used])
        if (found := self.known.get(key)) is not None:
            return found
        own: dict[str, Any] = {}
        for slot, place in self.varied.get(path, ()):
            value = self.parameters[place].si(places[place], slot.kind)
            own[slot.field] = int(value) if slot.kind == "count" else value
        if isinstance(part, Repeat):
            own["body"] = tuple([self._made(inside, (*path, n), places) for n, inside in enumerate(part.body)])
        made = replace(part, **own)
        if len(self.known) < _MOST_KEPT:
            self.known[key] = made
        return made

    def name(self, places: Places) -> str:
        """Return the name of a member, for example ``ramp_amount=-6_rate=1``."""
        values = zip(self.parameters, places, strict=True)
        return "".join([self.family, *(f"_{own.name}={own.text(place)}" for own, place in values)])

    def metadata(self, places: Places) -> Metadata:
        """Return metadata in whose intent ``{name}`` stands for a parameter's value with its unit."""
        if self.means.means is None:
            return self.means
        values = zip(self.parameters, places, strict=True)
        words = {own.name: f"{own.text(place)} {own.unit}".strip() for own, place in values}
        return replace(self.means, means=HOLE.sub(lambda hole: words.get(hole[1], hole[0]), self.means.means))


@dataclass(frozen=True, slots=True)
class Extremes:
    """Over all members: durations (s), levels (°C or A) and the steepest rate (K/s or A/s) that is not a step."""

    shortest_s: float
    longest_s: float
    lowest: float
    highest: float
    steepest_per_s: float

    def joined(self, other: "Extremes") -> "Extremes":
        """Return the summary of what two summaries cover."""
        return Extremes(
            min(self.shortest_s, other.shortest_s),
            max(self.longest_s, other.longest_s),
            min(self.lowest, other.lowest),
            max(self.highest, other.highest),
            max(self.steepest_per_s, other.steepest_per_s),
        )


@dataclass(frozen=True, slots=True)
class FailedMember:
    """The first member of a family that cannot be played, its problem, and how many fail, up to ``MOST_FAILING``."""

    name: str
    statements: tuple[Statement, ...]
    problem: Problem
    failing: int


class MemberErrors(CueErrors):
    """A member of a family cannot be played; ``failed`` says which one, and why."""

    def __init__(self, failed: FailedMember, context: Context) -> None:
        super().__init__((problem_error(failed.problem, failed.name, context),))
        self.failed = failed
        self.context = context

    def __reduce__(self) -> tuple[object, ...]:
        return MemberErrors, (self.failed, self.context)


def check_family(members: Expander, context: Context, start: float | None = None) -> Extremes:
    """The summary over all members from a baseline or ``start``; MemberErrors when one cannot be played."""
    rest = rest_level(context, start)
    summary: Extremes | None = None
    first: FailedMember | None = None
    failing = 0
    played: Played = {}
    for index in range(len(members)):
        places = members.places(index)
        statements = members.statements(places)
        course = survey(statements, context.control, rest, played)
        if course.problems:
            failing += 1
            problem = course.problems[0]
            # Of members that do not keep a total, that farthest from it is named.
            if first is None or (first.problem.code == problem.code == "E222" and problem.off_s > first.problem.off_s):
                first = FailedMember(members.name(places), statements, problem, 1)
            if failing == MOST_FAILING:
                break
        elif first is None:
            one = Extremes(course.duration_s, course.duration_s, course.lowest, course.highest, course.steepest_per_s)
            summary = one if summary is None else summary.joined(one)
    if first is not None:
        raise MemberErrors(replace(first, failing=failing), context)
    assert summary is not None
    return summary


def effort(members: int, template: Sequence[Statement | Broken], slots: Sequence[Slot]) -> int:
    """Return how many statements are followed when all members of a family are checked."""

    def followed(body: Sequence[Statement | Broken], path: tuple[int, ...]) -> int:
        total = 0
        for place, part in enumerate(body):
            if isinstance(part, Repeat):
                varied = any(slot.path == (*path, place) for slot in slots)
                total += followed(part.body, (*path, place)) * (_ROUNDS if part.count > 1 or varied else 1)
            else:
                total += _WAVE if isinstance(part, Wave) else 1
        return total

    return members * followed(template, ())
