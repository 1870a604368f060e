"""Set-point CSV: one row per update with the temperature at which a controller holds the display."""

from __future__ import annotations

import csv
import io

import numpy as np

from ...arrays import Array
from ..delivered_drive import DeliveredDrive
from ..device import Device
from .csv_table import marks_of
from .form import PLAYS_TEMPERATURES, Column, Format, command_column, samples_of

VOLTAGE = Column("command_V", "V", "voltage that stands for the set-point: offset + gain · display_C")


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Time, set-point, its voltage where the device states a gain, event."""
    return (
        Column("time_s", "s", "time of the row; the icon begins in the second row, and a row is held until the next"),
        command_column(delivery),
        *((VOLTAGE,) if has_voltage(delivery.device) else ()),
        Column("event", "", "what the icon prescribes from this row on; the last row marks the end"),
    )


def has_voltage(device: Device) -> bool:
    """Whether set-points can be put out as a voltage."""
    return device.record("set-point gain") is not None


def volts_of(device: Device, display_C: Array) -> Array:
    """Voltage in V for set-points in °C, by the gain and offset that a device states."""
    gain, offset = device.record("set-point gain"), device.record("set-point offset")
    assert gain is not None
    return (0.0 if offset is None else offset.central) + gain.central * display_C


def write(delivery: DeliveredDrive) -> bytes:
    """Return the table; temperatures have as many decimals as the device's step."""
    samples, device = samples_of(delivery), delivery.device
    times, levels = samples.time_s, samples.command
    decimals = max(0, int(np.ceil(-np.log10(samples.scale.step) - 1e-9)))
    volts = volts_of(device, levels) if has_voltage(device) else None
    marks = marks_of(delivery, times)
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(column.name for column in columns(delivery))
    for row, (time, level) in enumerate(zip(times.tolist(), levels.tolist(), strict=True)):
        voltage = () if volts is None else (f"{volts[row]:.6f}",)
        rows.writerow([repr(time), f"{level:.{decimals}f}", *voltage, "; ".join(marks.get(row, ()))])
    return text.getvalue().encode("utf-8")


FORMAT = Format(
    name="setpoint-csv",
    title="table of set-points for a temperature controller",
    suffix=".csv",
    takes=PLAYS_TEMPERATURES,
    device="closed-loop-controller",
    source="thermicon's own columns, described in the sidecar",
    how="give the controller each row's display_C at its time; it holds the display there until the next row",
    write=write,
    columns=columns,
)
