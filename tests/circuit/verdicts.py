"""A made-up verdict, for tests of what is written after a gate has passed a drive."""

from types import SimpleNamespace
from typing import Any

MADE_UP: dict[str, Any] = {
    "watchdog_s": 0.4,
    "cut_off_display_C": {"low": 20.0, "high": 40.0, "react_within_s": 0.1},
    "polarity_check": {"needed": True, "test_current_A": 0.2, "test_s": 0.5, "display_change_at_least_K": 0.15},
    "rest_before_first_play_s": 30.0,
    "pause_at_least_s": 20.0,
}


class GreenVerdict:
    """A gate that is green and says what the hardware must prevent."""

    colour, reason, cautions, scenarios, findings, mended_by_pause = "green", None, (), 1, (), False

    def __init__(self, delivery: object) -> None:
        self.delivery = delivery

    notes: tuple[str, ...] = ()
    repeated = SimpleNamespace(recovery_s=None, shortest_pause_s=None)
    demanded = MADE_UP

    def to_dict(self) -> dict[str, object]:
        return {"colour": "green"}
