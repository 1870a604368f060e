"""An icon from a recording of temperature in a CSV file."""

import math
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Literal

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.files.column_choice import is_setting
from thermicon.base.files.measured_table import candidates, measured, missing
from thermicon.base.files.table import Table, read_table
from thermicon.base.files.units import like_units_of_time
from thermicon.base.words.clean_text import name_fault

from ..files.bytes_of import bytes_of
from ..model.context import Context
from ..model.errors import CueErrors, whole_file
from ..model.icon import Icon
from ..model.statements import Hold, Ramp, Rest, Return, Statement, Step
from ..model.units import HIGHEST_C, LONGEST_S, LOWEST_C, Control, fault

TIME = "time_s"
CONTROL_OF: dict[str, Control | None] = {
    "temperature_C": None,
    "target_C": None,
    "setpoint_C": None,
    "display_C": "display",
    "skin_C": "skin",
}
NAMES = (TIME, *CONTROL_OF)
"""Columns that a recording may have, and what the icon then controls; None where the column does not tell."""

MOST_ROWS, MOST_MB = 1_000_000, 200
"""Rows of a recording, about five minutes at 3 kHz, and room for them with many further columns."""
SHORTEST_READ_S = 0.01
"""Nothing that is shorter is a course on skin: its times are in another unit, or have too few digits."""
EXAMPLE = f"{TIME},temperature_C"
_CURE = "fill it in, or remove the row; between readings the course is taken as linear"
_CODES = {"table": "E013", "size": "E004", "cell": "E014", "empty": "E005", "binary": "E006",
          "time": "E015", "unit": "E219"}  # fmt: skip


@checked
def from_csv(
    path: str | Path,
    *,
    name: str | None = None,
    column: str | None = None,
    columns: Mapping[str, str] | None = None,
    control: Literal["display", "skin"] = "display",
    tolerance_K: float = 0.05,
    baseline_C: float | None = None,
) -> Icon:
    r"""Return an icon that stays within a tolerance of every reading of a CSV file.

    Parameters
    ----------
    path
        A file with a column ``time_s`` (s, from any start) and one of ``temperature_C``, ``target_C``, ``setpoint_C``,
        ``display_C`` and ``skin_C`` (°C), separated by commas, semicolons or tabs. A time that occurs twice is a step.
    name
        Name of the icon; None: the name of the file.
    column
        Column to read in place of those above.
    columns
        What the file calls ours, such as ``{"time_s": "t"}``, where that does not follow from its names.
    control
        What the icon controls, unless the column is ``display_C`` or ``skin_C``.
    tolerance_K
        Largest deviation from any reading, in K.
    baseline_C
        Baseline in °C, within the tolerance of the first reading; None: the first reading.

    Returns
    -------
    Icon
        The icon, with ramps and holds in place of the readings.

    Raises
    ------
    CueErrors
        For a fault of the file, with its row.
    ValueError
        For any other argument.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "dip.csv"
    ...     _ = path.write_text("time_s,skin_C\n0,32\n2,26\n4,26.02\n6,25.98\n8,32\n")
    ...     from_csv(path).corners().value
    (32.0, 26.0, 26.0, 32.0)
    """
    read = read_readings(path, column, columns)
    stem = re.sub(r"[\W_]+", "-", Path(path).stem).strip("-")
    usual = f"recorded-{stem}".rstrip("-") if name_fault(stem) else stem
    return _icon(read, name or usual, control, tolerance_K, baseline_C)


@checked
def from_samples(
    time_s: Iterable[float],
    temperature_C: Iterable[float],
    *,
    name: str = "recorded",
    control: Literal["display", "skin"] = "display",
    tolerance_K: float = 0.05,
    baseline_C: float | None = None,
) -> Icon:
    """Return an icon that stays within a tolerance of every sample, as `from_csv` does for a file.

    Parameters
    ----------
    time_s, temperature_C
        Times in s from any start, and temperatures in °C; a time that occurs twice is a step.
    name, control, tolerance_K, baseline_C
        As in `from_csv`: name, what is controlled, largest deviation in K, and baseline in °C.

    Returns
    -------
    Icon
        The icon, with ramps and holds in place of the samples.

    Examples
    --------
    >>> from_samples([0, 2, 4, 6, 8], [32, 26, 26.02, 25.98, 32]).corners().value
    (32.0, 26.0, 26.0, 32.0)
    """
    times, levels = list(time_s), list(temperature_C)
    if len(times) != len(levels):
        raise InputError(f"from_samples: {len(times)} times for {len(levels)} temperatures; give as many of both")
    rows = (f"{float(time)!r},{float(level)!r}\n" for time, level in zip(times, levels, strict=True))
    read = _readings("samples", "".join([f"{EXAMPLE}\n", *rows]).encode(), None, None)
    return _icon(read, name, control, tolerance_K, baseline_C)


def _icon(read: "Readings", name: str, control: Control, tolerance_K: float, baseline_C: float | None) -> Icon:
    if not 0 < tolerance_K < math.inf:
        what = "tolerance_K must be a positive temperature difference in K"
        raise InputError(f"{what}, such as 0.05, not {tolerance_K!r}")
    if baseline_C is not None and (found := fault(float(baseline_C), "absolute")):
        raise InputError(f"baseline_C: {found[1]}")
    for note in read.notes:
        warnings.warn(note, stacklevel=4)
    first = read.level_C[0]
    if baseline_C is not None and abs(baseline_C - first) > tolerance_K:
        what = f"the recording begins at {first:g} °C, baseline_C is {baseline_C:g} °C"
        help = f"an icon begins at baseline, here within {tolerance_K:g} K; leave baseline_C out, or cut the file"
        raise whole_file("E016", f"{read.file}:{read.first_row}", what, help)
    from .polyline import fit_corners

    try:
        corners = fit_corners(read.time_s, read.level_C, tolerance_K, baseline_C)
    except ValueError as problem:
        help = "give a larger tolerance, or smooth or cut the recording"
        raise whole_file("E220", read.file, str(problem), help) from None
    context = Context(CONTROL_OF.get(read.column) or control, corners[1][0])
    return Icon(name, tuple(_statements(*corners)), context)


