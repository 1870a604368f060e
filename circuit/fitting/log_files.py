"""Logs from files: CSV and TSV by their header, the TSV of a thermode session with its JSON, and TDMS."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from thermicon.icons.near_words import nearest_words

from ..arrays import Array
from ..inputs import quoted, read_bytes, text_of
from .log import DRIVES, MEASURED, MOST_ROWS, Log, LogError, is_known
from .log_tdms import read_tdms

MOST_MB, MOST_SIDECAR_MB = 200.0, 1.0
OTHER_UNIT = {
    "time_ms": ("time_s", "divide it by 1000"),
    "time_min": ("time_s", "multiply it by 60"),
    "current_mA": ("current_A", "divide it by 1000"),
    "voltage_mV": ("voltage_V", "divide it by 1000"),
    "command_mV": ("command_V", "divide it by 1000"),
    **{f"{name.removesuffix('_C')}_K": (name, "subtract 273.15") for name in MEASURED if name.endswith("_C")},
    **{f"{name.removesuffix('_C')}_F": (name, "convert it to °C") for name in MEASURED if name.endswith("_C")},
}
"""Columns in another unit than a log has, the name they should have, and how to convert them."""

ZONE = re.compile(r"(?:z|zone)_?(?P<zone>[1-9])_?(?P<what>set|setpoint|command|commanded|act|actual|temp|temperature)")
ASIDE = ("#", "sep=")
"""Comments, and the line by which spreadsheets name the separator."""

NOTHINGS = ("n/a", "na", "nan")
"""What loggers write for a missing number."""
NUMBER = re.compile(r"[-+\d.,eE\s]*|n/a|nan")
"""A cell that names no column."""
MISSPELT = 0.85
"""A name of a column that is so much alike a known one is taken for a slip of the pen."""

OTHER_NAMES = {
    "current_A": ("amps", "amp", "ampere", "amperes", "a", "i", "current", "i_a", "amps_a"),
    "voltage_V": ("volts", "volt", "v", "u", "voltage", "u_v"),
    "command_V": ("command", "control", "control_v", "input_v"),
    "display_C": ("display", "temp", "temperature", "temp_c", "thermistor", "thermocouple"),
    "skin_C": ("skin", "skin_temp"),
}
"""Names that people give to columns of a log, in lower case; none is taken for the other without being asked."""

SESSION_TIME = ("time_s", "onset", "time", "t")


def read_log(path: str | Path) -> Log:
    r"""Read a measured log.

    Parameters
    ----------
    path
        A `.csv` (commas, semicolons or tabs), the `.tsv` of a thermode session (five zones become their mean; without
        a header the `Columns` of the `.json` beside it are taken) or a `.tdms` file with waveform channels.

    Returns
    -------
    Log
        Its columns over one clock.

    Raises
    ------
    LogError
        For a file that is not a log, with its line or column and the cure.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "rig.csv"
    ...     rows = "".join(f"{k / 10},0.1,32.0\n" for k in range(30))
    ...     _ = path.write_text("time_s,current_A,display_C\n" + rows)
    ...     read_log(path)
    Log('rig.csv', 30 rows, 2.9 s: current_A, display_C)
    """
    where = Path(path)
    data = read_bytes(where, "log", MOST_MB, LogError)
    digest = hashlib.sha256(data).hexdigest()
    if where.suffix.lower() == ".tdms":
        return Log.of(where.name, read_tdms(data, where.name), sha256=digest)
    return _from_text(where, text_of(data, where, "log", LogError), digest)


def _from_text(where: Path, text: str, digest: str) -> Log:
    first = next((line for line in text.split("\n") if line.strip() and not line.startswith(ASIDE)), None)
    if first is None:
        raise LogError(f"{where}: holds comments only; a log has a line with the names of its columns, and rows")
    mark = next((mark for mark in ("\t", ";", ",") if mark in first), ",")
    lines = csv.reader(io.StringIO(text), delimiter=mark)
    header: list[str] | None = _sidecar(where, first, mark)
    cells: list[list[str]] = []
    places: list[str] = []
    try:
        for row in lines:
            if not any(cell.strip() for cell in row) or row[0].startswith(ASIDE):
                continue
            place = f"{where}:{lines.line_num}"
            if header is None:
                header = [cell.strip() for cell in row]
                _check_header(header, place)
                continue
            if len(row) > len(header):
                raise LogError(
                    f"{place}: {len(row)} cells, the first line names {len(header)} columns; write decimal points, or "
                    f"put semicolons between the cells"
                )
            cells.append(row)
            places.append(place)
            if len(cells) > MOST_ROWS:
                raise LogError(f"{where}: more than {MOST_ROWS:,} rows; keep every tenth row, or cut the log")
    except csv.Error as problem:
        raise LogError(f"{where}:{lines.line_num}: this row cannot be read ({problem}); save it as CSV") from None
    assert header is not None
    wanted = [k for k, name in enumerate(header) if name == "time_s" or is_known(name) or _session_name(name)]
    gaps: list[str] = []
    values = {header[k]: _numbers(cells, places, k, header[k], mark, gaps) for k in wanted}
    merged = _session(values)
    columns = merged or values
    _check_columns(where.name, columns, header)
    notes = (f"{where.name}: display_C and setpoint_C are means over the zones",) if merged else ()
    used = set(values) if merged else set(columns)
    left_out = [name for name in header if name not in used and name != "icon"]
    listed = ", ".join(_with_likely_name(name, columns) for name in left_out[:8])
    texts = tuple(f"{where.name}: {gap}" for gap in gaps)
    return Log.of(where.name, columns, sha256=digest, notes=(*notes, *texts), rows=places, unused=listed)


def _check_header(header: Sequence[str], place: str) -> None:
    doubled = [name for k, name in enumerate(header) if name and name in header[:k]]
    if doubled:
        raise LogError(f"{place}: the column {doubled[0]} appears twice; remove one of them")
    if all(map(NUMBER.fullmatch, header)):
        raise LogError(f"{place}: this line holds numbers, not the names of columns; put time_s,current_A,… above it")


def _check_columns(name: str, columns: Mapping[str, Array], header: Sequence[str]) -> None:
    """Every missing column at once, with what was found and what another unit should be converted to."""
    wrong = [f"{found} should be {right}: {how}" for found, (right, how) in OTHER_UNIT.items() if found in header]
    missing = [] if "time_s" in columns else ["time_s (time in s)"]
    if not any(is_known(column) for column in columns):
        missing.append(f"one of {', '.join(DRIVES)}, or any of {', '.join(MEASURED)}")
    known = ("time_s", *DRIVES, *MEASURED)
    misspelt = [(cell, _misspelt(cell, known)) for cell in header if cell not in columns and cell not in OTHER_UNIT]
    wrong += [f"{cell}: did you mean {name}? Rename it" for cell, name in misspelt if name and name not in columns]
    if not missing and not wrong:
        return
    parts = [f"missing: {', and '.join(missing)}"] if missing else []
    parts += [*wrong, f"found {', '.join(header[:12])}"]
    raise LogError(f"{name}: {'; '.join(parts)}")


def _with_likely_name(cell: str, columns: Mapping[str, Array]) -> str:
    """A column that is not used, with the name it should have where it goes by another that people use."""
    likely = next((name for name, others in OTHER_NAMES.items() if cell.lower() in others), None)
    return cell if likely is None or likely in columns else f"{cell} (rename it {likely}, if that is what it is)"


def _misspelt(cell: str, known: Sequence[str]) -> str | None:
    """The known column that a name is but for case or a letter."""
    close = nearest_words(cell.lower(), [name.lower() for name in known], 1, MISSPELT)
    return next((name for name in known if close and name.lower() == close[0]), None)


def _numbers(
    cells: Sequence[Sequence[str]], places: Sequence[str], at: int, name: str, mark: str, gaps: list[str]
) -> Array:
    """A column (rows,) of cells; empty cells and NaN become NaN, a text is an error with its line.

    What stands for a missing number is counted in `gaps`.
    """
    values, texts = np.empty(len(cells)), dict[str, int]()
    for k, row in enumerate(cells):
        cell = row[at].strip() if at < len(row) else ""
        if mark != "," and "," in cell:
            cell = cell.replace(",", ".")
        if cell.lower() in NOTHINGS:
            texts[cell] = texts.get(cell, 0) + 1
            cell = ""
        try:
            values[k] = float(cell) if cell else np.nan
        except ValueError:
            raise LogError(f"{places[k]}: {name} is {quoted(cell)}, not a number; leave the cell empty") from None
    values[~np.isfinite(values)] = np.nan
    gaps += [
        f"{name} is {quoted(text)} in {count:,} of {len(cells):,} rows, which are taken as gaps"
        for text, count in texts.items()
    ]
    return values


def _sidecar(where: Path, first: str, mark: str) -> list[str] | None:
    """Names of the columns of a session without a header, from the JSON beside it; None where the file has one."""
    if where.suffix.lower() != ".tsv" or not all(NUMBER.fullmatch(cell.strip()) for cell in first.split(mark)):
        return None
    beside = where.with_suffix(".json")
    if not beside.is_file():
        raise LogError(
            f"{where}:1: no line names the columns, and there is no {beside.name} with them beside it; put a line such "
            f"as time_s, setpoint_C, display_C above the rows"
        )
    try:
        document: Any = json.loads(read_bytes(beside, "description of columns", MOST_SIDECAR_MB, LogError))
        names = [str(name) for name in document["Columns"]]
    except (ValueError, KeyError, TypeError):
        raise LogError(f'{beside}: has no list "Columns" with the names of the columns; add it') from None
    if len(names) != len(first.split(mark)):
        raise LogError(f"{beside}: names {len(names)} columns; {where.name} has {len(first.split(mark))}")
    return names


def _session_name(name: str) -> bool:
    return name in SESSION_TIME or bool(ZONE.fullmatch(name.lower()))


def _session(values: Mapping[str, Array]) -> dict[str, Array] | None:
    """The columns of a thermode session, its zones as means; None for any other log."""
    zones: dict[str, list[Array]] = {"setpoint_C": [], "display_C": []}
    for name, column in values.items():
        if match := ZONE.fullmatch(name.lower()):
            zones["setpoint_C" if match["what"].startswith(("set", "command")) else "display_C"].append(column)
    time = next((values[name] for name in SESSION_TIME if name in values), None)
    if time is None or not zones["display_C"]:
        return None
    return {"time_s": time, **{name: np.mean(columns, axis=0) for name, columns in zones.items() if columns}}
