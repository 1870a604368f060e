"""TCS II over its serial line: a temperature profile of segments for all five zones, as the commands to send."""

from __future__ import annotations

from ..delivered_drive import DeliveredDrive
from ..setpoints import Setpoints
from .form import PLAYS_SETPOINTS, Column, Format, FormatError, setpoints_in

ZONES = "11111"
ABOVE_K, MOST = 1.0, 600
"""The greatest temperature of a stimulation (Om) is set this far above the highest set-point, up to the 60 °C that the
instrument reaches, in tenths of a degree."""


TICK_S, STEP_K, LARGEST = 0.01, 0.1, 999
"""Units of the commands: segments last ticks of 10 ms, levels are tenths of a degree, each in three digits."""


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """The commands, one per line."""
    return (
        Column("N", "0.1 °C", "baseline"),
        Column("Om", "0.1 °C", "greatest temperature that the C command may ask for"),
        Column("Uw", "10 ms, 0.1 °C", "zones, number of segments, then duration and level at the end of each"),
        Column("Ue", "", "zones that play the profile"),
        Column("L", "", "start; send it when the trial begins"),
    )


def write(delivery: DeliveredDrive) -> bytes:
    """Return the commands; the last, L, starts the stimulation."""
    setpoints = setpoints_in(delivery)
    _check(setpoints, delivery.device.name)
    greatest = max(setpoints.baseline, *(level for _, level in setpoints.segments)) + round(ABOVE_K / setpoints.step_K)
    segments = "".join(f"{ticks:03d}{level:03d}" for ticks, level in setpoints.segments)
    commands = [
        f"N{setpoints.baseline:03d}",
        f"Om{min(greatest, MOST):03d}",
        f"Uw{ZONES}{len(setpoints.segments):03d}{segments}",
        f"Ue{ZONES}",
        "L",
    ]
    return ("\n".join(commands) + "\n").encode("ascii")


def _check(setpoints: Setpoints, device: str) -> None:
    """Raise FormatError where the commands would differ from the set-points."""
    if abs(setpoints.tick_s - TICK_S) > 1e-9 or abs(setpoints.step_K - STEP_K) > 1e-9:
        raise FormatError(
            f"tcs2-serial counts ticks of {TICK_S * 1e3:g} ms and steps of {STEP_K:g} K; {device} has "
            f"{setpoints.tick_s * 1e3:g} ms and {setpoints.step_K:g} K: use qst-tcs2"
        )
    numbers = [setpoints.baseline, len(setpoints.segments), *(n for segment in setpoints.segments for n in segment)]
    if wrong := [number for number in numbers if not 0 <= number <= LARGEST]:
        raise FormatError(
            f"tcs2-serial writes numbers of three digits, 0 to {LARGEST}; {wrong[0]} is needed for {device}: use "
            f"levels from 0 to {LARGEST * STEP_K:g} °C, and segments and ticks up to {LARGEST}"
        )


FORMAT = Format(
    name="tcs2-serial",
    title="commands for the serial line of a QST.Lab TCS II",
    suffix=".tcs2.txt",
    takes=PLAYS_SETPOINTS,
    device="qst-tcs2",
    source="pytcsii (mpcoll), list of commands in its header",
    how="115,200 baud: send each line without its line feed; wait at the baseline before L; A aborts",
    write=write,
    columns=columns,
)
