"""thermicon.circuit.delivery.formats: a delivered drive → the bytes of a file; one writer per module, loaded lazily."""

from __future__ import annotations

from importlib import import_module

from thermicon.icons.near_words import did_you_mean
from .form import Format, FormatError

MODULES = {
    "csv": "csv_table",
    "setpoint-csv": "setpoint_csv",
    "tdms": "tdms",
    "wav": "wav",
    "c-array": "c_array",
    "tcs2-serial": "tcs2_serial",
    "tcs2-protocol-ini": "tcs2_protocol",
    "psychopy": "psychopy",
}
"""Formats by name, each with the module that writes it."""


def format_names() -> tuple[str, ...]:
    """Names of the formats."""
    return tuple(MODULES)


def load_format(name: str) -> Format:
    """Return a format by name; raises FormatError with the nearest.

    >>> load_format("csv")
    Format('csv', *.csv, for volts, amperes, duty)
    """
    if name not in MODULES:
        raise FormatError(f"{name}: no such format; {did_you_mean(name, MODULES, most=2)}")
    found: Format = import_module(f"{__name__}.{MODULES[name]}").FORMAT
    return found


__all__ = ["Format", "FormatError", "format_names", "load_format"]
