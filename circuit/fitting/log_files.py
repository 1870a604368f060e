"""Logs from files: CSV and TSV by their header, the TSV of a thermode session with its JSON, and TDMS."""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from thermicon.icons.files.table import read_table
from thermicon.icons.near_words import nearest_words

from ..arrays import Array
from ..inputs import quoted, read_bytes, table_fault, text_of
from .log import DRIVES, MEASURED, MOST_ROWS, Log, LogError, is_known

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

INCREMENT, OFFSET = "wf_increment", "wf_start_offset"
"""Properties by which a TDMS channel tells its times."""

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
        return Log.of(where.name, _read_tdms(data, where.name), sha256=digest)
    return _from_text(where, text_of(data, where, "log", LogError), digest)


def _from_text(where: Path, text: str, digest: str) -> Log:
    fault = table_fault(where, LogError)
    session = where.suffix.lower() == ".tsv"
    table = read_table(text, fault, "time_s,current_A,…", MOST_ROWS, partial(_sidecar, where) if session else None)
    wanted = [name for name in dict.fromkeys(table.header) if name == "time_s" or is_known(name) or _session_name(name)]
    gaps = {name: Counter[str]() for name in wanted}
    values = {name: table.numbers(name, "leave the cell empty", gaps=gaps[name]) for name in wanted}
    merged = _session(values)
    columns = merged or values
    _check_columns(where.name, columns, table.header)
    notes = [f"{where.name}: display_C and setpoint_C are means over the zones"] if merged else []
    notes += [
        f"{where.name}: {name} is {quoted(cell)} in {count:,} of {len(table.rows):,} rows, which are taken as gaps"
        for name, counts in gaps.items()
        for cell, count in counts.items()
        if cell
    ]
    used = set(values) if merged else set(columns)
    left_out = [name for name in table.header if name not in used and name != "icon"]
    listed = ", ".join(_with_likely_name(name, columns) for name in left_out[:8])
    places = [f"{where}:{line}" for line in table.lines]
    return Log.of(where.name, columns, sha256=digest, notes=notes, rows=places, unused=listed)


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


def _sidecar(where: Path, first: Sequence[str]) -> list[str]:
    """Names of the columns of a session without a line of them, from the JSON beside it."""
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
    if len(names) != len(first):
        raise LogError(f"{beside}: names {len(names)} columns; {where.name} has {len(first)}")
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


def _read_tdms(data: bytes, name: str) -> dict[str, Array]:
    """Return the columns of a TDMS file by channel name; times come from a channel `time_s` or from `wf_increment`.

    Raises LogError where npTDMS is not installed, and for a file without one common clock.
    """
    try:
        from nptdms import TdmsFile
    except ImportError:
        raise LogError(
            f'{name}: TDMS needs npTDMS, which is not installed: pip install "thermicon[hardware]"'
        ) from None
    try:
        file = TdmsFile.read(io.BytesIO(data))
        channels = {channel.name: channel for group in file.groups() for channel in group.channels()}
        columns = {
            key: np.asarray(channel[:], dtype=np.float64)
            for key, channel in channels.items()
            if np.issubdtype(channel.dtype, np.number)
        }
    except Exception as problem:  # npTDMS raises whatever a broken file leads it to
        raise LogError(f"{name}: cannot be read as TDMS ({str(problem) or type(problem).__name__})") from None
    if not channels:
        raise LogError(f"{name}: cannot be read as TDMS (no channel in it); save the log again")
    if not columns:
        raise LogError(f"{name}: no channel with numbers; found {', '.join(channels) or 'no channel'}")
    lengths = {key: len(column) for key, column in columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{key} {count}" for key, count in lengths.items())
        raise LogError(f"{name}: channels of unequal lengths ({listed} samples); save each clock as a file of its own")
    if "time_s" in columns:
        return columns
    clocks = {
        key: (channels[key].properties.get(INCREMENT), channels[key].properties.get(OFFSET, 0.0)) for key in columns
    }
    missing = [key for key, (step, _) in clocks.items() if not step]
    if missing:
        raise LogError(f"{name}: channel {missing[0]} has neither {INCREMENT} nor a channel time_s beside it")
    if len({(round(float(step), 12), float(start)) for step, start in clocks.values()}) > 1:
        raise LogError(f"{name}: channels with different {INCREMENT}; save each clock as a file of its own")
    step, start = next(iter(clocks.values()))
    count = next(iter(lengths.values()))
    return {"time_s": float(start) + float(step) * np.arange(count, dtype=np.float64), **columns}
