"""CSV: one row per update with the current or with the set-point of a controller.

`thermicon simulate --current FILE --hold` replays the first. For the TCS II, the commands of its serial line, which
play any profile on all five zones.
"""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import reduce

import numpy as np
import numpy.typing as npt

from thermicon.base.numbers.arrays import Array

from ..commands import Column
from ..delivered_drive import DeliveredDrive, ModuleDrive, ThermodeDrive
from ..device import Device
from ..setpoints import Setpoints
from .form import PLAYS_SAMPLES, PLAYS_TEMPERATURES, Format, FormatError, OneFile, events_in, on_one_clock, samples_of

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
    return _written([delivery], columns(delivery), samples_of(delivery).time_s[rows], [_cells(delivery, rows)])


def write_setpoints(delivery: DeliveredDrive) -> bytes:
    """Return the table; temperatures have as many decimals as the device's step."""
    rows = np.arange(len(samples_of(delivery).codes))
    return _written([delivery], setpoint_columns(delivery), samples_of(delivery).time_s, [_cells(delivery, rows)])


def write_together(deliveries: Sequence[DeliveredDrive], every_update: bool = False) -> bytes:
    """Return the table of several elements on one clock, which has the columns of each."""
    samples = on_one_clock(deliveries)
    rows = np.arange(len(samples[0].codes)) if every_update else reduce(np.union1d, (each.rows() for each in samples))
    cells = [_cells(replace(one, played=each), rows) for one, each in zip(deliveries, samples, strict=True)]
    return _written(deliveries, columns_together(deliveries), samples[0].time_s[rows], cells)


def columns_together(deliveries: Sequence[DeliveredDrive]) -> tuple[Column, ...]:
    """Time, the columns of each element behind its name, event."""
    return (TIME, *(column for one in deliveries for column in _columns_of(one)), EVENT)


def _columns_of(delivery: DeliveredDrive) -> list[Column]:
    """The columns of one element between time and event, behind its name."""
    alone = (setpoint_columns if delivery.device.kind.regulated else columns)(delivery)[1:-1]
    return [replace(column, name=f"{delivery.element}_{column.name}") for column in alone]


def _cells(delivery: DeliveredDrive, rows: npt.NDArray[np.intp]) -> Iterable[Sequence[object]]:
    """What a table has of some samples of one element, between time and event."""
    samples, device = samples_of(delivery), delivery.device
    levels = samples.command[rows]
    if device.kind.regulated:
        decimals = max(0, int(np.ceil(-np.log10(samples.scale.step) - 1e-9)))
        texts = [[f"{level:.{decimals}f}" for level in levels.tolist()]]
        if has_voltage(device):
            texts.append([f"{volts:.6f}" for volts in volts_of(device, levels).tolist()])
        return zip(*texts, strict=True)
    assert isinstance(delivery, ModuleDrive)
    current = () if device.kind.switches else (delivery.delivered.at(samples.time_s[rows]),)
    numbers = (map(repr, each.tolist()) for each in (*current, levels))
    return zip(*numbers, samples.codes[rows].tolist(), strict=True)


def write_predicted(delivery: DeliveredDrive) -> bytes:
    """Return the display that is predicted for set-points, at the times of their rows; shaped ones lie beside it."""
    times = samples_of(delivery).time_s
    display_C = np.interp(times, delivery.trace.time_s, delivery.trace.display_C)
    rows = (f"{time!r},{level:.4f}\n" for time, level in zip(times.tolist(), display_C.tolist(), strict=True))
    return ("time_s,display_C\n" + "".join(rows)).encode("ascii")