def _statements(times: Sequence[float], levels: Sequence[float]) -> Iterator[Statement]:
    baseline = levels[0]
    for (start, before), (end, after) in pairwise(zip(times, levels, strict=True)):
        duration = round(end - start, 9)
        if duration == 0:
            yield Step("warm" if after > before else "cool", to_C=after)
        elif before == after:
            yield Rest(duration) if after == baseline else Hold(duration)
        elif after == baseline:
            yield Return(duration_s=duration)
        else:
            yield Ramp("warm" if after > before else "cool", to_C=after, duration_s=duration)


@dataclass(frozen=True, slots=True)
class Readings:
    """A recording: ``file``, ``column``, times (s) from 0, temperatures (°C), and the row of the first."""

    file: str
    column: str
    time_s: tuple[float, ...]
    level_C: tuple[float, ...]
    first_row: int
    notes: tuple[str, ...] = ()


def read_readings(path: str | Path, column: str | None = None, columns: Mapping[str, str] | None = None) -> Readings:
    """The recording in a CSV file, of a `column` or by its header; ValueError on what is wrong in which row."""
    most = int(MOST_MB * 1_000_000)
    data = bytes_of(Path(path), "recording", ".csv", most, f"at most {most:,} are read; keep every tenth row")
    if data is None:
        raise whole_file("E001", str(path), "no file has this name", "check its folder and its spelling")
    return _readings(str(path), data, column, columns)


def _readings(file: str, data: bytes, column: str | None, columns: Mapping[str, str] | None) -> Readings:
    def fault(kind: str, line: int | None, what: str, cure: str) -> CueErrors:
        return whole_file(_CODES[kind], f"{file}:{line}" if line else file, what, cure)

    own = None if column in (None, *NAMES) else column
    theirs = {**(columns or {}), **({"temperature_C": own} if own else {})}
    table = read_table(data, fault, EXAMPLE, MOST_ROWS, NAMES, theirs)
    given = next((name for name in theirs if name in CONTROL_OF and name in table.names.renamed), column)
    chosen = _column(f"{file}:{table.line}", table, given, columns)
    found = measured(table, [chosen], _CURE, gaps=False, steps=True)
    times, levels = found.time_s.tolist(), found.columns[chosen].tolist()
    if (length := times[-1] - times[0]) > LONGEST_S:
        like = None if found.clocked else like_units_of_time(found.time_s, whole=False)
        help = f"if these are {like[0]}, {like[1]}; otherwise cut the file" if like else "cut the file"
        what = f"{TIME} runs over {length:,.6g} s"
        raise whole_file("E221", file, what, f"an icon lasts at most {LONGEST_S:g} s; {help}")
    if length < SHORTEST_READ_S:
        raise table.fault("time", None, f"{TIME} runs over {length:g} s", "check the unit of the times")
    for line, level in zip(found.lines, levels, strict=True):
        if not LOWEST_C <= level <= HIGHEST_C:
            what = f"{chosen} is {level:g}; an icon keeps to {LOWEST_C:g} to {HIGHEST_C:g} °C".replace("-", "−")
            raise fault("unit", line, what, "correct it, or remove the row, if it is an error of the sensor")
    # From 0 s on, without the stray digits that differences of large times have.
    digits = min(9, math.floor(-math.log10(math.ulp(max(abs(times[0]), abs(times[-1]))))))
    rising = tuple(round(time - times[0], digits) for time in times)
    notes = tuple(f"{file}: {note}" for note in (*found.notes, *_gap_notes(rising)))
    return Readings(file, chosen, rising, tuple(levels), found.lines[0], notes)


def _gap_notes(time_s: tuple[float, ...]) -> list[str]:
    import numpy as np

    from .polyline import gaps

    steps = np.diff(time_s)
    begins = np.flatnonzero(gaps(np.array(time_s))).tolist()
    longest = max(begins, key=lambda row: steps[row], default=0)
    several = f"{len(begins)} gaps, the longest" if len(begins) > 1 else "a gap"
    what = f"{several} of {steps[longest]:.6g} s from {time_s[longest]:.6g} s on, without readings"
    return [f"{what}: the icon goes straight across"] if begins else []


def _column(place: str, table: Table, column: str | None, columns: Mapping[str, str] | None) -> str:
    if lost := [name for name in columns or {} if name in table.lost]:
        raise table.fault("table", table.line or None, table.lost[lost[0]], "the name must be spelled as in the file")
    known = [cell for cell in table.header if cell in CONTROL_OF]
    readings = [name for name in known if not is_setting(name.rpartition("_")[0])]
    if column is None and len(known) > 1 and len(readings) != 1:
        what = f"{' and '.join((', '.join(known[:-1]), known[-1]))} are all temperatures"
        raise whole_file("E013", place, what, "say which").to(column=[*readings, *known][0])
    if column is None and not readings and (not known or candidates(table, "temperature_C")):
        raise missing(table, "temperature_C", f"or {', '.join(list(CONTROL_OF)[1:])}")
    chosen = column or (readings or known)[0]
    if chosen not in table.header or chosen == TIME:
        what = f"no temperature is called {chosen!r}; found {table.found}"
        raise whole_file("E013", place, what, "the name must be spelled as in the file")
    return chosen
