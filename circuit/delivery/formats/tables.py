"""CSV: one row per update with the current or with the set-point of a controller.

`thermicon simulate --current FILE --hold` replays the first. For the TCS II, the commands of its serial line, which
play any profile on all five zones.
"""

import csv
import io
from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from thermicon.base.numbers.arrays import Array

from ..commands import Column
from ..delivered_drive import DeliveredDrive, ModuleDrive, ThermodeDrive
from ..device import Device
from ..setpoints import Setpoints
from .form import PLAYS_SAMPLES, PLAYS_TEMPERATURES, Format, FormatError, events_in, samples_of

FIRST = "rest"
TIME = Column("time_s", "s", "time of the row; the icon begins in the second row, and a row is held until the next")
CURRENT = Column("current_A", "A", "current through the module, held until the next row; positive cools the skin")
CODE = Column("code", "", "the command as a whole number of the device's steps")
VOLTAGE = Column("command_V", "V", "voltage that stands for the set-point: offset + gain · display_C")
EVENT = Column("event", "", "what the icon prescribes from this row on; the last row marks the end")

ALL_ZONES = "11111"
ABOVE_K, MOST = 1.0, 600
"""The greatest temperature of a stimulation (Om) is set this far above the highest set-point, up to the 60 °C that the
instrument reaches, in tenths of a degree."""


TICK_S, STEP_K, LARGEST = 0.01, 0.1, 999
"""Units of the commands: segments last ticks of 10 ms, levels are tenths of a degree, each in three digits."""


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Time, current (not for a bridge, whose current switches), command, code, event."""
    kind = delivery.device.kind
    return (TIME, *(() if kind.switches else (CURRENT,)), kind.command, CODE, EVENT)


def setpoint_columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Time, set-point, its voltage where the device states a gain, event."""
    return (TIME, delivery.device.kind.command, *((VOLTAGE,) if has_voltage(delivery.device) else ()), EVENT)


def write(delivery: DeliveredDrive) -> bytes:
    """Return the table; above 10,000 updates a second it has a row for each change of the command."""
    return write_rows(delivery, samples_of(delivery).rows())


def write_rows(delivery: DeliveredDrive, rows: npt.NDArray[np.intp]) -> bytes:
    """Return the table of some samples, by their places."""
    assert isinstance(delivery, ModuleDrive)
    samples, switches = delivery.played, delivery.device.kind.switches
    times = samples.time_s[rows]
    current = () if switches else (delivery.delivered.at(times),)
    numbers = zip(*(map(repr, each.tolist()) for each in (times, *current, samples.command[rows])), strict=True)
    cells = ([*each, code] for each, code in zip(numbers, samples.codes[rows].tolist(), strict=True))
    return _written(delivery, columns(delivery), times, cells)


def write_setpoints(delivery: DeliveredDrive) -> bytes:
    """Return the table; temperatures have as many decimals as the device's step."""
    samples, device = samples_of(delivery), delivery.device
    times, levels = samples.time_s, samples.command
    decimals = max(0, int(np.ceil(-np.log10(samples.scale.step) - 1e-9)))
    volts = volts_of(device, levels) if has_voltage(device) else None
    cells = (
        [repr(time), f"{level:.{decimals}f}", *(() if volts is None else (f"{volts[row]:.6f}",))]
        for row, (time, level) in enumerate(zip(times.tolist(), levels.tolist(), strict=True))
    )
    return _written(delivery, setpoint_columns(delivery), times, cells)


def write_predicted(delivery: DeliveredDrive) -> bytes:
    """Return the display that is predicted for set-points, at the times of their rows; shaped ones lie beside it."""
    times = samples_of(delivery).time_s
    display_C = np.interp(times, delivery.trace.time_s, delivery.trace.display_C)
    rows = (f"{time!r},{level:.4f}\n" for time, level in zip(times.tolist(), display_C.tolist(), strict=True))
    return ("time_s,display_C\n" + "".join(rows)).encode("ascii")


def _written(
    delivery: DeliveredDrive, names: Sequence[Column], time_s: Array, cells: Iterable[Sequence[object]]
) -> bytes:
    """A table with the events as its last column: the rest in the first row, each event in the first row of its own."""
    marks, last = {0: [FIRST]}, len(time_s) - 1
    for event in events_in(delivery):
        row = last if event.name == "end" else min(int(np.searchsorted(time_s, event.time_s - 1e-8)), last)
        marks.setdefault(row, []).append(event.name)
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(column.name for column in names)
    rows.writerows([*each, "; ".join(marks.get(row, ()))] for row, each in enumerate(cells))
    return text.getvalue().encode("utf-8")


def has_voltage(device: Device) -> bool:
    """Whether it takes set-points that can be put out as a voltage."""
    return device.kind.regulated and device.record("set-point gain") is not None


def volts_of(device: Device, display_C: Array) -> Array:
    """Voltage in V for set-points in °C, by the gain and offset that a device states."""
    gain, offset = device.record("set-point gain"), device.record("set-point offset")
    assert gain is not None
    return (0.0 if offset is None else offset.central) + gain.central * display_C


CSV = Format(
    name="csv",
    title="table with a row for each update",
    suffix=".csv",
    takes=PLAYS_SAMPLES,
    device="dac-16",
    source="thermicon's own columns, described in the sidecar",
    how="output each row's value at its time and hold it until the next row",
    write=write,
    columns=columns,
)

SETPOINT_CSV = Format(
    name="setpoint-csv",
    title="table of set-points for a temperature controller",
    suffix=".csv",
    takes=PLAYS_TEMPERATURES,
    device="closed-loop-controller",
    source="thermicon's own columns, described in the sidecar",
    how="give the controller each row's display_C at its time; it holds the display there until the next row",
    write=write_setpoints,
    columns=setpoint_columns,
)


def serial_columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """The commands, one per line."""
    return (
        Column("N", "0.1 °C", "baseline"),
        Column("Om", "0.1 °C", "greatest temperature that the C command may ask for"),
        Column("Uw", "10 ms, 0.1 °C", "zones, number of segments, then duration and level at the end of each"),
        Column("Ue", "", "zones that play the profile"),
        Column("L", "", "start; send it when the trial begins"),
    )


def serial_write(delivery: DeliveredDrive) -> bytes:
    """Return the commands; the last, L, starts the stimulation."""
    assert isinstance(delivery, ThermodeDrive)
    setpoints = delivery.played
    _check(setpoints, delivery.device.name)
    greatest = max(setpoints.baseline, *(level for _, level in setpoints.segments)) + round(ABOVE_K / setpoints.step_K)
    segments = "".join(f"{ticks:03d}{level:03d}" for ticks, level in setpoints.segments)
    commands = [
        f"N{setpoints.baseline:03d}",
        f"Om{min(greatest, MOST):03d}",
        f"Uw{ALL_ZONES}{len(setpoints.segments):03d}{segments}",
        f"Ue{ALL_ZONES}",
        "L",
    ]
    return ("\n".join(commands) + "\n").encode("ascii")


def _check(setpoints: Setpoints, device: str) -> None:
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


SERIAL = Format(
    name="tcs2-serial",
    title="commands for the serial line of a QST.Lab TCS II",
    suffix=".tcs2.txt",
    takes=("set-points",),
    device="qst-tcs2",
    source="pytcsii (mpcoll), list of commands in its header",
    how="115,200 baud: send each line without its line feed; wait at the baseline before L; A aborts",
    write=serial_write,
    columns=serial_columns,
)
