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
from typing import NamedTuple

from . import drives as drives_module
from . import function, guard, line, look, ni, steps, tcs2, watch
from .watch import Numbers, Refused, Stopped

HEAD = '''"""Plays exported icons {on}. Made by thermicon; never played on a device.

It holds the rest before a first play, refuses a play before the pause is over, and stops everything when abort() is
called, the clock is wrong, or a sensor is lost, late, frozen, apart from the second one, or outside the cut-offs: give
measured_C(), which returns the temperature of the display, and second_C() of a second sensor. Both are called in a
thread of their own, never at once. Between plays, call keep() in the loop of the experiment. A computer that hangs does
none of that: hardware on skin needs a temperature cut-off of its own that works without any software.
"""

from __future__ import annotations

{imports}

LOW_C, HIGH_C = {low_C!r}, {high_C!r}  # cut-off, on the measured temperature of the display
REACT_S = {react_s!r}  # in which the cut-off must act; 0: no time is quick enough
HELD_LOW_C, HELD_HIGH_C, HELD_S = {held}  # second cut-off: outside for longer, with power
LOOK_EVERY_S = {look_every_s!r}
LATE_S = {late_s!r}  # a row that is sent later ends the play
REST_S = {rest_s!r}  # held before the first play
PAUSE_S = {pause_s!r}  # between the end of a play and the next, and before the first, whatever played before it
SENSOR_STEP_K = {sensor_step_K!r}  # of a reading: one that stays while the display moves by three steps is frozen
FROZEN_S = {frozen_s!r}  # and for so long: raise it for a slow sensor
SECOND_SENSOR = {second_sensor!r}  # the cut-off needs a sensor of its own
CLOSED_LOOP = {closed_loop!r}  # the display is held at its prediction
TEST_POLARITY = {test_polarity!r}  # before a first play
TEST_CURRENT_A, TEST_S, TEST_FALL_K = {test_current_A!r}, {test_s!r}, {test_fall_K!r}
OFF_BEFORE_TEST_S = {off_before_test_s!r}
POLARITY_SEEN = ""  # where it cannot be tested: who saw the display cool under a current that must cool it, and when
DRIVES = {{  # SHA-256 of each drive that was judged with these numbers; no other file is played
{digests}
}}
COMMANDS = {{  # the least and the greatest command of each
{commands}
}}
COURSE_EVERY_S = {every_s!r}
COURSES_C = {{  # the predicted display of each drive
{courses}
}}
'''

NUMBERS = """

def _numbers():
    return Numbers(
        LOW_C, HIGH_C, REACT_S, LOOK_EVERY_S, LATE_S, REST_S, PAUSE_S, FROZEN_S, SENSOR_STEP_K, SECOND_SENSOR,
        CLOSED_LOOP, -math.inf if HELD_LOW_C is None else HELD_LOW_C, math.inf if HELD_HIGH_C is None else HELD_HIGH_C,
        HELD_S, TEST_POLARITY, TEST_CURRENT_A, TEST_S, TEST_FALL_K, OFF_BEFORE_TEST_S, POLARITY_SEEN,
    )
"""
GUARD = """

_guard = Guard(_numbers, lambda: time.monotonic(), lambda seconds: time.sleep(seconds))


def _course(drive_file):
    return [(k * COURSE_EVERY_S, at_C) for k, at_C in enumerate(COURSES_C[os.path.basename(drive_file)])]


def _rows(drive_file, column):
    times, commands = columns_of(drive_file, judged(drive_file, DRIVES), column)
    check_commands(drive_file, commands, COMMANDS[os.path.basename(drive_file)])
    return times, commands
"""
CALLS = '''

def keep():
    """Look and feed between plays; call it in the loop of the experiment. It never waits; raises Stopped."""
    _guard.keep()


def abort():
    """Switch off at once, from any thread; reset() allows playing again."""
    _guard.abort()


def reset():
    """Allow playing again after a stop: the rest is held, and the polarity tested, as before a first play."""
    _guard.reset()


atexit.register(abort)  # what ends leaves nothing on
'''
REST = '    """Hold {}, as before a first play; play() does that by itself where nobody did."""'

