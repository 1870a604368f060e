"""WAV: 16-bit PCM, for outputs that are DC-coupled; others lose every held level."""

from __future__ import annotations

import io
import wave

import numpy as np

from thermicon.circuit.formats.form import Column, Format, FormatError, samples_of
from thermicon.circuit.realise import Realised

FULL = 32768


def columns(realised: Realised) -> tuple[Column, ...]:
    """The one channel."""
    scale = samples_of(realised).scale
    return (Column("channel 1", "", f"16-bit PCM; full scale (±{FULL}) is ±{-scale.step * scale.lowest:g} V"),)


def write(realised: Realised) -> bytes:
    """Return the file; raises FormatError for a device that is not DC-coupled, or a rate that is no whole number."""
    device, samples = realised.device, samples_of(realised)
    if not device.dc_coupled:
        raise FormatError(
            f"wav: {device.name} is not said to be DC-coupled (dc_coupled = true); an output that is not loses every "
            f"held level"
        )
    if device.levels != "fixed" or samples.scale.offset != 0:
        raise FormatError(f"wav has no levels of its own; {device.name} sets its levels by the waveform: use another")
    rate = round(samples.rate_Hz)
    if abs(rate - samples.rate_Hz) > 1e-9:
        raise FormatError(
            f"wav: {samples.rate_Hz:g} Hz is no whole number of samples a second; set driver.update_Hz to one"
        )
    full = -samples.scale.lowest * samples.scale.step
    pcm = np.clip(np.rint(samples.command / full * FULL), -FULL, FULL - 1).astype("<i2")
    file = io.BytesIO()
    with wave.open(file, "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(rate)
        sound.writeframes(pcm.tobytes())
    return file.getvalue()


FORMAT = Format(
    name="wav",
    title="sound file for a DC-coupled output",
    suffix=".wav",
    takes=("volts",),
    device="dc-coupled-audio",
    source="RIFF WAVE, PCM; written and read by Python's wave module",
    how="play it at full volume without resampling, effects or fades, on an output that is DC-coupled",
    write=write,
    columns=columns,
)
