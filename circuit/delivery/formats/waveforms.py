"""Waveform files of drives as WAV or TDMS.

A sound has far more frames than a drive has updates: each update is repeated a whole number of times, and nothing is
resampled. An output that is not DC-coupled loses every held level.
"""

import io
import wave
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thermicon.base.numbers.program import own_version

from ..commands import Column
from ..delivered_drive import DeliveredDrive
from ..device import Device
from .form import PLAYS_SAMPLES, PLAYS_TEMPERATURES, Format, FormatError, OneFile, on_one_clock, samples_of
from .tables import CODE, VOLTAGE, has_voltage, volts_of

FULL = 32768
MOST_FRAMES = 200_000_000
"""Frames of one file: 400 MB, where the format's own 32 bits end at 4.3 GB."""

FRAME_RATES_HZ = (48_000, 44_100, 96_000, 88_200, 192_000, 176_400, 32_000, 24_000, 22_050, 16_000, 11_025, 8_000)
"""Frames per second that sound interfaces play, the most common first."""

GROUP = "thermicon"
LARGEST = 2**31 - 1
"""Greatest code of a TDMS file: they are written in 32 bits."""


def wav_columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """The one channel."""
    scale = samples_of(delivery).scale
    return (Column("channel 1", "", f"16-bit PCM; full scale (±{FULL}) is ±{-scale.step * scale.lowest:g} V"),)


def frames(delivery: DeliveredDrive) -> tuple[int, int]:
    """Frames per second, at best within the range of the device, and frames per update, a whole number."""
    rate = samples_of(delivery).rate_Hz
    low, high = delivery.device.interval("update rate")
    for frame_rate in sorted(FRAME_RATES_HZ, key=lambda one: not low <= one <= high):
        each = round(frame_rate / rate)
        if each >= 1 and abs(each * rate - frame_rate) < 1e-9 * frame_rate:
            return frame_rate, each
    raise FormatError(
        f"wav: no rate that sound interfaces play ({min(FRAME_RATES_HZ):,} to {max(FRAME_RATES_HZ):,} frames a second) "
        f"is a whole multiple of the {rate:g} Hz of {delivery.device.name}; set driver.update_Hz to 100, which "
        f"dc-coupled-audio plays"
    )


def wav_facts(delivery: DeliveredDrive) -> dict[str, object]:
    """Facts about the file for the sidecar."""
    frame_rate, each = frames(delivery)
    return {"frames_per_second": frame_rate, "frames_per_update": each}


def wav_fits(device: Device) -> None:
    """Raise FormatError for a device that is not DC-coupled, or has levels other than those of full scale."""
    if device.levels != "fixed" or device.scale(0.0).offset != 0:
        raise FormatError(f"wav has no levels of its own; {device.name} sets its levels by the waveform: use another")
    if not device.dc_coupled:
        raise FormatError(
            f"wav: {device.name} is not said to be DC-coupled (dc_coupled = true); an output that is not loses every "
            f"held level; use dc-coupled-audio, or another format"
        )


def wav_write(delivery: DeliveredDrive) -> bytes:
    """The file; raises FormatError for what `wav_fits` refuses, a rate that cannot be reached, and too many frames."""
    WAV.check(delivery.device)
    samples = samples_of(delivery)
    frame_rate, each = frames(delivery)
    if (count := len(samples.codes) * each) > MOST_FRAMES:
        raise FormatError(
            f"wav: {count:,} frames at {frame_rate:,} a second; at most {MOST_FRAMES:,} are written, which is over an "
            f"hour: shorten the icon or its tail"
        )
    full = -samples.scale.lowest * samples.scale.step
    pcm = np.clip(np.rint(samples.command / full * FULL), -FULL, FULL - 1).astype("<i2")
    file = io.BytesIO()
    with wave.open(file, "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(frame_rate)
        sound.writeframes(np.repeat(pcm, each).tobytes())
    return file.getvalue()


def tdms_columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Channels of the group `thermicon`."""
    device = delivery.device
    return (device.kind.command, CODE, *((VOLTAGE,) if has_voltage(device) else ()))


def tdms_columns_together(deliveries: Sequence[DeliveredDrive]) -> tuple[Column, ...]:
    """Channels of each element, which begin with its name where there are several."""
    own = [(one.element, column) for one in deliveries for column in tdms_columns(one)]
    return tuple(replace(column, name=f"{element}_{column.name}") if element else column for element, column in own)


def tdms_channels(deliveries: Sequence[DeliveredDrive]) -> tuple[object, ...]:
    """Names of the channels of each element."""
    return tuple([column.name for column in tdms_columns_together([one])] for one in deliveries)


def tdms_write(delivery: DeliveredDrive) -> bytes:
    """The file; raises FormatError where npTDMS is not installed."""
    return tdms_together([delivery])


def tdms_together(deliveries: Sequence[DeliveredDrive]) -> bytes:
    """The file of elements on one clock; raises FormatError where npTDMS is not installed."""
    delivery, every = deliveries[0], on_one_clock(deliveries)
    TDMS.check(delivery.device)
    from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

    samples = every[0]
    if samples.scale.highest > LARGEST or samples.scale.lowest < -LARGEST - 1:
        raise FormatError(
            f"tdms: codes are written in 32 bits, up to {LARGEST:,}; {delivery.device.name} has "
            f"{samples.scale.lowest:,} … {samples.scale.highest:,}: use csv"
        )
    clock = {"wf_start_offset": 0.0, "wf_increment": 1.0 / samples.rate_Hz, "wf_samples": len(samples.codes)}
    root = RootObject({"name": delivery.icon.name, "author": f"thermicon {own_version()}"})
    group = GroupObject(GROUP, {"device": delivery.device.name, "rig": delivery.rig.name})
    values = []
    for each in every:
        values += [each.command, each.codes.astype("<i4")]
        if has_voltage(delivery.device):
            values.append(volts_of(delivery.device, each.command))
    channels = [
        ChannelObject(GROUP, column.name, value, {"unit_string": column.unit, **clock})
        for column, value in zip(tdms_columns_together(deliveries), values, strict=True)
    ]
    file = io.BytesIO()
    with TdmsWriter(file) as writer:
        writer.write_segment([root, group, *channels])
    return file.getvalue()


WAV = Format(
    name="wav",
    title="sound file for a DC-coupled output",
    suffix=".wav",
    takes=("volts",),
    device="dc-coupled-audio",
    source="RIFF WAVE, PCM; written and read by Python's wave module",
    how="play it at full volume, where full scale gives the volts that the sidecar names, without resampling, effects "
    "or fades, on an output that is DC-coupled",
    write=wav_write,
    columns=wav_columns,
    facts=wav_facts,
    fits=wav_fits,
)

TDMS = Format(
    name="tdms",
    title="National Instruments TDMS",
    suffix=".tdms",
    takes=(*PLAYS_SAMPLES, *PLAYS_TEMPERATURES),
    device="ni-analogue-output",
    source="written and read by npTDMS; properties of waveform channels as in its documentation",
    how="play channel command_V at 1/wf_increment, samps_per_chan = wf_samples, finite",
    write=tdms_write,
    columns=tdms_columns,
    needs="npTDMS",
    together=OneFile(
        tdms_together, tdms_columns_together, tdms_channels, "the channels of an element begin with its name"
    ),
)
