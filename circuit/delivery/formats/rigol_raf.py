"""Rigol RAF: nothing but codes of 14 bits in 16, little-endian; rate and levels are set by hand."""

from __future__ import annotations

import re

from ..delivered_drive import DeliveredDrive
from .form import Column, Format, FormatError, samples_of

FULL = 0x3FFF


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """The list of codes."""
    return (Column("codes", "", f"16-bit little-endian; 0 is the low level in V, {FULL} the high level"),)


def write(delivery: DeliveredDrive) -> bytes:
    """Return the codes."""
    samples = samples_of(delivery)
    if (samples.scale.lowest, samples.scale.highest) != (0, FULL):
        raise FormatError(
            f"rigol-raf needs codes of 0 … {FULL} (14 bits, from zero); {delivery.device.name} has "
            f"{samples.scale.lowest} … {samples.scale.highest}"
        )
    return samples.codes.astype("<u2").tobytes()


def stem(name: str) -> str:
    """The instrument shows only letters, digits and underscores in names.

    >>> stem("cooling-step")
    'cooling_step'
    """
    return re.sub(r"[^A-Za-z0-9_]", "_", name)


FORMAT = Format(
    name="rigol-raf",
    title="arbitrary waveform of Rigol DG1000Z generators",
    suffix=".RAF",
    takes=("volts",),
    device="rigol-dg1000z",
    source="Rigol DG1000Z User's Guide, p. 2-75 (14 of 16 bits, two levels); sigrok wiki, Rigol RAF (byte order)",
    how="read it from a USB stick in sample-rate mode; set sample rate, high and low level as the sidecar says",
    write=write,
    columns=columns,
    stem=stem,
)