NI = f'''

_lines = {{}}


def _line():
    return _lines.setdefault((CHANNEL, OFF_V, V_PER_A), NiLine(CHANNEL, OFF_V, V_PER_A))


def rest(drive_file, measured_C=None, second_C=None):
{REST.format("what a drive begins with")}
    _guard.rest(_line(), _rows(drive_file, "command_V")[1][0], (measured_C, second_C))


def play(drive_file, measured_C=None, second_C=None):
    """Put out the commands of a drive file in V, each held until the next; returns when the last was put out."""
    times, volts = _rows(drive_file, "command_V")
    rate = (len(times) - 1) / times[-1]
    rows = [(0.0, (volts, rate)), (len(volts) / rate, None)]
    _guard.play(_line(), rows, volts[0], _course(drive_file), (measured_C, second_C))


def _off():
    line = _line()
    line.open()
    line.off()
'''

FUNCTION = f'''

def rest(drive_file, send, off, measured_C=None, second_C=None, test=None, feed=None):
{REST.format("what a drive begins with")}
    line = FunctionLine(send, off, test, feed)
    _guard.rest(line, _rows(drive_file, "display_C")[1][0], (measured_C, second_C))


def play(drive_file, send, off, measured_C=None, second_C=None, test=None, feed=None):
    """Give a controller the set-points of a drive file by send(display_C); off() switches its output off.

    Before a first play test(current_A) must put out that current, above 0 to cool, until send() or off(). feed() is
    called five times a second, where the controller has a watchdog. Rows are sent at their times by this computer's
    clock, which may be late by some milliseconds.
    """
    times, levels = _rows(drive_file, "display_C")
    line = FunctionLine(send, off, test, feed)
    _guard.play(line, list(zip(times, levels)), levels[0], _course(drive_file), (measured_C, second_C))
'''

TCS2 = f'''

_lines, _prepared = {{}}, []


def _line(port):
    return _lines.setdefault(id(port), Tcs2Line(port))


def prepare(port, drive_file):
    """Send everything but the start, so that the trial begins with one short command; the baseline is held from now."""
    commands = judged(drive_file, DRIVES).split()
    corners = course_of(commands)
    check_commands(drive_file, [level_C for _, level_C in corners], COMMANDS[os.path.basename(drive_file)])
    _prepared.clear()  # what ends half out is not played
    _guard.prepare(_line(port), commands[:-1])
    _prepared.extend((corners[-1][0], _course(drive_file)))


def rest(port, measured_C=None, second_C=None):
{REST.format("the baseline of what was prepared")}
    if not _prepared:
        raise Refused("nothing was prepared: call prepare(port, drive_file) first")
    _guard.rest(_line(port), None, (measured_C, second_C))


def play(port, measured_C=None, second_C=None):
    """Start what was prepared; with a sensor it watches until the end, else it returns at once."""
    if not _prepared:
        raise Refused("nothing was prepared: call prepare(port, drive_file) first")
    watch = measured_C is not None or second_C is not None
    end_s, course = _prepared
    _guard.play(_line(port), [(0.0, "L"), (end_s, None)], None, course, (measured_C, second_C), watch)


def connect():
    """Open the serial line, for this program alone."""
    import serial

    return serial.Serial(PORT, baudrate=115200, timeout=0.1, exclusive=True)
'''

LINES: dict[str, tuple[ModuleType, str]] = {"ni": (ni, NI), "function": (function, FUNCTION), "tcs2": (tcs2, TCS2)}
"""The lines that a script may play on, each with its module and its functions for users."""

EVERY = line, watch, look, steps, guard, drives_module
"""The modules in every script."""

COURSE_EVERY_S = 0.1


