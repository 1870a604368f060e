"""PsychoPy: a conditions file with one row per icon, the drives, and a player that supervises them."""

import csv
import io
from collections import Counter
from collections.abc import Sequence

from ..delivered_drive import DeliveredDrive
from .c_array import command_for, filled
from .form import Column, Format, MustPrevent, Played, events_in, samples_of
from .tables import CSV, SERIAL, SETPOINT_CSV, has_voltage, volts_of

SET_FILES = CONDITIONS, PLAYER = "conditions.csv", "play_icons.py"
FROZEN_S = 5.0
"""A reading that has not changed for this long counts as frozen; a thermode's, in steps of 0.1 K, may rest longer."""

HEADER = ("icon", "drive_file", "sidecar_file", "duration_s", "ramp_start_s", "target_reached_s", "return_start_s")
"""First columns of the conditions file: names without spaces, as PsychoPy needs them."""

JUDGED = ("safety", "recovery_s", "shortest_pause_s")
"""Last columns of the conditions file: the verdict of the gate on each icon."""

MARKED = ("ramp start", "target reached", "return start", "baseline reached")
"""Events that may happen more than once. The first has a column without a number, as in `ramp_start_s`, the second one
as `ramp_start_2_s`."""


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Columns of the drive file."""
    return _drive(delivery).columns(delivery)


def write(delivery: DeliveredDrive) -> bytes:
    """Return the drive file of one icon: a table, or the commands of a thermode."""
    return _drive(delivery).write(delivery)


def set_files(drives: Sequence[Played], must: MustPrevent) -> dict[str, bytes]:
    """Return conditions file and player for drives of one device, with what the hardware must prevent."""
    found = [_row(each) for each in drives]
    most = max(map(len, found))
    later = [_column(name, k) for k in range(most) for name in MARKED]
    used = {column for row in found for column in row}
    header = [*HEADER, *(column for column in later if column in used and column not in HEADER), *JUDGED]
    text = io.StringIO()
    rows = csv.DictWriter(text, header, restval="", lineterminator="\n")
    rows.writeheader()
    rows.writerows(found)
    return {CONDITIONS: text.getvalue().encode("utf-8"), PLAYER: _player(drives[0].delivery, must)}


def _row(played: Played) -> dict[str, str]:
    """The condition of one icon: its files, the times in s of its events by their columns, and the verdict."""
    row = {"icon": played.delivery.icon.name, "drive_file": played.file, "sidecar_file": played.sidecar}
    row["safety"] = played.safety
    times: dict[str, float | None] = dict(zip(JUDGED[1:], (played.recovery_s, played.shortest_pause_s), strict=True))
    seen = Counter[str]()
    for event in events_in(played.delivery):
        times["duration_s" if event.name == "end" else _column(event.name, seen[event.name])] = event.time_s
        seen[event.name] += 1
    return row | {column: f"{time:.9g}" for column, time in times.items() if time is not None}


def _player(delivery: DeliveredDrive, must: MustPrevent) -> bytes:
    """The player for what the device takes: NI volts, a thermode's commands, or set-points sent one by one."""
    driven_by, device = delivery.device.driven_by, delivery.device
    on, parts = "on an NI analogue output", ["guard", "polarity", "ni"]
    off_V = "0.0"
    if driven_by == "set-points":
        on, parts = "on a QST.Lab TCS II", ["guard", "tcs2"]
    elif driven_by == "temperatures" and not has_voltage(device):
        on, parts = "on a temperature controller", ["guard", "send"]
    elif driven_by == "temperatures":  # a controller takes 0 V for a temperature, so that off is the rest
        on = "as set-points of a temperature controller on an NI analogue output"
        off_V = repr(float(volts_of(device, samples_of(delivery).command[:1])[0]))
    polarity = must.test_polarity and driven_by == "volts"
    values = {
        "ON": on,
        "LOW_C": repr(must.low_C),
        "HIGH_C": repr(must.high_C),
        "LOOK_S": repr(max(0.01, 0.5 * must.react_within_s)),
        "REST_S": repr(must.rest_s),
        "PAUSE_S": repr(must.pause_s),
        "TEST_POLARITY": str(polarity),
        "TEST_COMMAND": repr(command_for(delivery, must.test_current_A) if polarity else 0.0),
        "TEST_S": repr(must.test_s),
        "TEST_FALL_K": repr(must.test_fall_K),
        "FROZEN_S": "math.inf" if driven_by == "set-points" else repr(FROZEN_S),
        "OFF": "_off",
        "OFF_V": off_V,
    }
    return b"".join(filled(f"player-{part}.py.txt", values) for part in parts)


def _column(name: str, k: int) -> str:
    """Column of an event that happens for the k-th time, from 0."""
    return f"{name.replace(' ', '_')}{f'_{k + 1}' if k else ''}_s"


def _drive(delivery: DeliveredDrive) -> Format:
    by_kind = {"set-points": SERIAL, "temperatures": SETPOINT_CSV}
    return by_kind.get(delivery.device.driven_by, CSV)


FORMAT = Format(
    name="psychopy",
    title="conditions file of PsychoPy with drives and a player",
    suffix=".csv",
    takes=("volts", "set-points", "temperatures"),
    device="ni-analogue-output",
    source="PsychoPy documentation, conditions files: CSV, a header of variable names, a row for each condition",
    how="name conditions.csv in a loop, import play_icons in a code component, and play drive_file",
    write=write,
    columns=columns,
    suffix_by=lambda delivery: _drive(delivery).suffix,
    player=set_files,
    set_files=SET_FILES,
)
