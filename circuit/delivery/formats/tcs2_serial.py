"""TCS II over its serial line: a temperature profile of segments for all five zones, as the commands to send."""

from __future__ import annotations

from thermicon.circuit.delivery.formats.form import PLAYS_SETPOINTS, Column, Format, setpoints_in
from thermicon.circuit.delivery.realised import Realised

ZONES = "11111"
ABOVE_K = 1.0
"""The greatest temperature of a stimulation (Om) is set this far above the highest set-point."""


def columns(realised: Realised) -> tuple[Column, ...]:
    """The commands, one a line."""
    return (
        Column("N", "0.1 °C", "baseline"),
        Column("Om", "0.1 °C", "greatest temperature that the C command may ask for"),
        Column("Uw", "10 ms, 0.1 °C", "zones, number of segments, then duration and level at the end of each"),
        Column("Ue", "", "zones that play the profile"),
        Column("L", "", "start; send it when the trial begins"),
    )


def write(realised: Realised) -> bytes:
    """Return the commands; the last, L, starts the stimulation."""
    setpoints = setpoints_in(realised)
    greatest = max(setpoints.baseline, *(level for _, level in setpoints.segments)) + round(ABOVE_K / setpoints.step_K)
    segments = "".join(f"{ticks:03d}{level:03d}" for ticks, level in setpoints.segments)
    commands = [
        f"N{setpoints.baseline:03d}",
        f"Om{min(greatest, 600):03d}",
        f"Uw{ZONES}{len(setpoints.segments):03d}{segments}",
        f"Ue{ZONES}",
        "L",
    ]
    return ("\n".join(commands) + "\n").encode("ascii")


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
