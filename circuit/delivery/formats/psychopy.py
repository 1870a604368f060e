"""PsychoPy: a conditions file with a row for each icon, the drives beside it, and a snippet that plays them."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from thermicon.circuit.delivery.formats import csv_table, tcs2_serial
from thermicon.circuit.delivery.formats.form import Column, Format, events_in
from thermicon.circuit.delivery.realised import Realised

SET_FILES = CONDITIONS, PLAYER = "conditions.csv", "play_icons.py"
HEADER = ("icon", "drive_file", "sidecar_file", "duration_s", "ramp_start_s", "target_reached_s", "return_start_s")
"""First columns of the conditions file: names without blanks, as PsychoPy needs them."""

MARKED = ("ramp start", "target reached", "return start", "baseline reached")
"""Events that may happen more than once. The first has a column without a number, as in `ramp_start_s`, the second one
as `ramp_start_2_s`."""

BY_VOLTS = '''"""Plays exported icons on an NI analogue output. Made by thermicon; never played on a device."""

import csv

CHANNEL = "Dev1/ao0"


def play(drive_file):
    """Put out the commands of a drive file in V, each held until the next; returns when the last was put out."""
    import nidaqmx
    from nidaqmx.constants import AcquisitionType

    with open(drive_file, newline="") as file:
        rows = list(csv.DictReader(file))
    volts = [float(row["command_V"]) for row in rows]
    rate = (len(rows) - 1) / float(rows[-1]["time_s"])
    with nidaqmx.Task() as task:
        task.ao_channels.add_ao_voltage_chan(CHANNEL, min_val=-10.0, max_val=10.0)
        task.timing.cfg_samp_clk_timing(rate, sample_mode=AcquisitionType.FINITE, samps_per_chan=len(volts))
        task.write(volts, auto_start=True)
        task.wait_until_done(timeout=len(volts) / rate + 5.0)
'''

BY_SETPOINTS = '''"""Plays exported icons on a QST.Lab TCS II. Made by thermicon; never played on a device."""

PORT = "COM3"


def prepare(port, drive_file):
    """Send everything but the start, so that the trial begins with one short command."""
    with open(drive_file) as file:
        for command in file.read().split():
            if command != "L":
                port.write(command.encode("ascii"))


def play(port):
    """Start what was prepared; port.write(b"A") aborts."""
    port.write(b"L")


def connect():
    """Open the serial line."""
    import serial

    return serial.Serial(PORT, baudrate=115200, timeout=0.1)
'''


def columns(realised: Realised) -> tuple[Column, ...]:
    """Columns of the drive file."""
    return _drive(realised).columns(realised)


def write(realised: Realised) -> bytes:
    """Return the drive file of one icon: a table, or the commands of a thermode."""
    return _drive(realised).write(realised)


def set_files(drives: Sequence[tuple[Realised, str, str]]) -> dict[str, bytes]:
    """Return conditions file and player for drives, each with the names of its drive file and sidecar."""
    marks = [_marks(realised) for realised, _, _ in drives]
    most = max(len(times) for each in marks for times in each.values())
    later = [_column(name, k) for k in range(most) for name in MARKED]
    used = {column for each in marks for name, times in each.items() for column in _columns(name, len(times))}
    header = [*HEADER, *(name for name in later if name in used and name not in HEADER)]
    text = io.StringIO()
    rows = csv.DictWriter(text, header, restval="", lineterminator="\n")
    rows.writeheader()
    for (realised, drive, sidecar), each in zip(drives, marks, strict=True):
        row = {"icon": realised.icon.name, "drive_file": drive, "sidecar_file": sidecar}
        for name, times in each.items():
            row |= {column: f"{time:.9g}" for column, time in zip(_columns(name, len(times)), times, strict=True)}
        rows.writerow(row)
    by_setpoints = drives[0][0].device.driven_by == "set-points"
    player = BY_SETPOINTS if by_setpoints else BY_VOLTS
    return {CONDITIONS: text.getvalue().encode("utf-8"), PLAYER: player.encode("utf-8")}


def _marks(realised: Realised) -> dict[str, list[float]]:
    """Times in s of every event, by its name."""
    found: dict[str, list[float]] = {}
    for event in events_in(realised):
        found.setdefault(event.name, []).append(event.time_s)
    return found


def _columns(name: str, count: int) -> list[str]:
    return ["duration_s"] if name == "end" else [_column(name, k) for k in range(count)]


def _column(name: str, k: int) -> str:
    """Column of an event that happens for the k-th time, from 0.

    >>> _column("ramp start", 0), _column("ramp start", 1)
    ('ramp_start_s', 'ramp_start_2_s')
    """
    return f"{name.replace(' ', '_')}{f'_{k + 1}' if k else ''}_s"


def _drive(realised: Realised) -> Format:
    return tcs2_serial.FORMAT if realised.device.driven_by == "set-points" else csv_table.FORMAT


def _suffix(realised: Realised) -> str:
    return _drive(realised).suffix


FORMAT = Format(
    name="psychopy",
    title="conditions file of PsychoPy with drives and a player",
    suffix=".csv",
    takes=("volts", "set-points"),
    device="ni-analogue-output",
    source="PsychoPy documentation, conditions files: CSV, a header of variable names, a row for each condition",
    how="name conditions.csv in a loop, import play_icons in a code component, and play drive_file",
    write=write,
    columns=columns,
    suffix_by=_suffix,
)
