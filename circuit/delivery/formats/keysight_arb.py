"""Keysight .arb: a header in plain text, then one code per line; ±32767 are the two levels."""

from __future__ import annotations

from ..delivered_drive import DeliveredDrive
from .form import Column, Format, FormatError, samples_of

FULL = 32767
DECIMALS, MOST_OFF = 6, 1e-4
"""Decimals of the header's numbers, and the share by which these may change the sample rate."""


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """The list of codes."""
    return (Column("Data", "", f"code; {FULL} is the high level in V, −{FULL} the low level"),)


def write(delivery: DeliveredDrive) -> bytes:
    """Return the file; its filter is off, since the drive is a staircase."""
    samples = samples_of(delivery)
    scale = samples.scale
    if scale.highest != FULL or scale.lowest != -FULL:
        raise FormatError(
            f"keysight-arb needs codes of ±{FULL} (16 bits, symmetric); {delivery.device.name} has "
            f"{scale.lowest} … {scale.highest}"
        )
    low, high = (scale.offset + scale.step * code for code in (-FULL, FULL))
    header = [
        "File Format:1.10",
        "Checksum:0",
        "Channel Count:1",
        f"Sample Rate:{in_header('sample rate', samples.rate_Hz, 'Hz', MOST_OFF * samples.rate_Hz)}",
        f"High Level:{in_header('high level', high, 'V', scale.step)}",
        f"Low Level:{in_header('low level', low, 'V', scale.step)}",
        "Marker Point:1",  # sync changes with the first sample of the icon
        'Data Type:"short"',
        'Filter:"OFF"',
        f"Data Points:{len(samples.codes)}",
        "Data:",
    ]
    return ("\r\n".join([*header, *map(str, samples.codes.tolist())]) + "\r\n").encode("ascii")


def in_header(what: str, value: float, unit: str, most_off: float) -> str:
    """Return a number of the header, which has six decimals; FormatError where these are off by more than `most_off`.

    >>> in_header("high level", 1.0, "V", 1e-5)
    '1.000000'
    """
    text = f"{value:.{DECIMALS}f}"
    if abs(float(text) - value) > most_off:
        raise FormatError(
            f"keysight-arb writes its {what} with {DECIMALS} decimals; {value:.6g} {unit} would be {text} {unit}: "
            f"use another format, or a device with a wider range and a higher rate"
        )
    return text


FORMAT = Format(
    name="keysight-arb",
    title="waveform file of Keysight (Agilent) 33500 generators",
    suffix=".arb",
    takes=("volts",),
    device="keysight-33500b",
    source="public writers that agree: writeArbFile.m (Montana Tech, 2018), arbTo33500 (Agilent, N. Forcier)",
    how="load it by MMEMory:LOAD:DATA or from a USB stick, output load high impedance, one cycle on a trigger",
    write=write,
    columns=columns,
)
