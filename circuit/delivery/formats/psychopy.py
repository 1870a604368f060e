"""PsychoPy: drives with a conditions file and a supervising player."""

import csv
import hashlib
import io
import math
from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from ...play.script import COURSE_EVERY_S, JudgedDrive, script
from ...play.watch import UNSUPERVISED_S, Numbers
from ...safety.demands import Demands
from ..commands import Column
from ..delivered_drive import DeliveredDrive
from ..device import Device
from ..setpoints import Setpoints
from .c_array import command_for
from .form import Event, Format, FormatError, OneFile, Played, course_C, events_in, samples_of
from .tables import CSV, SERIAL, SETPOINT_CSV, has_voltage, volts_of, write_rows
from .tables import write_together as write_elements

SET_FILES = CONDITIONS, PLAYER = "conditions.csv", "play_icons.py"
MOST_ROWS = 1_000_000
"""Rows of one drive file, which then has 60 MB: a minute at 16 kHz."""

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
    if _drive(delivery) is not CSV:
        return _drive(delivery).write(delivery)
    # The player puts out rows at one rate, so that each update needs one.
    rows = np.arange(len(samples_of(delivery).codes))
    if len(rows) > MOST_ROWS:
        raise FormatError(
            f"psychopy writes a row for each update, at most {MOST_ROWS:,}; there are {len(rows):,} at "
            f"{delivery.rate_Hz:g} Hz: use a device with a lower rate, a shorter icon, or the format tdms"
        )
    return write_rows(delivery, rows)


def write_together(deliveries: Sequence[DeliveredDrive]) -> bytes:
    """Return the drive file of several elements, with a row for each update."""
    together = _together(deliveries)
    return together.write(deliveries) if together is SERIAL.together else write_elements(deliveries, True)


def _together(deliveries: Sequence[DeliveredDrive]) -> OneFile:
    together = _drive(deliveries[0]).together
    assert together is not None
    return together


def fits(device: Device) -> None:
    """Raise FormatError for a sound interface, which the player cannot drive."""
    if device.dc_coupled:
        raise FormatError(
            f"psychopy: neither its player nor a study plays on a sound interface such as {device.name}; use "
            f"ni-analogue-output, closed-loop-controller or qst-tcs2, or export wav and play the files yourself"
        )


def set_files(drives: Sequence[Played], demands: Demands) -> dict[str, bytes]:
    """Return conditions file and player for drives of one device, with what the hardware must prevent."""
    rows = [_row(each, events_in(each.delivery)) for each in drives]
    return {CONDITIONS: _conditions(rows), PLAYER: _player(drives, demands)}


def _conditions(found: Sequence[Mapping[str, str]]) -> bytes:
    """The table of conditions, with a column for each event that an icon has."""
    most = max(map(len, found))
    later = [_column(name, k) for k in range(most) for name in MARKED]
    used = {column for row in found for column in row}
    header = [*HEADER, *(column for column in later if column in used and column not in HEADER), *JUDGED]
    text = io.StringIO()
    rows = csv.DictWriter(text, header, restval="", lineterminator="\n")
    rows.writeheader()
    rows.writerows(found)
    return text.getvalue().encode("utf-8")


def _row(played: Played, events: Sequence[Event]) -> dict[str, str]:
    row = {"icon": played.delivery.icon.name, "drive_file": played.file, "sidecar_file": played.sidecar}
    row["safety"] = played.safety
    times: dict[str, float | None] = dict(zip(JUDGED[1:], (played.recovery_s, played.shortest_pause_s), strict=True))
    seen = Counter[str]()
    for event in events:
        times["duration_s" if event.name == "end" else _column(event.name, seen[event.name])] = event.time_s
        seen[event.name] += 1
    return row | {column: f"{time:.9g}" for column, time in times.items() if time is not None}


def _player(drives: Sequence[Played], demands: Demands) -> bytes:
    """The player for what the device takes: NI volts, a thermode's commands, or set-points sent one by one."""
    delivery = drives[0].delivery
    kind, on, off_V, V_per_A = _line(delivery)
    numbers = guard_numbers(demands, closed_loop=delivery.device.driven_by != "volts")
    return script(kind, on, numbers, [_judged(each) for each in drives], off_V, V_per_A).encode("utf-8")


