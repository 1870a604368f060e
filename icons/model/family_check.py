"""Every member of a family checked exactly, as an icon that stands alone is, and what all members reach together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .check import Played, Problem, survey
from .context import Context
from .errors import CueErrors
from .icon import problem_error, rest_level
from .statements import Broken, Repeat, Statement, Wave

if TYPE_CHECKING:
    from .expand import Expander
    from .parameter import Slot

MOST_FAILING = 1_000
"""Failing members after which the rest of a family is not checked."""
MOST_EFFORT = 500_000
"""Statements that are followed to check all families of a file: about ten seconds' work."""
# A parameter may raise the count of a repeat, of which at most two rounds are followed.
_ROUNDS = 2
# In terms of other statements.
_WAVE = 3


@dataclass(frozen=True, slots=True)
class Summary:
    """Over all members: durations (s), levels (°C or A) and the steepest rate (K/s or A/s) that is not a step.

    The rate of a sine is that of the curve, and a level between two steps in one moment counts.
    """

    shortest_s: float
    longest_s: float
    lowest: float
    highest: float
    steepest_per_s: float


@dataclass(frozen=True, slots=True)
class FailedMember:
    """The first member of a family that cannot be played, what is wrong with it, and how many members fail.

    ``failing`` counts up to ``MOST_FAILING``.
    """

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


def check_family(members: "Expander", context: Context, start: float | None = None) -> Summary:
    """Return the summary over all members; MemberErrors when one of them cannot be played.

    ``start`` (°C, or A under control current) is the baseline when the context gives none.
    """
    rest = rest_level(context, start)
    summary: Summary | None = None
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
            one = Summary(course.duration_s, course.duration_s, course.lowest, course.highest, course.steepest_per_s)
            summary = one if summary is None else joined(summary, one)
    if first is not None or summary is None:
        assert first is not None
        raise MemberErrors(replace(first, failing=failing), context)
    return summary


def joined(a: Summary, b: Summary) -> Summary:
    """Return the summary of what two summaries cover."""
    return Summary(
        min(a.shortest_s, b.shortest_s),
        max(a.longest_s, b.longest_s),
        min(a.lowest, b.lowest),
        max(a.highest, b.highest),
        max(a.steepest_per_s, b.steepest_per_s),
    )


def effort(members: int, template: Sequence[Statement | Broken], slots: "Sequence[Slot]") -> int:
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
