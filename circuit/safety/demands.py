"""What a drive cannot make safe by itself, and so demands of the hardware, in numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass


@dataclass(frozen=True, slots=True)
class CutOff:
    """A cut-off on the measured temperature of the display: °C below and above which all power goes off.

    `react_within_s`: how long that may take after the display has passed it, with the driver at its limit.
    """

    low: float
    high: float
    react_within_s: float


@dataclass(frozen=True, slots=True)
class PolarityCheck:
    """A check of the wiring before the first play: a small current for a short time must cool the display.

    `needed`: with the poles swapped, the drive itself would pass a hard limit. `swapped_skin_C`: where it would take
    the skin.
    """

    needed: bool
    test_current_A: float
    test_s: float
    display_change_at_least_K: float
    swapped_skin_C: tuple[float, float]


@dataclass(frozen=True, slots=True)
class SingleFault:
    """One thing that goes wrong: what, the verdict on the drive with it, and what prevents harm."""

    fault: str
    colour: str
    text: str
    prevented_by: str


@dataclass(frozen=True, slots=True)
class Demands:
    """What the hardware must prevent so that one drive stays safe with a single fault.

    `watchdog_s`: a current that hangs must be cut after this; 60 where a minute is safe, 0 where no time is.
    `rest_before_first_play_s`: the rest must be held so long on a display that was without power; None: 10 min do not
    suffice. `zero_current_at_most_s`: after which contact must end, since the dose adds up.
    """

    watchdog_s: float
    cut_off_display_C: CutOff
    polarity_check: PolarityCheck | None
    rest_before_first_play_s: float | None
    pause_at_least_s: float | None
    zero_current_at_most_s: float | None
    faults: tuple[SingleFault, ...]

    def __repr__(self) -> str:
        cut = self.cut_off_display_C
        return (
            f"Demands(watchdog {self.watchdog_s:g} s, cut-off {cut.low:g} … {cut.high:g} °C within "
            f"{cut.react_within_s:g} s, {len(self.faults)} single faults)"
        )

    def to_dict(self) -> dict[str, object]:
        """All of it, as a sidecar holds it under `hardware_must_prevent`."""
        return asdict(self)


MAPPED = (
    "watchdog_s", "cut_off_display_C", "polarity_check", "rest_before_first_play_s", "pause_at_least_s",
)  # fmt: skip
"""Demands that the shipped players implement."""


def strictest(demands: list[Mapping[str, object]]) -> dict[str, object]:
    """Of the demands of several drives, by `to_dict`, those that a player of all of them must keep."""

    def numbers(key: str) -> list[float]:
        return [float(value) for one in demands if isinstance(value := one[key], (int, float))]

    cuts = [cut for one in demands if isinstance(cut := one["cut_off_display_C"], Mapping)]
    checks = [check for one in demands if isinstance(check := one["polarity_check"], Mapping)]
    needed = [check for check in checks if check["needed"]]
    return {
        "watchdog_s": min(numbers("watchdog_s")),
        "cut_off_display_C": {
            "low": min(float(cut["low"]) for cut in cuts),
            "high": max(float(cut["high"]) for cut in cuts),
            "react_within_s": min(float(cut["react_within_s"]) for cut in cuts),
        },
        "polarity_check": dict((needed or checks)[0]) if checks else None,
        "rest_before_first_play_s": max(numbers("rest_before_first_play_s"), default=None),
        "pause_at_least_s": max(numbers("pause_at_least_s"), default=None),
    }