BOARD_HEAD = '''"""A microcontroller that plays exported icons by itself. Made by thermicon; never tried on one."""

from __future__ import annotations

{imports}


'''


class JudgedDrive(NamedTuple):
    """A drive file that a script plays: its name, SHA-256, least and greatest command, predicted display in °C."""

    file: str
    sha256: str
    commands: tuple[float, float]
    course_C: Sequence[float]


def script(
    kind: str, on: str, numbers: Numbers, drives: Sequence[JudgedDrive], off_V: float = 0.0, V_per_A: float = 0.0
) -> str:
    """The script for a line and the drives that were judged; equal inputs give equal text."""
    module, functions = LINES[kind]
    names: dict[str, set[str]] = {"time": set(), "os": set(), "atexit": set()}
    texts = [parted(inspect.getsource(each), names) for each in (*EVERY, module)]
    top = {"ni": f'CHANNEL = "Dev1/ao0"\nOFF_V = {off_V!r}\nV_PER_A = {V_per_A!r}\n', "tcs2": 'PORT = "COM3"\n'}
    digests = {each.file: repr(each.sha256) for each in drives}
    commands = {each.file: repr(each.commands) for each in drives}
    courses = {each.file: levels(each.course_C) for each in drives}
    top_text = head(on, numbers, names, digests, commands, courses) + top.get(kind, "")
    return "\n\n".join([top_text, *texts]) + NUMBERS + GUARD + CALLS + functions


def head(
    on: str,
    numbers: Numbers,
    names: Mapping[str, set[str]],
    digests: Mapping[str, str],
    commands: Mapping[str, str],
    courses: Mapping[str, str],
) -> str:
    """The top of a script: its numbers, and what it knows of each drive file."""
    held = (numbers.held_low_C, numbers.held_high_C, numbers.held_s) if numbers.held_s is not None else (None,) * 3
    return HEAD.format(
        on=on,
        imports=imports(names),
        held=", ".join(map(repr, held)),
        digests=table(digests),
        commands=table(commands),
        courses=table(courses),
        every_s=COURSE_EVERY_S,
        **numbers._asdict(),
    )


def board_script() -> str:
    """The line of a board as a module of its own."""
    from . import board, logged_line

    names: dict[str, set[str]] = {}
    texts = [parted(inspect.getsource(each), names) for each in (line, logged_line, board)]
    texts = [*map(inspect.getsource, (Refused, Stopped)), *texts]
    return BOARD_HEAD.format(imports=imports(names)) + "\n\n".join(texts)


def imports(names: Mapping[str, set[str]]) -> str:
    """The imports of modules, and of names from them."""
    whole = [f"import {name}" for name, of in sorted(names.items()) if not of]
    parts = [f"from {name} import {', '.join(sorted(of))}" for name, of in sorted(names.items()) if of]
    return "\n".join(whole + parts)


def parted(source: str, names: dict[str, set[str]]) -> str:
    """The text of a module without docstring and imports; those from elsewhere are added to `names`."""
    body = ast.parse(source).body
    head = [node for node in body if isinstance(node, ast.Import | ast.ImportFrom | ast.If)]
    for node in head:
        if isinstance(node, ast.Import):
            names |= {each.name: set() for each in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level and node.module != "__future__":
            of = {each.name for each in node.names} - {"TYPE_CHECKING"}
            names[node.module] = names.get(node.module, set()) | of
    return "\n".join(source.splitlines()[head[-1].end_lineno :]).strip("\n") + "\n"


def table(values: Mapping[str, str]) -> str:
    """The rows of a table by drive file."""
    return "\n".join(f"    {json.dumps(name)}: {value}," for name, value in values.items())


def levels(course_C: Sequence[float]) -> str:
    """The predicted display in lines that an editor shows."""
    levels = textwrap.fill(", ".join(f"{at_C:.2f}" for at_C in course_C), 112)
    return f"(\n{textwrap.indent(levels, ' ' * 8)},\n    )"
