"""Demands on the hardware that keep a drive safe with a single fault."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from .checks import Check

How = Literal["held", "proven", "stated", "missing"]
"""How a demand is met: by what plays (`held`), by a test before the first play (`proven`), by a person, who says so
(`stated`), or not at all (`missing`), which is refused."""

LONGEST_REST_S = 1800.0
"""Held before the first play where the gate finds that 10 min of rest do not suffice."""
USUAL_PAUSE_S = 60.0
"""Held between plays where the gate finds no pause: a minute is usual in thermal studies."""
QUICKEST_S = 0.01
"""A player acts so quickly where the gate finds no cut-off that is quick enough."""


@dataclass(frozen=True, slots=True)
class CutOff:
    """A cut-off on the measured temperature of the display: °C below and above which all power goes off.

    `react_within_s`: how long that may take after the display has crossed it, with the driver at its limit.
    """

    low: float
    high: float
    react_within_s: float

    @property
    def act_within_s(self) -> float:
        """How quickly a player must act, in s."""
        return self.react_within_s or QUICKEST_S


@dataclass(frozen=True, slots=True)
class HeldCutOff:
    """A second cut-off: all power goes off where the display is beyond a temperature in °C for longer than a time.

    The time in s counts while a current flows, and begins anew when the display comes back.
    """

    low: float
    high: float
    longer_than_s: float


@dataclass(frozen=True, slots=True)
class PolarityCheck:
    """A check of the wiring before the first play: a small current for a short time must cool the display.

    `off_before_s`: for so long the output is off before the current, so that the display comes from no earlier one.
    `needed`: with swapped poles, the drive itself would exceed a hard limit. `swapped_skin_C`: the skin temperature
    that it would then reach.
    """

    needed: bool
    off_before_s: float
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
    """What passes a limit the farthest: a temperature, or the dose that a fault adds."""

    quantity: str
    value: float
    unit: str


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
    """Demands on the hardware that keep one drive, or all of a set, safe with a single fault; None: not demanded.

    `watchdog_s`: a stuck current must be cut after this time; 60 where a minute is safe, 0 where no time is.
    `rest_before_first_play_s`: the rest must be held so long on a display that was without power; None: 10 min do not
    suffice. `zero_current_at_most_s`: after which contact must end, since the dose adds up. `current_limit_A`: between
    which currents the driver must stay by itself, so that no current at which it is stuck, and no loop at any supply
    voltage, moves the skin too fast. `loop`: which loops between set-points and current it may be, and that the
    cut-offs need a second sensor; None where the drive itself is the current, or the device a thermode.
    """

    watchdog_s: float
    cut_off_display_C: CutOff
    polarity_check: PolarityCheck | None
    rest_before_first_play_s: float | None
    pause_at_least_s: float | None
    zero_current_at_most_s: float | None
    faults: tuple[SingleFault, ...]
    held_cut_off_display_C: HeldCutOff | None = None
    current_limit_A: tuple[float, float] | None = None
    loop: Loop | None = None

    def __repr__(self) -> str:
        cut = self.cut_off_display_C
        return (
            f"Demands(watchdog {self.watchdog_s:g} s, cut-off {cut.low:g} … {cut.high:g} °C within "
            f"{cut.react_within_s:g} s, {len(self.faults)} single faults)"
        )

    @staticmethod
    def strictest(demands: Sequence[Demands]) -> Demands:
        """What keeps each of several drives safe that are played by one device; without their faults."""
        cuts = [demand.cut_off_display_C for demand in demands]
        held = [demand.held_cut_off_display_C for demand in demands if demand.held_cut_off_display_C]
        limits_A = [demand.current_limit_A for demand in demands if demand.current_limit_A]
        rests = [demand.rest_before_first_play_s for demand in demands]
        pauses = [demand.pause_at_least_s for demand in demands]
        zeros = [demand.zero_current_at_most_s for demand in demands if demand.zero_current_at_most_s is not None]
        # One test as a whole: the fall was found for its current and its time.
        tests = [demand.polarity_check for demand in demands if demand.polarity_check]
        tests.sort(key=lambda test: (not test.needed, test.test_current_A * test.test_s))
        return Demands(
            watchdog_s=min(demand.watchdog_s for demand in demands),
            cut_off_display_C=CutOff(
                max(cut.low for cut in cuts), min(cut.high for cut in cuts), min(cut.react_within_s for cut in cuts)
            ),
            polarity_check=tests[0] if tests else None,
            rest_before_first_play_s=None if None in rests else max(rest for rest in rests if rest is not None),
            pause_at_least_s=None if None in pauses else max(pause for pause in pauses if pause is not None),
            zero_current_at_most_s=min(zeros, default=None),
            faults=(),
            held_cut_off_display_C=HeldCutOff(
                max(cut.low for cut in held), min(cut.high for cut in held), min(cut.longer_than_s for cut in held)
            )
            if held
            else None,
            current_limit_A=(max(low for low, _ in limits_A), min(high for _, high in limits_A)) if limits_A else None,
            loop=demands[0].loop,  # loops are alike in all icons of a set
        )

    @property
    def rest_s(self) -> float:
        """How long a player holds the rest before a first play, in s."""
        return LONGEST_REST_S if self.rest_before_first_play_s is None else self.rest_before_first_play_s

    @property
    def pause_s(self) -> float:
        """How long a player waits between plays, in s."""
        return USUAL_PAUSE_S if self.pause_at_least_s is None else self.pause_at_least_s

    @property
    def test(self) -> PolarityCheck | None:
        """The test of the wiring, where one is needed."""
        return self.polarity_check if self.polarity_check and self.polarity_check.needed else None

    @property
    def demanded(self) -> tuple[str, ...]:
        """Names of what is demanded, as a sidecar has them."""
        told = {name for name in DEMANDS if getattr(self, name) is not None} | {"rest_before_first_play_s"}
        if self.test is None:
            told.discard("polarity_check")
        return tuple(name for name in DEMANDS if name in told)

    def to_dict(self) -> dict[str, object]:
        """All of it in the form of a sidecar's `hardware_must_prevent`."""
        return {**asdict(self), "faults": [fault.to_dict() for fault in self.faults]}


@dataclass(frozen=True, slots=True)
class Demanded:
    """What keeps drives safe that follow each other: demands on each, and checks that fail where none suffice.

    `pause_s` is the shortest pause with which these can be met; None where no pause is safe.
    """

    pause_s: float | None
    demands: Sequence[Demands]
    failed: tuple[Check, ...]


DEMANDS = (
    *("watchdog_s", "cut_off_display_C", "held_cut_off_display_C", "polarity_check", "rest_before_first_play_s"),
    *("pause_at_least_s", "zero_current_at_most_s", "current_limit_A", "loop"),
)
"""Names of everything that may be demanded."""
