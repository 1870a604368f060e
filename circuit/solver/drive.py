"""A drive: the current through a rig's module as rows over time.

At duty D and current Ip a bridge pumps α·T·D·Ip, but its resistance heats with D·Ip², where a steady current of the
same mean heats with (D·Ip)². A slow cycle also ripples the plate.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import InputError, read_bytes, table_fault
from thermicon.base.files.measured_table import measured, missing
from thermicon.base.files.table import read_table
from thermicon.base.files.units import like_units_of_time
from thermicon.base.numbers.arrays import Array

from ..rig.module import ZERO_C_IN_K, Peltier

COLUMNS = ("time_s", "current_A")
MOST_MB, MOST_ROWS = 200, 10_000_000
"""Largest drive file, and its rows."""

SHORTEST_S, LONGEST_S, MOST_A = 1e-15, 1e7, 1e6
"""Closest rows in s, far below the switching time of any driver and far above rounding; longest drive in s,
four months; largest current in A, far above what any module takes."""
STEP_S = 1e-6
"""Length of a step in s, where a file has two currents at one time."""


class DriveError(InputError):
    """A drive that cannot be played, or a drive file that cannot be read."""


@checked
@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """A current against time.

    Parameters
    ----------
    time_s
        Times in s, increasing from 0.
    current_A
        Current in A at each time, positive cools the skin.
    held
        Whether each current is held until the next time; otherwise it is linear between times.

    Raises
    ------
    DriveError
        For lengths that differ, fewer than two rows, times that do not increase from 0, and numbers out of range.

    Examples
    --------
    >>> Drive([0, 1, 4], [0.0, 0.5, 0.5])
    Drive(3 rows, 4 s, 0 … 0.5 A, linear)
    """

    time_s: Array
    current_A: Array
    held: bool = False

    def __init__(self, time_s: Array | Sequence[float], current_A: Array | Sequence[float], held: bool = False) -> None:
        times, currents = np.array(time_s, dtype=np.float64), np.array(current_A, dtype=np.float64)
        for array in (times, currents):
            array.setflags(write=False)
        object.__setattr__(self, "time_s", times)
        object.__setattr__(self, "current_A", currents)
        object.__setattr__(self, "held", held)
        if times.ndim != 1 or times.shape != currents.shape:
            raise DriveError(f"a drive needs one current for each time; got {times.shape} and {currents.shape}")
        if len(times) < 2:
            raise DriveError(f"a drive needs at least two rows, a start and an end; got {len(times)}")
        if not (np.isfinite(times).all() and np.isfinite(currents).all()):
            row = int(np.flatnonzero(~(np.isfinite(times) & np.isfinite(currents)))[0])
            raise DriveError(f"row {row + 1}: time {times[row]:g} s, current {currents[row]:g} A; both must be finite")
        if times[0] != 0:
            raise DriveError(f"row 1: time {times[0]:g} s; a drive starts at 0 s")
        if (np.diff(times) <= 0).any():
            row = int(np.flatnonzero(np.diff(times) <= 0)[0]) + 1
            raise DriveError(
                f"row {row + 1}: time {times[row]:g} s does not come after {times[row - 1]:g} s; times must increase"
            )
        if times[-1] > LONGEST_S:
            raise DriveError(f"the last row is at {times[-1]:g} s; a drive lasts {LONGEST_S:g} s at most")
        if (np.diff(times) < SHORTEST_S).any():
            row = int(np.flatnonzero(np.diff(times) < SHORTEST_S)[0]) + 1
            raise DriveError(
                f"row {row + 1}: time {times[row]:.12g} s comes {times[row] - times[row - 1]:.2g} s after the row "
                f"before; rows are at least {SHORTEST_S:g} s apart, since no driver switches faster"
            )
        if (np.abs(currents) > MOST_A).any():
            row = int(np.argmax(np.abs(currents)))
            raise DriveError(f"row {row + 1}: current {currents[row]:g} A; at most {MOST_A:g} A either way are played")

    def __repr__(self) -> str:
        low, high = self.current_A.min(), self.current_A.max()
        form = "held" if self.held else "linear"
        return f"Drive({len(self.time_s)} rows, {self.time_s[-1]:g} s, {low:g} … {high:g} A, {form})"

    def at(self, time_s: Array) -> Array:
        """Current in A at times in s; at a jump, the current after it."""
        if self.held:
            place = np.searchsorted(self.time_s, time_s + 1e-9, side="right") - 1
            return self.current_A[np.clip(place, 0, len(self.current_A) - 1)]
        return np.asarray(np.interp(time_s, self.time_s, self.current_A), dtype=np.float64)


@checked
def read_drive(path: str | Path, hold: bool = False, columns: Mapping[str, str] | None = None) -> Drive:
    r"""Read a drive from a CSV file with the columns `time_s` and `current_A`; two currents at one time are a step.

    Parameters
    ----------
    path
        The file.
    hold
        Whether each current is held until the next row; otherwise it is linear between rows.
    columns
        What the file calls ours, such as `{"current_A": "I1"}`, where that does not follow from its names.

    Returns
    -------
    Drive
        The current against time.

    Raises
    ------
    DriveError
        With the line at fault.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "drive.csv"
    ...     _ = path.write_text("time_s,current_A\n0,0\n2,0.5\n")
    ...     read_drive(path)
    Drive(2 rows, 2 s, 0 … 0.5 A, linear)
    """
    where = Path(path)
    data = read_bytes(where, "drive file", MOST_MB, DriveError)
    table = read_table(data, table_fault(where, DriveError), ",".join(COLUMNS), MOST_ROWS, COLUMNS, columns)
    if "current_A" not in table.header:
        if "duty" in table.header:
            raise DriveError(
                f"{where}:1: these are duties of a bridge, which switches its full current within every row, so that "
                f"there is no current to hold; only drives for a device driven by volts or amperes can be replayed, "
                f"and what this one does is in the sidecar beside it, under predicted"
            )
        raise missing(table, "current_A", "current in A")
    found = measured(table, COLUMNS[1:], "correct it, or remove the row", gaps=False, steps=True)
    for note in found.notes:
        warnings.warn(f"{where}: {note}", stacklevel=2)
    times = found.time_s - found.time_s[0]
    again, room = np.append(False, np.diff(times) == 0), np.append(np.diff(times), STEP_S) / 2
    times = times + np.where(again, np.minimum(STEP_S, room), 0.0)
    try:
        return Drive(times, found.columns["current_A"], hold)
    except DriveError as problem:
        like = None if found.clocked else like_units_of_time(times, whole=False)
        cure = f"these look like {like[0]}; {like[1]} to have s" if like else "check the unit of the times"
        raise DriveError(f"{where}: {problem}; {cure}") from None


SIMULATED_CARRIER_HZ = 500.0
"""Fastest switching that is simulated: at 500 Hz and 1.5 A the display already ripples by under 10 mK, and a faster
bridge ripples less, so that nothing is understated."""


def duty_of(
    rule: str, current_A: Array, peak_A: float, module: Peltier, cold_C: Array, hotter_K: Array | float = 0.0
) -> Array:
    """Signed duties (n,) that replace currents (n,) in A, with the cold plate at temperatures (n,) in °C.

    `mean current` keeps the mean, I/Ip. `equal heat` takes as much heat from the cold plate as the steady current does;
    where the bridge's own current is past the greatest cooling, there is no such duty, and the mean is kept. `hotter_K`
    (n,): how much hotter the bridge makes the hot plate, whose heat leaks back and is taken away as well.
    """
    mean = np.clip(current_A / peak_A, -1.0, 1.0)
    if rule == "mean current":
        return np.asarray(mean)
    pumped = module.seebeck_V_per_K * (cold_C + ZERO_C_IN_K)
    joule = 0.5 * module.resistance_ohm
    heat = pumped * current_A - joule * current_A**2 + np.asarray(hotter_K) / module.thermal_resistance_K_per_W
    per_duty = pumped * peak_A - np.sign(heat) * joule * peak_A**2
    duty = np.where(per_duty > 0, heat / np.where(per_duty > 0, per_duty, 1.0), mean)
    return np.asarray(np.clip(duty, -1.0, 1.0))


def switched(duty: Array, rate_Hz: float, carrier_Hz: float, peak_A: float) -> Drive:
    """A bridge's current for duties (n + 1,) of an update each, the last for none; fast carriers are slowed down."""
    cycles = round(min(carrier_Hz, max(rate_Hz, SIMULATED_CARRIER_HZ)) / rate_Hz)
    share = np.repeat(duty[:-1], cycles)
    begin = np.arange(len(share)) / (cycles * rate_Hz)
    times = np.stack([begin, begin + np.abs(share) / (cycles * rate_Hz)], axis=1)
    currents = np.stack([np.sign(share) * peak_A, np.zeros(len(share))], axis=1)
    nonempty = np.stack([share != 0, np.abs(share) < 1], axis=1)
    end = (len(duty) - 1) / rate_Hz
    return Drive(np.append(times[nonempty], end), np.append(currents[nonempty], duty[-1] * peak_A), held=True)
