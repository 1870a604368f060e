"""C array: codes in the flash of a microcontroller, as a header file."""

from __future__ import annotations

import re

from thermicon.circuit.delivery.formats.form import PLAYS_SAMPLES, Column, Format, FormatError, samples_of
from thermicon.circuit.delivery.realised import Realised

A_LINE = 16
SMALLEST, LARGEST = -32768, 32767


def columns(realised: Realised) -> tuple[Column, ...]:
    """The array."""
    scale = samples_of(realised).scale
    return (Column("wave", "", f"codes; times {scale.step:.9g} plus {scale.offset:.9g} {scale.unit}"),)


def write(realised: Realised) -> bytes:
    """Return the header; raises FormatError for codes that 16 bits cannot hold."""
    samples, device = samples_of(realised), realised.device
    scale = samples.scale
    if scale.lowest < SMALLEST or scale.highest > LARGEST:
        raise FormatError(f"c-array holds int16_t; {device.name} has codes of {scale.lowest} … {scale.highest}")
    name, codes = identifier(realised.icon.name), samples.codes.tolist()
    rows = [", ".join(map(str, codes[k : k + A_LINE])) for k in range(0, len(codes), A_LINE)]
    unit = "duty" if scale.unit == "1" else scale.unit
    lines = [
        f"/* {name} for {device.name.encode('ascii', 'replace').decode('ascii')}, written by thermicon.",
        f"   {unit} = {scale.offset!r} + {scale.step!r} * code. Put out one code every period and hold it.",
        "   The first code is the rest, the last marks the end and is the rest again. */",
        "#pragma once",
        "#include <stdint.h>",
        "#ifdef __AVR__",
        "#include <avr/pgmspace.h>",
        "#elif !defined(PROGMEM)",
        "#define PROGMEM",
        "#endif",
        "",
        f"static const uint32_t {name}_period_ns = {round(1e9 / samples.rate_Hz)}UL;",
        f"static const uint32_t {name}_count = {len(codes)}UL;",
        f"static const int16_t {name}_wave[] PROGMEM = {{",
        *(f"  {row}," for row in rows),
        "};",
        "",
    ]
    return "\n".join(lines).encode("ascii")


def identifier(name: str) -> str:
    """Return a name that C takes.

    >>> identifier("cooling-step")
    'cooling_step'
    """
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return plain if re.match(r"[A-Za-z]", plain) else f"icon_{plain}"


FORMAT = Format(
    name="c-array",
    title="header file for a microcontroller",
    suffix=".h",
    takes=PLAYS_SAMPLES,
    device="dac-12",
    source="ISO C99, stdint.h; PROGMEM of avr-libc",
    how="include it, read with pgm_read_word on AVR, put out a code every period",
    write=write,
    columns=columns,
    stem=identifier,
)
