"""What software cannot make safe, and the hardware must therefore prevent, in numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any


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
    change by `set_points_K_per_s` at most.
    """

    kp_A_per_K: tuple[float, float]
    ki_A_per_Ks: tuple[float, float]
    kd_As_per_K: float
    delay_at_most_s: float
    sensor_lag_at_most_s: float
    sensor_offset_at_most_K: float
    set_points_K_per_s: float


@dataclass(frozen=True, slots=True)
class Harm:
    """The temperature in °C that passes a hard limit the farthest."""

    quantity: str
    value_C: float


@dataclass(frozen=True, slots=True)
class SingleFault:
    """A single fault: its kind, the verdict on the drive with it, and what is to be told of harm and prevention.

    Kinds and the names of their values are those of `words.FAULTS`, which has their sentences.
    """

    kind: str
    colour: str
    values: Mapping[str, Any]

    def to_dict(self) -> dict[str, object]:
        """The fault in words, in the form of a sidecar: `fault`, `colour`, `text` and `prevented_by`."""
        from .words import fault_table

        return fault_table(self)


@dataclass(frozen=True, slots=True)
class Demands:
    """What the hardware must prevent so that one drive stays safe with a single fault.

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

    @property
    def within_s(self) -> tuple[float, float]:
        """How quickly watchdog and cut-off must act, in s."""
        return self.watchdog_s, self.cut_off_display_C.react_within_s

    def to_dict(self) -> dict[str, object]:
        """All of it in the form of a sidecar's `hardware_must_prevent`."""
        return {**asdict(self), "faults": [fault.to_dict() for fault in self.faults]}
