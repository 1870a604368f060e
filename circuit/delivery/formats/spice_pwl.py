"""SPICE PWL: pairs of time and value, for `PWL file=NAME` in LTspice and `filesource` in ngspice."""

from __future__ import annotations

from ..delivered_drive import DeliveredDrive
from ..netlist_drive import EDGE_S, points
from .form import PLAYS_CURRENT, Column, Format, command_column


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Time and command, without a header, as the programs want it."""
    command = command_column(delivery)
    return (Column("1", "s", "time"), Column("2", command.unit, f"{command.name}; a jump is a flank of 1 µs"))


def write(delivery: DeliveredDrive) -> bytes:
    """Return a line for each corner of the command; rows that change nothing are left out.

    A source keeps its last value indefinitely, so the last line is the rest, 1 µs after the end.
    """
    gain = delivery.rig.driver.transconductance_A_per_V if delivery.device.driven_by == "volts" else 1.0
    drive = delivery.delivered
    pairs = [*points(drive, None), (float(drive.time_s[-1]) + EDGE_S, float(drive.current_A[-1]))]
    return "".join(f"{time!r} {current / gain!r}\n" for time, current in pairs).encode("ascii")


FORMAT = Format(
    name="spice-pwl",
    title="piecewise linear source of LTspice and ngspice",
    suffix=".pwl",
    takes=PLAYS_CURRENT,
    device="dac-16",
    source='sigrok wiki, "File format:Pwl": pairs of time and value, times increasing; ngspice manual, filesource',
    how="LTspice: a source with PWL file=NAME; ngspice: XSPICE filesource, column 1 the time",
    write=write,
    columns=columns,
)
