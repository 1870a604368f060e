"""NI TDMS: the commands as a waveform channel, written by npTDMS."""

from __future__ import annotations

import io

from ...program import own_version
from ..delivered_drive import DeliveredDrive
from .form import (
    PLAYS_SAMPLES,
    PLAYS_TEMPERATURES,
    Column,
    Format,
    FormatError,
    command_column,
    samples_of,
)
from .tables import VOLTAGE, has_voltage, volts_of

GROUP = "thermicon"
LARGEST = 2**31 - 1
"""Greatest code: they are written in 32 bits."""


def columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Channels of the group `thermicon`."""
    extra = (VOLTAGE,) if _is_voltage(delivery) else ()
    code = Column("code", "", "the command as a whole number of the device's steps")
    return (command_column(delivery), code, *extra)


def _is_voltage(delivery: DeliveredDrive) -> bool:
    return delivery.device.driven_by == "temperatures" and has_voltage(delivery.device)


def write(delivery: DeliveredDrive) -> bytes:
    """Return the file; raises FormatError where npTDMS is not installed."""
    try:
        from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
    except ImportError:
        raise FormatError('tdms needs npTDMS, which is not installed: pip install "thermicon[hardware]"') from None
    samples, command = samples_of(delivery), command_column(delivery)
    if samples.scale.highest > LARGEST or samples.scale.lowest < -LARGEST - 1:
        raise FormatError(
            f"tdms: codes are written in 32 bits, up to {LARGEST:,}; {delivery.device.name} has "
            f"{samples.scale.lowest:,} … {samples.scale.highest:,}: use csv"
        )
    clock = {"wf_start_offset": 0.0, "wf_increment": 1.0 / samples.rate_Hz, "wf_samples": len(samples.codes)}
    root = RootObject({"name": delivery.icon.name, "author": f"thermicon {own_version()}"})
    group = GroupObject(GROUP, {"device": delivery.device.name, "rig": delivery.rig.name})
    channels = [
        ChannelObject(GROUP, command.name, samples.command, {"unit_string": command.unit, **clock}),
        ChannelObject(GROUP, "code", samples.codes.astype("<i4"), {"unit_string": "", **clock}),
    ]
    if _is_voltage(delivery):
        volts = volts_of(delivery.device, samples.command)
        channels.append(ChannelObject(GROUP, VOLTAGE.name, volts, {"unit_string": VOLTAGE.unit, **clock}))
    file = io.BytesIO()
    with TdmsWriter(file) as writer:
        writer.write_segment([root, group, *channels])
    return file.getvalue()


FORMAT = Format(
    name="tdms",
    title="National Instruments TDMS",
    suffix=".tdms",
    takes=(*PLAYS_SAMPLES, *PLAYS_TEMPERATURES),
    device="ni-analogue-output",
    source="written and read by npTDMS; properties of waveform channels as in its documentation",
    how="play channel command_V at 1/wf_increment, samps_per_chan = wf_samples, finite",
    write=write,
    columns=columns,
)
