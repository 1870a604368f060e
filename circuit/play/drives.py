"""Drive files as a player reads them."""

from __future__ import annotations

import csv
import hashlib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from .watch import Refused


def judged(drive_file: str, digests: Mapping[str, str]) -> str:
    """The text of a drive file that was judged; Refused for any other. What is checked is what is played."""
    name = Path(drive_file).name
    if name not in digests:
        raise Refused(f"{drive_file} was not exported with this script, which plays {', '.join(digests)}")
    content = Path(drive_file).read_bytes()
    if hashlib.sha256(content).hexdigest() != digests[name]:
        raise Refused(f"{drive_file} is not the file that was judged, its digest differs: export it again")
    return content.decode("utf-8")


def check_commands(drive_file: str, commands: Sequence[float], limits: tuple[float, float]) -> None:
    """Refuse commands beyond the least and the greatest of the drive that was judged."""
    for command in commands:
        if not limits[0] <= command <= limits[1]:
            raise Refused(f"{drive_file}: a command of {command:g}, judged were {limits[0]:g} to {limits[1]:g}")


def columns_of(drive_file: str, text: str, *names: str) -> list[list[float]]:
    """Times in s and other columns of a drive file; Refused where its rows do not come at one rate from 0 s on."""
    rows = list(csv.DictReader(text.splitlines()))
    try:
        columns = [[float(row[name]) for row in rows] for name in ("time_s", *names)]
    except (KeyError, TypeError, ValueError) as problem:
        raise Refused(f"{drive_file}: not a drive, a cell cannot be read ({problem})") from None
    times = columns[0]
    step_s = times[-1] / (len(times) - 1) if len(times) > 1 else math.nan
    if not all(math.isfinite(value) for column in columns for value in column) or not step_s > 0:
        raise Refused(f"{drive_file}: a drive has two rows or more, with times and commands that are numbers")
    for place, time_s in enumerate(times):
        if abs(time_s - place * step_s) > 1e-3 * step_s:
            raise Refused(
                f"{drive_file}, row {place + 1}: at {time_s:g} s, where rows at one rate from 0 s on have "
                f"{place * step_s:g} s: give a drive with a row for each update, as the format psychopy writes it"
            )
    return columns