def elements_player(
    drives: Mapping[str, Sequence[Played]], demands: Mapping[str, Demands], largest_offset_s: float | None = None
) -> bytes:
    """The player of several elements by name, whose drives of one icon are in one file: zones of a TCS II in order.

    All drives of an icon last to its end, since courses are expected for so long. `largest_offset_s`: how far apart the
    verdict lets elements begin, in s; None: at will.
    """
    from ...play.element_lines import APART_AT_MOST_S
    from ...play.element_script import element_script

    lines = {name: _line(own[0].delivery) for name, own in drives.items()}
    (kind, on, *_), *_ = lines.values()
    is_closed = not any(V_per_A for *_, V_per_A in lines.values())
    strictest = guard_numbers(Demands.strictest(list(demands.values())), closed_loop=is_closed)
    return element_script(
        kind,
        f"of {', '.join(drives)} {on}",
        strictest,
        {name: guard_numbers(own, closed_loop=is_closed) for name, own in demands.items()},
        {name: [_judged(each) for each in own] for name, own in drives.items()},
        {name: off_V for name, (_, _, off_V, _) in lines.items()},
        {name: V_per_A for name, (*_, V_per_A) in lines.items()},
        min(APART_AT_MOST_S, math.inf if largest_offset_s is None else largest_offset_s),
    ).encode("utf-8")


def elements_set_files(
    drives: Mapping[str, Sequence[Played]], demands: Mapping[str, Demands], largest_offset_s: float | None
) -> dict[str, bytes]:
    """Return conditions file and player for drives of several elements; an event is of the first that has it."""
    rows = []
    for icon in zip(*drives.values(), strict=True):
        events = {(event.time_s, event.name): event for played in icon for event in events_in(played.delivery)}
        rows.append(_row(icon[0], [events[key] for key in sorted(events)]))
    return {CONDITIONS: _conditions(rows), PLAYER: elements_player(drives, demands, largest_offset_s)}


def _line(delivery: DeliveredDrive) -> tuple[str, str, float, float]:
    """The line of a device, with what it is in words; its V without power, and for 1 A."""
    driven_by, device = delivery.device.driven_by, delivery.device
    if driven_by == "set-points":
        return "tcs2", "on a QST.Lab TCS II", 0.0, 0.0
    if driven_by == "volts":
        return "ni", "on an NI analogue output", 0.0, command_for(delivery, 1.0)
    if not has_voltage(device):
        return "function", "on a temperature controller", 0.0, 0.0
    # A controller takes 0 V for a temperature, so that off is the rest.
    off_V = float(volts_of(device, samples_of(delivery).command[:1])[0])
    return "ni", "as set-points of a temperature controller on an NI analogue output", off_V, 0.0


def guard_numbers(demands: Demands, *, closed_loop: bool) -> Numbers:
    """What a guard keeps to of the demands; `closed_loop`: the display is held at its prediction."""
    cut, held = demands.cut_off_display_C, demands.held_cut_off_display_C
    within_s = cut.react_within_s or UNSUPERVISED_S
    numbers = Numbers(
        low_C=cut.low,
        high_C=cut.high,
        react_s=cut.react_within_s,
        look_every_s=0.5 * cut.act_within_s,
        late_s=min(within_s, demands.watchdog_s or within_s),
        rest_s=demands.rest_s,
        pause_s=demands.pause_s,
        second_sensor=demands.loop is not None,
        closed_loop=closed_loop,
    )
    if held is not None:
        numbers = numbers._replace(held_low_C=held.low, held_high_C=held.high, held_s=held.longer_than_s)
    if demands.test is not None:
        numbers = numbers._replace(
            test_polarity=True,
            test_current_A=demands.test.test_current_A,
            test_s=demands.test.test_s,
            test_fall_K=demands.test.display_change_at_least_K,
            off_before_test_s=demands.test.off_before_s,
        )
    return numbers


def _judged(played: Played) -> JudgedDrive:
    """A drive as its player knows it again: by its digest and the range of its commands."""
    delivery = played.delivery
    if isinstance(delivery.played, Setpoints):
        commands = delivery.played.level_C
    elif delivery.device.driven_by == "temperatures" and has_voltage(delivery.device):
        commands = volts_of(delivery.device, delivery.played.command)
    else:
        commands = delivery.played.command
    beyond = 1e-6 + 1e-9 * float(np.abs(commands).max())  # decimals of the file
    return JudgedDrive(
        played.file,
        hashlib.sha256(played.content).hexdigest(),
        (float(commands.min()) - beyond, float(commands.max()) + beyond),
        course_C(delivery, COURSE_EVERY_S).tolist(),
    )


def _column(name: str, k: int) -> str:
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
    elements_player=elements_set_files,
    together=OneFile(
        write_together,
        lambda deliveries: _together(deliveries).columns(deliveries),
        lambda deliveries: _together(deliveries).channels(deliveries),
        "a drive file holds all elements",
    ),
    set_files=SET_FILES,
    # A script on a computer that hangs holds no cut-off: it watches, and the hardware has its own.
    holds=("rest_before_first_play_s", "pause_at_least_s"),
    proves=("polarity_check",),
    fits=fits,
)
