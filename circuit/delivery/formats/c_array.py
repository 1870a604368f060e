"""C array: a drive's codes as a header file for the flash of a microcontroller.

The player is a header too, with cut-off, watchdog, abort and pauses.
"""

import math
import re
from collections.abc import Mapping, Sequence
from functools import partial
from hashlib import sha256

import numpy as np

from thermicon.base.files.inputs import shipped_text
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.clean_text import clean_line

from ...safety.demands import Demands, HeldCutOff
from ..commands import Column
from ..delivered_drive import DeliveredDrive
from .form import (
    PLAYS_SAMPLES,
    PLAYS_TEMPERATURES,
    Format,
    FormatError,
    Played,
    course_C,
    samples_of,
)

PLAYER, SERIAL = "thermicon_player.h", "thermicon_serial.h"

OUTPUT_UNITS = {"volts": "volts", "amperes": "amperes", "duty": "duty, -1 ... 1", "temperatures": "amperes"}

A_LINE = 16
COURSE_S = 0.1
"""A player gets the predicted display so often."""
CENTI_K = 0.01
DIGITS = 16
"""So many hexadecimal digits name an export."""
SMALLEST, LARGEST = -32768, 32767
LONGEST_NS, MOST_CODES = 2**32 - 1, 2**32 - 1
"""What the header's unsigned 32-bit numbers hold: a period of 4.29 s."""
LEAST_EXACT = 1e-4
"""A period in whole nanoseconds may play this much too fast or slow; beyond, the icon is another."""


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """The array."""
    scale = samples_of(delivery).scale
    step = CENTI_K if delivery.device.kind.regulated else scale.step
    return (Column("wave", "", f"codes; times {step:.9g} plus {scale.offset:.9g} {scale.unit}"),)


def write(delivery: DeliveredDrive) -> bytes:
    """Return the header; raises FormatError for codes that 16 bits cannot hold."""
    samples, device = samples_of(delivery), delivery.device
    scale = samples.scale
    if device.kind.regulated and abs(scale.step / CENTI_K - round(scale.step / CENTI_K)) > 1e-9:
        raise FormatError(
            f"c-array holds set-points in hundredths of a degree; {device.name} has steps of {scale.step:g} K: state a "
            f"set-point step that is a multiple of {CENTI_K:g} K"
        )
    if scale.lowest < SMALLEST or scale.highest > LARGEST:
        raise FormatError(f"c-array holds int16_t; {device.name} has codes of {scale.lowest} … {scale.highest}")
    name, codes, period = identifier(delivery.icon.name), samples.codes.tolist(), period_ns(samples.rate_Hz)
    if len(codes) > MOST_CODES:
        raise FormatError(f"c-array counts at most {MOST_CODES:,} codes; there are {len(codes):,}")
    times = round(scale.step / CENTI_K) if device.kind.regulated else 1
    codes, step = [times * code for code in codes], scale.step / times
    rows = [", ".join(map(str, codes[k : k + A_LINE])) for k in range(0, len(codes), A_LINE)]
    unit = {"1": "duty", "°C": "degrees C, the set-point,"}.get(scale.unit, scale.unit)
    lines = [
        f"/* {name} for {in_comment(device.name)}, written by thermicon.",
        f"   {unit} = {scale.offset!r} + {step!r} * code. Put out one code every period and hold it.",
        "   The first code is the rest, the last marks the end and is the rest again.",
        f"   {PLAYER} plays it. */",
        "#pragma once",
        "#include <stdint.h>",
        "#ifdef __AVR__",
        "#include <avr/pgmspace.h>",
        "#elif !defined(PROGMEM)",
        "#define PROGMEM",
        "#endif",
        "",
        f"static const uint32_t {name}_period_ns = {period}UL;",
        f"static const uint32_t {name}_count = {len(codes)}UL;",
        f"static const float {name}_offset = {c_float(scale.offset)};",
        f"static const float {name}_step = {c_float(step)};",
        f"static const int16_t {name}_wave[] PROGMEM = {{",
        *(f"  {row}," for row in rows),
        "};",
        "",
    ]
    return "\n".join(lines).encode("ascii")


def period_ns(rate_Hz: float) -> int:
    """Return the time of one code in whole nanoseconds; FormatError where 32 bits cannot hold it or it is not exact."""
    period = round(1e9 / rate_Hz)
    if period > LONGEST_NS:
        raise FormatError(
            f"c-array holds a period of at most {LONGEST_NS / 1e9:.2f} s (32 bits of nanoseconds); {rate_Hz:g} Hz is "
            f"one of {1 / rate_Hz:.2f} s: use a device with a higher rate, or another format"
        )
    if period < 1 or abs(period * rate_Hz / 1e9 - 1) > LEAST_EXACT:
        raise FormatError(
            f"c-array holds a period in whole nanoseconds; {rate_Hz:g} Hz is one of {1e9 / rate_Hz:.4g} ns, which it "
            f"would round by more than {LEAST_EXACT:.2%}: use a device with a lower rate, or another format"
        )
    return period


def in_comment(text: str) -> str:
    """Return a text that is safe in a C comment: it cannot end it, nor begin a line, an escape or a trigraph."""
    plain = "".join(char if " " <= char <= "~" else "?" for char in clean_line(text))
    return plain.replace("*/", "*_").replace("/*", "_*").replace("\\", "_").replace("??", "__")


