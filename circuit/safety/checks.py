"""Checks of the rules of safety as records (in words: `words.py`)."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Literal

LEVEL = 1e-6
"""Within this distance, in its unit, the extreme counts as reached: a held level has no unique latest row."""

Cure = Literal["baseline", "slower", "less current", "shorter", "smaller"]
"""What keeps a quantity within its limit."""

CURE_OF: dict[str, Cure] = {
    "rate of skin temperature": "slower",
    "hot plate": "less current",
    "thermal dose": "shorter",
    "Henriques integral": "shorter",
    "skin surface": "smaller",
    "display": "smaller",
    "cold-receptor depth": "smaller",
}
"""In the order in which cures are named; the time of a display above a temperature needs a shorter hold too."""


@dataclass(frozen=True, slots=True)
class Before:
    """Plays before a play, with a pause in s between them.

    `plays`: the same drive repeated (`cycle`) or `once`, another one once (`another`) or repeated (`others`), or drives
    in any order, between the `warm` and the `cold` bound of which the play begins; or just `any` before it.
    """

    plays: Literal["cycle", "once", "another", "others", "warm", "cold", "any"]
    pause_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Scenario:
    """The run that a check is of.

    `corner` has the deviations of the rig in the order of `rig.uncertainty.WORDS`, or the name of a lane; `way` says
    how a device follows or what is wrong, empty where it does as told; `before` is None for a first play, `ending` what
    follows the play, empty for the play itself.
    """

    corner: tuple[float, ...] | str = ""
    way: str = ""
    before: Before | None = None
    ending: str = ""

    def __str__(self) -> str:
        from .words import scenario_text

        return scenario_text(self)


AS_TOLD = Scenario()
"""A play as told, by itself."""


@dataclass(frozen=True, slots=True)
class Check:
    """One rule checked against runs: the extreme, its time and scenario, and the source of the limit.

    `value` is the extreme on the side that the rule limits, first reached at `time_s`; `since_s` is when the limit is
    first exceeded, None where it never is. Both are NaN where it is in some play of any. `from_start_K` is how far the
    limit is from where the run began, None for one that is absolute. `run` is the scenario, of which `scenario` tells
    in words.
    """

    quantity: str
    severity: str
    value: float
    limit: float
    unit: str
    time_s: float
    since_s: float | None
    source: str
    from_start_K: float | None = None
    upper: bool = True
    run: Scenario = AS_TOLD

    @property
    def passed(self) -> bool:
        """Whether the run stays within the limit."""
        return self.since_s is None

    @property
    def beyond(self) -> float:
        """Excess over the limit in its unit; negative inside it."""
        return self.value - self.limit if self.upper else self.limit - self.value

    @property
    def scenario(self) -> str:
        """The scenario in words."""
        return str(self.run)

    @property
    def note(self) -> str:
        """From where a relative limit counts, in words; empty for one that is absolute."""
        return "" if self.from_start_K is None else f", {self.from_start_K:g} K from where it began,"

    @property
    def figures(self) -> tuple[str, str]:
        """Value and limit as people read them."""
        from .words import figures

        return figures(self)

    def __str__(self) -> str:
        from .words import check_text

        return check_text(self)

    def to_dict(self) -> dict[str, object]:
        """The record in the form of a sidecar, with its sentence."""
        known = {**asdict(self), "from_start_K": self.note, "run": self.scenario}
        named = {{"from_start_K": "note", "run": "scenario"}.get(name, name): value for name, value in known.items()}
        return {**named, "passed": self.passed, "text": str(self)}


def findings_of(checks: Sequence[Check]) -> tuple[Check, ...]:
    """Of the limits exceeded, one for each quantity and side, the hard ones first: these imply the soft ones."""
    worst: dict[tuple[str, bool], Check] = {}
    broken = [check for check in checks if not check.passed]
    for check in sorted(broken, key=lambda one: (one.severity != "hard", one.since_s)):
        worst.setdefault((check.quantity, check.upper), check)
    return tuple(worst.values())


def hard_of(findings: Sequence[Check]) -> tuple[Check, ...]:
    """The findings that no drive may have."""
    return tuple(finding for finding in findings if finding.severity == "hard")


def hard_reason(findings: Sequence[Check]) -> str | None:
    """The first hard finding in one sentence; None where there is none."""
    return next(map(str, hard_of(findings)), None)


def colour_of(findings: Sequence[Check]) -> str:
    """Green without findings, red with a hard one, otherwise amber."""
    if hard_of(findings):
        return "red"
    return "amber" if findings else "green"


def cures_of(findings: Sequence[Check]) -> tuple[Cure, ...]:
    """Cures for every exceeded hard limit, or another baseline alone where a first play begins beyond one."""
    hard = hard_of(findings)
    if any(check.unit == "°C" and check.since_s == 0.0 and check.run.before is None for check in hard):
        return ("baseline",)
    needed = {"shorter" if check.unit == "s" else CURE_OF.get(check.quantity) for check in hard}
    return tuple(cure for cure in dict.fromkeys(CURE_OF.values()) if cure in needed)


def worst_of(groups: Iterable[Sequence[Check]]) -> tuple[Check, ...]:
    """From several groups of checks of the same rules, the worst check of each rule; the first of equals."""
    worst = []
    for same in zip(*groups, strict=True):
        most = max(check.beyond for check in same)
        worst.append(next(check for check in same if check.beyond >= most - LEVEL))
    return tuple(worst)


class Judged:
    """Whatever was checked against rules, by its `checks`."""

    __slots__ = ()
    checks: tuple[Check, ...]

    @property
    def findings(self) -> tuple[Check, ...]:
        """The limits that are exceeded, one for each quantity and side, the hard ones first."""
        return findings_of(self.checks)

    @property
    def colour(self) -> str:
        """Green, amber (only soft limits are exceeded) or red."""
        return colour_of(self.findings)

    @property
    def safe(self) -> bool:
        """Whether no hard limit is exceeded."""
        return self.colour != "red"

    @property
    def reason(self) -> str | None:
        """The first hard limit exceeded, in one sentence; None where there is none."""
        return hard_reason(self.findings)

    @property
    def cautions(self) -> tuple[str, ...]:
        """A sentence for each soft limit exceeded."""
        return tuple(str(finding) for finding in self.findings if finding.severity != "hard")
