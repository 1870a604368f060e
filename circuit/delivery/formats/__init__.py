"""thermicon.circuit.delivery.formats: a delivered drive → the bytes of a file."""

import re
from importlib import import_module

from thermicon.base.words.near_words import did_you_mean
from .form import Format, FormatError

MODULES = {
    "csv": "tables",
    "setpoint-csv": "tables",
    "tdms": "waveforms",
    "wav": "waveforms",
    "c-array": "c_array",
    "tcs2-serial": "tables",
    "psychopy": "psychopy",
}
"""Formats by name, each with the module that writes it."""


def format_names() -> tuple[str, ...]:
    """Names of the formats."""
    return tuple(MODULES)


def load_format(name: str) -> Format:
    """Return a format by name; raises FormatError with the nearest."""
    if name not in MODULES:
        known = {each: load_format(each) for each in MODULES}
        words = {each: re.split(r"\W+", f"{form.device} {form.title}".casefold()) for each, form in known.items()}
        meant = [f"{each} (for {known[each].device})" for each in known if name and name.casefold() in words[each]]
        raise FormatError(f"{name}: no such format; {did_you_mean(name, MODULES, 2, ' or '.join(meant[:2]))}")
    there = vars(import_module(f"{__name__}.{MODULES[name]}")).values()
    return next(each for each in there if isinstance(each, Format) and each.name == name)


__all__ = ["Format", "FormatError", "format_names", "load_format"]
