"""Findings of the gate as records (in words: `words.py`): checks of the rules, demands on the hardware."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

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


@dataclass(frozen=True, slots=True)
class CutOff:
    """A cut-off on the measured temperature of the display: °C below and above which all power goes off.

    `react_within_s`: how long that may take after the display has crossed it, with the driver at its limit.
    """

    low: float
    high: float
    react_within_s: float


@dataclass(frozen=True, slots=True)
class PolarityCheck:
    """A check of the wiring before the first play: a small current for a short time must cool the display.

    `needed`: with swapped poles, the drive itself would exceed a hard limit. `swapped_skin_C`: the skin temperature
    that it would then reach.
    """

    needed: bool
    test_current_A: float
    test_s: float
    display_change_at_least_K: float
    swapped_skin_C: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Loop:
    """The loops between set-points and current that a verdict holds for: their gains, and what is allowed at most.

    Gains lie between both numbers. A delay counts from measuring to output, lag and offset are those of the loop's own
    sensor; the offset also bounds that of the second sensor, on which the cut-off acts. The set-points of the files
    change by `set_points_K_per_s` at most. They are shaped for a loop in the middle of the gains of `playing`, with
    that lag and without delay: what it plays is predicted, what another one inside the demands plays is only safe.
    """

    kp_A_per_K: tuple[float, float]
    ki_A_per_Ks: tuple[float, float]
    kd_As_per_K: float
    delay_at_most_s: float
    sensor_lag_at_most_s: float
    sensor_offset_at_most_K: float
    set_points_K_per_s: float
    playing_kp_A_per_K: tuple[float, float]
    playing_ki_A_per_Ks: tuple[float, float]
    playing_sensor_lag_s: float

    @property
    def played(self) -> tuple[float, float, float]:
        """The gains for which set-points are shaped: kp A/K, ki A/(K·s) and kd A·s/K."""
        kp, ki = (sum(band) / 2.0 for band in (self.playing_kp_A_per_K, self.playing_ki_A_per_Ks))
        return kp, ki, self.kd_As_per_K


@dataclass(frozen=True, slots=True)
class Harm:
    """The temperature in °C that passes a hard limit the farthest."""

    quantity: str
    value_C: float


@dataclass(frozen=True, slots=True)
class SingleFault:
    """A single fault: a kind of `circuit/data/fault-words.toml` with its values, and the verdict with it."""

    kind: str
    colour: str
    values: Mapping[str, Any]

    def to_dict(self) -> dict[str, object]:
        """The fault in words, in the form of a sidecar: `fault`, `colour`, `text` and `prevented_by`."""
        from .words import fault_table

        return fault_table(self)


@dataclass(frozen=True, slots=True)
class Demands:
    """Demands on the hardware that keep one drive safe with a single fault.

    `watchdog_s`: a stuck current must be cut after this time; 60 where a minute is safe, 0 where no time is.
    `rest_before_first_play_s`: the rest must be held so long on a display that was without power; None: 10 min do not
    suffice. `zero_current_at_most_s`: after which contact must end, since the dose adds up. `current_limit_A`: between
    which currents a controller that is given set-points must stay, at any supply voltage, since no loop then moves the
    skin too fast; `loop`: which loops it may be, and that its cut-off needs a second sensor. Both are None where the
    drive itself is the current, or the device a thermode.
    """

    watchdog_s: float
    cut_off_display_C: CutOff
    polarity_check: PolarityCheck | None
    rest_before_first_play_s: float | None
    pause_at_least_s: float | None
    zero_current_at_most_s: float | None
    faults: tuple[SingleFault, ...]
    current_limit_A: tuple[float, float] | None = None
    loop: Loop | None = None

    def __repr__(self) -> str:
        cut = self.cut_off_display_C
        return (
            f"Demands(watchdog {self.watchdog_s:g} s, cut-off {cut.low:g} … {cut.high:g} °C within "
            f"{cut.react_within_s:g} s, {len(self.faults)} single faults)"
        )

    def to_dict(self) -> dict[str, object]:
        """All of it in the form of a sidecar's `hardware_must_prevent`."""
        return {**asdict(self), "faults": [fault.to_dict() for fault in self.faults]}