def _written(
    deliveries: Sequence[DeliveredDrive],
    names: Sequence[Column],
    time_s: Array,
    cells: Sequence[Iterable[Sequence[object]]],
) -> bytes:
    """A table with the events as its last column: the rest in the first row, each event in the first row of its own."""
    marks, last = {0: [FIRST]}, len(time_s) - 1
    for one in deliveries:
        for event in (each for each in events_in(one) if each.name != "end"):
            row = min(int(np.searchsorted(time_s, event.time_s - 1e-8)), last)
            marks.setdefault(row, []).append(f"{one.element}: {event.name}" if one.element else event.name)
    marks.setdefault(last, []).append("end")
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(column.name for column in names)
    together = zip(map(repr, time_s.tolist()), *cells, strict=True)
    rows.writerows(
        [time, *(cell for each in own for cell in each), "; ".join(marks.get(row, ()))]
        for row, (time, *own) in enumerate(together)
    )
    return text.getvalue().encode("utf-8")


def has_voltage(device: Device) -> bool:
    """Whether it takes set-points that can be put out as a voltage."""
    return device.kind.regulated and device.record("set-point gain") is not None


def volts_of(device: Device, display_C: Array) -> Array:
    """Voltage in V for set-points in °C, by the gain and offset that a device states."""
    gain, offset = device.record("set-point gain"), device.record("set-point offset")
    assert gain is not None
    return (0.0 if offset is None else offset.central) + gain.central * display_C


def channels_together(deliveries: Sequence[DeliveredDrive]) -> tuple[object, ...]:
    """The columns of each element."""
    return tuple([column.name for column in _columns_of(one)] for one in deliveries)


TABLE_TOGETHER = OneFile(write_together, columns_together, channels_together)

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
    together=TABLE_TOGETHER,
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
    together=TABLE_TOGETHER,
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
    _check(delivery.played, delivery.device.name)
    return _commands({ALL_ZONES: delivery.played})


def serial_together(deliveries: Sequence[DeliveredDrive]) -> bytes:
    """Return the commands for elements that are the zones of one thermode; zones that play alike share a profile."""
    zones = zones_of(deliveries)
    profiles: dict[Setpoints, list[str]] = {}
    for zone, one in zip(zones, deliveries, strict=True):
        assert isinstance(one, ThermodeDrive)
        _check(one.played, one.device.name)
        profiles.setdefault(one.played, []).append(zone)
    return _commands({_mask(masks): played for played, masks in profiles.items()})


def zones_of(deliveries: Sequence[DeliveredDrive]) -> tuple[str, ...]:
    """The mask of the zone of each element, in their order; FormatError where the thermode has too few."""
    if len(deliveries) > len(ALL_ZONES):
        raise FormatError(
            f"tcs2-serial: a TCS II has {len(ALL_ZONES)} zones, and the layout {len(deliveries)} elements; give a "
            f"layout of at most {len(ALL_ZONES)}, or another format"
        )
    places = range(len(ALL_ZONES))
    return tuple("".join("1" if each == place else "0" for each in places) for place, _ in enumerate(deliveries))


def _mask(zones: Iterable[str]) -> str:
    """The mask of several zones."""
    return "".join(max(bits) for bits in zip(*zones, strict=True))


def _commands(profiles: Mapping[str, Setpoints]) -> bytes:
    """The commands that play profiles by the mask of their zones, all from one baseline."""
    first, *_ = profiles.values()
    levels = []
    for profile in profiles.values():
        levels += [profile.baseline, *(level for _, level in profile.segments)]
    if len({each.baseline for each in profiles.values()}) > 1:
        raise FormatError("tcs2-serial: all zones have one baseline; give the set one, or the elements one rig")
    loaded = [
        f"Uw{mask}{len(each.segments):03d}" + "".join(f"{ticks:03d}{level:03d}" for ticks, level in each.segments)
        for mask, each in profiles.items()
    ]
    greatest = min(max(levels) + round(ABOVE_K / first.step_K), MOST)
    mask = _mask(profiles)
    alone = [] if mask == ALL_ZONES else [f"S{mask}"]  # a zone without a profile plays what was set before
    commands = [f"N{first.baseline:03d}", f"Om{greatest:03d}", *alone, *loaded, f"Ue{mask}", "L"]
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
    together=OneFile(
        serial_together,
        lambda deliveries: serial_columns(deliveries[0]),
        zones_of,
        "zones 1 to 5 are the elements in the order of the layout",
    ),
)
