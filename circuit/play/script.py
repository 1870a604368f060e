"""The script that plays an export on one line: its numbers with the source text of guard and line.

The numbers stand at the top, where a laboratory may change them; every function reads them when it is called.
"""

from __future__ import annotations

import ast
import inspect
import json
import textwrap
from collections.abc import Mapping, Sequence
from types import ModuleType

from . import function, guard, line, ni, tcs2
from .guard import Numbers

HEAD = '''"""Plays exported icons {on}. Made by thermicon; never played on a device.

It holds the rest before a first play, refuses a play before the pause is over, and stops everything when abort() is
called, the clock is wrong, or a sensor is lost, frozen or outside the cut-off: give measured_C(), which returns the
temperature of the display, and second_C() of a second sensor. A computer that hangs does none of that: hardware on
skin needs a temperature cut-off of its own that works without any software.
"""

from __future__ import annotations

{imports}

LOW_C, HIGH_C = {low_C!r}, {high_C!r}  # cut-off, on the measured temperature of the display
LOOK_EVERY_S = {look_every_s!r}
LATE_S = {late_s!r}  # a row that is sent later ends the play
REST_S = {rest_s!r}  # held before the first play
PAUSE_S = {pause_s!r}  # between the end of a play and the next, and before the first, whatever played before it
SENSOR_STEP_K = {sensor_step_K!r}  # of a reading: one that stays while three steps are predicted is frozen
FROZEN_S = {frozen_s!r}  # and for so long at least: raise it for a slow sensor
SECOND_SENSOR = {second_sensor!r}  # the cut-off needs a sensor of its own
TEST_POLARITY = {test_polarity!r}
TEST_COMMAND_V, TEST_S, TEST_FALL_K = {test_command!r}, {test_s!r}, {test_fall_K!r}
DRIVES = {drives}  # judged together with these numbers; no other file is played
'''

TAIL = '''

def _numbers():
    cut_off, frozen = (LOW_C, HIGH_C), (FROZEN_S, SENSOR_STEP_K, SECOND_SENSOR)
    test = TEST_POLARITY, TEST_COMMAND_V, TEST_S, TEST_FALL_K
    return Numbers(*cut_off, LOOK_EVERY_S, LATE_S, REST_S, PAUSE_S, *frozen, *test)


_guard = Guard(_numbers, lambda: time.monotonic(), lambda seconds: time.sleep(seconds))


def _judged(drive_file):
    if os.path.basename(drive_file) not in DRIVES:
        raise Refused(f"{drive_file} was not exported with this script, which plays {', '.join(DRIVES)}")
    return drive_file


def abort():
    """Stop what plays, from any thread; reset() allows playing again."""
    _guard.abort()


def reset():
    """Allow playing again after a stop: the rest is held, and the polarity tested, as before a first play."""
    _guard.reset()
'''
REST = '    """Hold {}, as before a first play; play() does that by itself where nobody did."""'

NI = f'''

def rest(drive_file, measured_C=None, second_C=None):
{REST.format("what a drive begins with")}
    volts = columns_of(_judged(drive_file), "command_V")[1]
    _guard.rest(NiLine(CHANNEL, OFF_V, measured_C), volts[0], second_C)


def play(drive_file, measured_C=None, second_C=None):
    """Put out the commands of a drive file in V, each held until the next; returns when the last was put out."""
    times, volts = columns_of(_judged(drive_file), "command_V")
    rate = (len(times) - 1) / times[-1]
    rows = [(0.0, (volts, rate)), (len(volts) / rate, None)]
    course = [(k * COURSE_EVERY_S, at_C) for k, at_C in enumerate(COURSES_C.get(os.path.basename(drive_file), ()))]
    _guard.play(NiLine(CHANNEL, OFF_V, measured_C), rows, volts[0], course, second_C)


def _off():
    line = NiLine(CHANNEL, OFF_V)
    line.open()
    line.off()
'''

