"""The script that plays an export on several elements with all that a script for one element has."""

from __future__ import annotations

import inspect
import json
from collections.abc import Mapping, Sequence

from . import element_lines, elements_guard, ni_elements, zones
from .script import CALLS, EVERY, FUNCTION, LINES, NI, NUMBERS, TCS2, JudgedDrive, head, levels, parted, table
from .watch import Numbers

OF_ELEMENT = (
    *("low_C", "high_C", "held_low_C", "held_high_C", "held_s", "second_sensor", "closed_loop"),
    *("test_polarity", "test_current_A", "test_s", "test_fall_K"),
)
"""Numbers that each element has of its own; by the others, which are times, one guard acts for all."""

ELEMENTS = """ELEMENTS = {{  # and numbers of theirs; sensors, and functions of a controller, are dicts by these names
{elements}
}}
ROW_APART_S = {apart_s!r}  # from the first to the last element of a row, at most
"""
GUARD = """

def _elements():
    return {name: _numbers()._replace(**own) for name, own in ELEMENTS.items()}


_guard = ElementsGuard(_numbers, _elements, lambda: time.monotonic(), lambda seconds: time.sleep(seconds))


def _course(drive_file):
    courses = COURSES_C[os.path.basename(drive_file)]
    return {name: [(k * COURSE_EVERY_S, at_C) for k, at_C in enumerate(courses[name])] for name in ELEMENTS}


def _rows(drive_file, column):
    names = [f"{name}_{column}" for name in ELEMENTS]
    times, *columns = columns_of(drive_file, judged(drive_file, DRIVES), *names)
    for name, commands in zip(ELEMENTS, columns):
        check_commands(drive_file, commands, COMMANDS[os.path.basename(drive_file)][name])
    return times, [dict(zip(ELEMENTS, row)) for row in zip(*columns)]
"""
CALLS_OF_ELEMENTS = f'''{CALLS}

def apart_s():
    """The longest time in s from the first to the last element of a row that was put out by this computer's clock."""
    return _guard.apart_s
'''
NI_LINE = """    return _lines.setdefault((CHANNEL, OFF_V, V_PER_A), NiLine(CHANNEL, OFF_V, V_PER_A))"""
NI_LINES = """    key = repr((CHANNEL, OFF_V, V_PER_A))
    return _lines.setdefault(key, NiElements(CHANNEL, OFF_V, V_PER_A, lambda: time.monotonic()))"""
FUNCTION_LINES = """

def _line(send, off, test, feed):
    of = [(name, send[name], off[name], (test or {}).get(name), (feed or {}).get(name)) for name in ELEMENTS]
    return ElementLines({name: FunctionLine(*own) for name, *own in of}, lambda: time.monotonic(), ROW_APART_S)
"""
TCS2_COURSE = """    corners = course_of(commands)
    check_commands(drive_file, [level_C for _, level_C in corners], COMMANDS[os.path.basename(drive_file)])
"""
TCS2_COURSES = """    courses = zone_courses(commands)
    for name, corners in zip(ELEMENTS, courses, strict=True):
        check_commands(drive_file, [level_C for _, level_C in corners], COMMANDS[os.path.basename(drive_file)][name])
    corners = max(courses, key=lambda course: course[-1])
"""
FUNCTIONS = {
    "ni": NI.replace(NI_LINE, NI_LINES),
    "function": FUNCTION_LINES + FUNCTION.replace("FunctionLine(send", "_line(send"),
    "tcs2": TCS2.replace(TCS2_COURSE, TCS2_COURSES),
}


def element_script(
    kind: str,
    on: str,
    numbers: Numbers,
    elements: Mapping[str, Numbers],
    drives: Mapping[str, Sequence[JudgedDrive]],
    off_V: Mapping[str, float] | None = None,
    V_per_A: Mapping[str, float] | None = None,
    apart_at_most_s: float = element_lines.APART_AT_MOST_S,
) -> str:
    """The script for elements, in the order of zones where they are some: strictest `numbers`, and those of each.

    A drive file holds all of them, in columns that begin with their names; `drives` say of each what it plays there.
    """
    names: dict[str, set[str]] = {"time": set(), "os": set(), "atexit": set()}
    modules = {"ni": (element_lines, ni_elements), "function": (element_lines,), "tcs2": (zones,)}[kind]
    texts = [parted(inspect.getsource(each), names) for each in (*EVERY, elements_guard, LINES[kind][0], *modules)]
    digests = {each.file: repr(each.sha256) for each in next(iter(drives.values()))}
    by_file = {file: {name: own[place] for name, own in drives.items()} for place, file in enumerate(digests)}
    commands = {file: repr({name: each.commands for name, each in own.items()}) for file, own in by_file.items()}
    tables = {file: table({name: levels(each.course_C) for name, each in own.items()}) for file, own in by_file.items()}
    courses = {file: f"{{\n{rows}\n    }}" for file, rows in tables.items()}
    others = {}
    for name, own in elements.items():
        other = {key: getattr(own, key) for key in OF_ELEMENT if getattr(own, key) != getattr(numbers, key)}
        others[name] = repr(other).replace("inf", "math.inf")
    top = head(on, numbers, names, digests, commands, courses) + ELEMENTS.format(
        elements=table(others), apart_s=apart_at_most_s
    )
    if kind == "ni":
        channels = {name: f"Dev1/ao{place}" for place, name in enumerate(elements)}
        top += f"CHANNEL = {json.dumps(channels)}\nOFF_V = {off_V!r}\nV_PER_A = {V_per_A!r}\n"
    elif kind == "tcs2":
        top += 'PORT = "COM3"\n'
    return "\n\n".join([top, *texts]) + NUMBERS + GUARD + CALLS_OF_ELEMENTS + FUNCTIONS[kind]
