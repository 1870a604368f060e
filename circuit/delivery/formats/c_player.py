"""The player that accompanies C arrays: a header for a microcontroller, with cut-off, watchdog, abort and pauses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import resources

from ..delivered_drive import DeliveredDrive
from ..prevent import MustPrevent
from .form import Played

PLAYER = "thermicon_player.h"

OUTPUT_UNITS = {"volts": "volts", "amperes": "amperes", "duty": "duty, -1 ... 1", "temperatures": "amperes"}


def player_files(drives: Sequence[Played], must: MustPrevent) -> dict[str, bytes]:
    """Return the player for drives of one device, with the numbers that the hardware must keep to."""
    first = drives[0].delivery
    numbers = {
        "CLOSED_LOOP": str(int(first.device.driven_by == "temperatures")),
        "WATCHDOG_S": c_float(must.watchdog_s),
        "LOW_C": c_float(must.low_C),
        "HIGH_C": c_float(must.high_C),
        "REACT_S": c_float(max(0.01, must.react_within_s)),
        "REST_S": c_float(must.rest_s),
        "PAUSE_S": c_float(must.pause_s),
        "TEST_POLARITY": str(int(must.test_polarity)),
        "TEST_COMMAND": c_float(command_for(first, must.test_current_A)),
        "TEST_UNIT": OUTPUT_UNITS[first.device.driven_by],
        "TEST_S": c_float(must.test_s),
        "TEST_FALL_K": c_float(must.test_fall_K),
        **dict(zip(("KP", "KI", "KD"), map(c_float, must.gains), strict=True)),
        **dict(zip(("LOWEST_A", "HIGHEST_A"), map(c_float, must.limits_A), strict=True)),
        "OUTPUT_UNIT": OUTPUT_UNITS[first.device.driven_by],
        "VERDICTS": "\n".join(f"   {played.file}: {played.verdict}." for played in drives),
    }
    return {PLAYER: filled(PLAYER, numbers)}


def filled(template: str, values: Mapping[str, str]) -> bytes:
    """Return a template of `circuit/data` with each `@NAME@` replaced."""
    text = (resources.files("thermicon.circuit") / "data" / template).read_text("utf-8")
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    return text.encode("ascii")


def command_for(delivery: DeliveredDrive, current_A: float) -> float:
    """The command of a device for a test current in A, in what it puts out: V, A or mean duty."""
    device = delivery.device
    if device.driven_by == "volts":
        return current_A / delivery.rig.driver.transconductance_A_per_V
    if device.driven_by == "duty":
        return min(1.0, current_A / device.bridge_A)
    return current_A


def c_float(value: float) -> str:
    """A number as a C float literal.

    >>> c_float(0.1), c_float(60)
    ('0.1f', '60.0f')
    """
    return f"{float(value)!r}f"