def identifier(name: str) -> str:
    """Return a name that C takes, for its file too: one called stdint would stand in for the header of that name."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return plain if re.match(r"[A-Za-z]", plain) and plain.casefold() != "stdint" else f"icon_{plain}"


def player_files(drives: Sequence[Played], demands: Demands) -> dict[str, bytes]:
    """Return the player for drives of one device, with the numbers that the hardware must keep to, and its serial line.

    Its digest is of the drives, and of itself after them, with zeros for the digest.
    """
    drives = sorted(drives, key=lambda each: each.file)  # so that it is one export, whatever its order
    first = drives[0].delivery
    down, up = partial(c_float, toward=-math.inf), partial(c_float, toward=math.inf)
    inward = partial(c_float, toward=0.0)
    courses = {identifier(each.delivery.icon.name): course_C(each.delivery, COURSE_S) for each in drives}
    cut, test, loop = demands.cut_off_display_C, demands.test, demands.loop
    held = demands.held_cut_off_display_C or HeldCutOff(cut.low, cut.high, 0.0)
    gains = loop.played if loop else (0.0, 0.0, 0.0)
    limits_A = demands.current_limit_A or (0.0, 0.0)
    numbers = {
        "DIGEST": DIGITS * "0",
        "NAMES": ", ".join(f'"{name}"' for name in courses),
        "CLOSED_LOOP": str(int(first.device.kind.regulated)),
        "WATCHDOG_S": down(demands.watchdog_s or cut.act_within_s),
        "NEEDS_SENSOR": str(int(first.device.kind.regulated or not demands.watchdog_s)),
        "LOW_C": up(cut.low),
        "HIGH_C": down(cut.high),
        "HELD_LOW_C": up(held.low),
        "HELD_HIGH_C": down(held.high),
        "HELD_S": down(held.longer_than_s),
        "REACT_S": down(cut.act_within_s),
        "REST_S": up(demands.rest_s),
        "PAUSE_S": up(demands.pause_s),
        "TEST_POLARITY": str(int(test is not None)),
        "OFF_S": up(test.off_before_s if test else 0.0),
        "TEST_COMMAND": inward(command_for(first, test.test_current_A) if test else 0.0),
        "TEST_UNIT": OUTPUT_UNITS[first.device.driven_by],
        "TEST_S": up(test.test_s if test else 0.0),
        "TEST_FALL_K": down(test.display_change_at_least_K if test else 0.0),
        **dict(zip(("KP", "KI", "KD"), map(inward, gains), strict=True)),
        **dict(zip(("LOWEST_A", "HIGHEST_A"), map(inward, limits_A), strict=True)),
        "SECOND_SENSOR": str(int(loop is not None)),
        "COURSE_MS": str(round(1e3 * COURSE_S)),
        "COURSES": "\n".join(_course(name, levels) for name, levels in courses.items()),
        "OUTPUT_UNIT": OUTPUT_UNITS[first.device.driven_by],
        "VERDICTS": "\n".join(f"   {played.file}: {played.verdict}." for played in drives),
    }
    together = b"".join(each.content for each in drives) + filled(PLAYER, numbers)
    player = filled(PLAYER, {**numbers, "DIGEST": sha256(together).hexdigest()[:DIGITS]})
    places = [
        f"    {f'case {k}' if k else 'default'}: return THERMICON_ICON({name});" for k, name in enumerate(courses)
    ]
    includes = "\n".join(f'#include "{each.file}"' for each in drives)
    line = {"INCLUDES": includes, "COUNT": str(len(courses)), "CASES": "\n".join(places)}
    return {PLAYER: player, SERIAL: filled(SERIAL, line)}


def filled(template: str, values: Mapping[str, str]) -> bytes:
    """Return a template of `circuit/data` with each `@NAME@` replaced."""
    text = shipped_text(f"data/{template}")
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    return text.encode("ascii")


def command_for(delivery: DeliveredDrive, current_A: float) -> float:
    """The command of a device for a test current in A, in what it puts out: V, A or mean duty."""
    device, kind = delivery.device, delivery.device.kind
    command = current_A / kind.unit_A(device, delivery.rig)
    return min(1.0, command) if kind.switches else command


def c_float(value: float, toward: float | None = None) -> str:
    """A number as a C float literal; in 32 bits it is no farther from `toward` than the number itself."""
    if toward is None:
        return f"{float(value)!r}f"
    short = np.float32(value)
    if abs(toward - float(short)) > abs(toward - value) or (math.isinf(toward) and (float(short) - value) * toward < 0):
        short = np.nextafter(short, np.float32(toward))
    return f"{float(str(short))!r}f"


def _course(name: str, levels: Array) -> str:
    """The predicted display of an icon in hundredths of a degree."""
    codes = np.rint(levels / CENTI_K).astype(int).tolist()
    rows = ",\n".join("    " + ", ".join(map(str, codes[k : k + A_LINE])) for k in range(0, len(codes), A_LINE))
    return f"static const int16_t thermicon_course_{name}[] PROGMEM = {{\n{rows}}};"


FORMAT = Format(
    name="c-array",
    title="header file for a microcontroller",
    suffix=".h",
    takes=(*PLAYS_SAMPLES, *PLAYS_TEMPERATURES),
    device="dac-12",
    source="ISO C99, stdint.h; PROGMEM of avr-libc",
    how="include it and thermicon_player.h; give the player your board's functions, and call thermicon_step steadily",
    write=write,
    columns=columns,
    stem=identifier,
    player=player_files,
    set_files=(PLAYER, SERIAL),
    holds=(
        *("watchdog_s", "cut_off_display_C", "held_cut_off_display_C", "rest_before_first_play_s"),
        *("pause_at_least_s", "current_limit_A", "loop"),
    ),
    proves=("polarity_check",),
)
