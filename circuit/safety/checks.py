"""Checks of runs against the rules of safety: how near they come, when and in which scenario."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace

from thermicon.icons.number_text import significant

LEVEL = 1e-6
"""Within this distance, in its unit, the extreme counts as reached: a held level has no unique latest row."""


@dataclass(frozen=True, slots=True)
class Check:
    """One rule checked against runs: the extreme, its time and scenario, and the source of the limit.

    `value` is the extreme on the side that the rule limits, first reached at `time_s`; `since_s` is when the limit is
    first exceeded, None where it never is. `scenario` says in which run, `again` whether that is a later play.
    """

    quantity: str
    severity: str
    value: float
    limit: float
    unit: str
    time_s: float
    since_s: float | None
    source: str
    note: str = ""
    upper: bool = True
    scenario: str = ""
    again: bool = False

    @property
    def passed(self) -> bool:
        """Whether the run stays within the limit."""
        return self.since_s is None

    @property
    def figures(self) -> tuple[str, str]:
        """Value and limit as people read them: in four digits, or in as many as show that the limit is exceeded."""
        value, limit = f"{self.value:.4g}", f"{self.limit:.4g}"
        if not self.passed:
            value, limit = significant(self.value, self.limit, least=4)
        return value.replace("-", "−"), limit.replace("-", "−")

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        where = f", with {self.scenario}" if self.scenario else ""
        value, limit = (f"{figure}{unit}" for figure in self.figures)
        reached = f"{self.quantity} reaches {value} at {self.time_s:.2f} s{where}"
        side = "above" if self.upper else "below"
        if self.since_s is None:
            return f"{reached}, not {side} the {self.severity} limit of {limit}{self.note} ({self.source})"
        return (
            f"{reached}, {side} the {self.severity} limit of {limit}{self.note} "
            f"from {self.since_s:.2f} s on ({self.source})"
        )


def findings_of(checks: Sequence[Check]) -> tuple[Check, ...]:
    """Of the limits exceeded, one for each quantity and side, the hard ones first.

    Exceeding a hard limit implies exceeding the soft one.
    """
    worst: dict[tuple[str, bool], Check] = {}
    broken = [check for check in checks if not check.passed]
    for check in sorted(broken, key=lambda one: (one.severity != "hard", one.since_s)):
        worst.setdefault((check.quantity, check.upper), check)
    return tuple(worst.values())


def colour_of(findings: Sequence[Check]) -> str:
    """Green without findings, red with a hard one, otherwise amber."""
    if any(finding.severity == "hard" for finding in findings):
        return "red"
    return "amber" if findings else "green"


def hard_reason(findings: Sequence[Check]) -> str | None:
    """The first hard finding in one sentence; None where there is none."""
    return next((str(finding) for finding in findings if finding.severity == "hard"), None)


CURES = (
    (("rate of skin temperature",), "a slower change"),
    (("hot plate",), "less current or a better heat sink"),
    (("thermal dose", "Henriques integral", "time of the display"), "a shorter hold"),
    (("skin surface", "display", "cold-receptor depth"), "a smaller or shorter change"),
)
"""What keeps a quantity within its limit, by the beginning of its name."""
NEARER_BASELINE = "a baseline nearer to resting skin, since it is beyond the limit from the start"


def more_and_cure(findings: Sequence[Check]) -> str:
    """What follows the reason of a refusal: every other hard limit that is exceeded, and what would cure all of them.

    >>> more_and_cure([])
    ''
    """
    hard = [finding for finding in findings if finding.severity == "hard"]
    if any(check.unit == "°C" and check.since_s == 0.0 and not check.again for check in hard):
        cures = [NEARER_BASELINE]
    else:
        cures = [cure for names, cure in CURES if any(check.quantity.startswith(names) for check in hard)]
    others = [
        f"{check.quantity} {value}{'' if check.unit == '1' else ' ' + check.unit} (limit {limit})"
        for check in hard[1:]
        for value, limit in (check.figures,)
    ]
    more = f"; also beyond hard limits: {', '.join(others)}" if others else ""
    return f"{more}; use {', '.join(cures)}" if cures else more


def soft_cautions(findings: Sequence[Check]) -> tuple[str, ...]:
    """A sentence for each finding that is not hard."""
    return tuple(str(finding) for finding in findings if finding.severity != "hard")


def as_dict(check: Check) -> dict[str, object]:
    """A check in the form of a sidecar, whose scenario says in words whether it is a later play."""
    known = {name: value for name, value in asdict(check).items() if name != "again"}
    return {**known, "passed": check.passed, "text": str(check)}


def beyond(check: Check) -> float:
    """How far a check goes beyond its limit, in its unit; negative where it stays inside."""
    return check.value - check.limit if check.upper else check.limit - check.value


def worst_of(groups: Iterable[Sequence[Check]]) -> tuple[Check, ...]:
    """From several groups of checks of the same rules, the worst check of each rule; the first of equals."""
    return tuple(_farthest(same) for same in zip(*groups, strict=True))


def again(checks: Sequence[Check]) -> tuple[Check, ...]:
    """Checks of plays after others."""
    return tuple(replace(check, again=True) for check in checks)


def _farthest(same: Sequence[Check]) -> Check:
    most = max(beyond(check) for check in same)
    return next(check for check in same if beyond(check) >= most - LEVEL)
