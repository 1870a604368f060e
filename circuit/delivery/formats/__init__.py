"""thermicon.circuit.delivery.formats: a delivered drive → the bytes of a file."""

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


OTHER_WORDS = {
    "csv": "excel table text",
    "setpoint-csv": "controller pid meerstetter",
    "tdms": "ni labview nidaqmx daqmx",
    "wav": "audio sound",
    "c-array": "arduino esp32 teensy pico stm32 pwm",
    "tcs2-serial": "tcs tcs2 qst thermode",
    "psychopy": "python py",
}
"""What people write for a format: the hardware and programs that take it."""


def format_names() -> tuple[str, ...]:
    """Names of the formats."""
    return tuple(MODULES)


def load_format(name: str) -> Format:
    """Return a format by name; raises FormatError with the nearest."""
    if name not in MODULES:
        known = {each: load_format(each) for each in MODULES}
        also = {each: f"{form.device} {form.title} {OTHER_WORDS[each]}" for each, form in known.items()}
        raise FormatError(f"{name}: no such format; {did_you_mean(name, MODULES, 2, also=also)}")
    there = vars(import_module(f"{__name__}.{MODULES[name]}")).values()
    return next(each for each in there if isinstance(each, Format) and each.name == name)


__all__ = ["Format", "FormatError", "format_names", "load_format"]