FUNCTION = f'''

def rest(drive_file, send, off, measured_C=None, second_C=None):
{REST.format("what a drive begins with")}
    _guard.rest(FunctionLine(send, off, measured_C), columns_of(_judged(drive_file), "display_C")[1][0], second_C)


def play(drive_file, send, off, measured_C=None, second_C=None):
    """Give a controller the set-points of a drive file by send(display_C); off() switches its output off.

    Rows are sent at their times by this computer's clock, which may be late by some milliseconds.
    """
    times, levels = columns_of(_judged(drive_file), "display_C")
    rows = list(zip(times, levels))
    _guard.play(FunctionLine(send, off, measured_C), rows, levels[0], rows, second_C)
'''

TCS2 = f'''

def prepare(port, drive_file):
    """Send everything but the start, so that the trial begins with one short command; the baseline is held from now."""
    global _course
    with open(_judged(drive_file)) as file:
        commands = file.read().split()
    _course = course_of(commands)
    for command in commands[:-1]:
        Tcs2Line(port).send(command)
    _guard.hold()


def rest(port, measured_C=None, second_C=None):
{REST.format("the baseline of what was prepared")}
    if not _course:
        raise Refused("nothing was prepared: call prepare(port, drive_file) first")
    _guard.rest(Tcs2Line(port, measured_C), None, second_C)


def play(port, measured_C=None, second_C=None):
    """Start what was prepared; with a sensor it watches until the end, else it returns at once."""
    if not _course:
        raise Refused("nothing was prepared: call prepare(port, drive_file) first")
    watch = measured_C is not None or second_C is not None
    _guard.play(Tcs2Line(port, measured_C), [(0.0, "L"), (_course[-1][0], None)], None, _course, second_C, watch)


def connect():
    """Open the serial line."""
    import serial

    return serial.Serial(PORT, baudrate=115200, timeout=0.1)
'''

LINES: dict[str, tuple[ModuleType, str]] = {"ni": (ni, NI), "function": (function, FUNCTION), "tcs2": (tcs2, TCS2)}
"""The lines that a script may play on, each with its module and its functions for users."""

COURSE_EVERY_S = 0.1


def script(kind: str, on: str, numbers: Numbers, courses_C: Mapping[str, Sequence[float]], off_V: float = 0.0) -> str:
    """The script for a line and the predicted display in °C by drive file; equal inputs give equal text."""
    module, functions = LINES[kind]
    names: dict[str, set[str]] = {"time": set(), "os": set()}
    texts = [_parted(inspect.getsource(each), names) for each in (line, guard, module)]
    imports = [f"import {name}" for name, of in sorted(names.items()) if not of]
    imports += [f"from {name} import {', '.join(sorted(of))}" for name, of in sorted(names.items()) if of]
    top = {
        "ni": f'CHANNEL = "Dev1/ao0"\nOFF_V = {off_V!r}\n{_courses(courses_C)}',
        "tcs2": 'PORT = "COM3"\n_course = []\n',
    }
    drives = textwrap.fill(f"({', '.join(map(json.dumps, courses_C))},)", 112, subsequent_indent=" " * 4)
    head = HEAD.format(on=on, imports="\n".join(imports), drives=drives, **numbers._asdict()) + top.get(kind, "")
    return "\n\n".join([head, *texts]) + TAIL + functions


def _parted(source: str, names: dict[str, set[str]]) -> str:
    """The text of a module without docstring and imports; these are added to `names`."""
    body = ast.parse(source).body
    head = [node for node in body if isinstance(node, ast.Import | ast.ImportFrom | ast.If)]
    for node in head:
        if isinstance(node, ast.Import):
            names |= {each.name: set() for each in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.module != "__future__":
            of = {each.name for each in node.names} - {"TYPE_CHECKING"}
            names[node.module] = names.get(node.module, set()) | of
    return "\n".join(source.splitlines()[head[-1].end_lineno :]).strip("\n") + "\n"


def _courses(courses_C: Mapping[str, Sequence[float]]) -> str:
    """A table of the predicted display by drive file, in lines that an editor shows."""
    text = f"COURSE_EVERY_S = {COURSE_EVERY_S!r}\nCOURSES_C = {{  # the predicted display of each drive file\n"
    for name, course in courses_C.items():
        levels = textwrap.fill(", ".join(f"{at_C:.2f}" for at_C in course), 112)
        text += f"    {json.dumps(name)}: (\n{textwrap.indent(levels, ' ' * 8)},\n    ),\n"
    return text + "}\n"
