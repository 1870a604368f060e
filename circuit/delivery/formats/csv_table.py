"""CSV: one row per update, with the current that flows; `thermicon simulate --current FILE --hold` replays it."""

from __future__ import annotations

import csv
import io

import numpy as np

from ...arrays import Array
from ..delivered_drive import DeliveredDrive
from .form import PLAYS_SAMPLES, Column, Format, command_column, events_in, samples_of

FIRST = "rest"


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Time, current (not for a bridge, whose current switches), command, code, event."""
    current = Column("current_A", "A", "current through the module, held until the next row; positive cools the skin")
    return (
        Column("time_s", "s", "time of the row; the icon begins in the second row, and a row is held until the next"),
        *(() if delivery.device.driven_by == "duty" else (current,)),
        command_column(delivery),
        Column("code", "", "the command as a whole number of the device's steps"),
        Column("event", "", "what the icon prescribes from this row on; the last row marks the end"),
    )


def write(delivery: DeliveredDrive) -> bytes:
    """Return the table; numbers are written so that they are read back exactly, each event in the first row of its own.

    A device with more than 10,000 updates a second gets a row for each change of the command.
    """
    samples = samples_of(delivery)
    row_numbers = samples.rows()
    times, command, codes = samples.time_s[row_numbers], samples.command[row_numbers], samples.codes[row_numbers]
    current = None if delivery.device.driven_by == "duty" else delivery.delivered.at(times)
    marks = marks_of(delivery, times)
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(column.name for column in columns(delivery))
    for row in range(len(times)):
        numbers = [times[row], *(() if current is None else (current[row],)), command[row]]
        rows.writerow([*map(repr, map(float, numbers)), int(codes[row]), "; ".join(marks.get(row, ()))])
    return text.getvalue().encode("utf-8")


def marks_of(delivery: DeliveredDrive, time_s: Array) -> dict[int, list[str]]:
    """Names of what begins in a row, by the row: the rest in the first, each event in the first row of its own."""
    marks, last = {0: [FIRST]}, len(time_s) - 1
    for event in events_in(delivery):
        row = last if event.name == "end" else min(int(np.searchsorted(time_s, event.time_s - 1e-8)), last)
        marks.setdefault(row, []).append(event.name)
    return marks


FORMAT = Format(
    name="csv",
    title="table with a row for each update",
    suffix=".csv",
    takes=PLAYS_SAMPLES,
    device="dac-16",
    source="thermicon's own columns, described in the sidecar",
    how="put out each row's command at its time and hold it until the next",
    write=write,
    columns=columns,
)
