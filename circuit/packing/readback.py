"""Drive files read back: number of values, duration and extremes, from the bytes alone."""

from __future__ import annotations

import csv
import io
import re
import wave
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..delivery.netlist_drive import EDGE_S

WAV_FULL = 32768


@dataclass(frozen=True, slots=True)
class Figures:
    """What a drive file holds: number of values or segments, duration in s, and extremes of its commands.

    The extremes are in V, A, duty or °C, as the device takes them; what a format does not hold is None.
    """

    count: int | None
    duration_s: float | None
    least: float
    greatest: float


@dataclass(frozen=True, slots=True)
class StatedFigures:
    """What a sidecar states about the same, and the scale of codes: command = offset + step · code."""

    count: int
    duration_s: float
    least: float
    greatest: float
    offset: float
    step: float
    lowest_code: int
    frames: int
    unit: str

    @staticmethod
    def of(about: Mapping[str, Any]) -> StatedFigures:
        """Read a sidecar; raises KeyError, TypeError or ValueError where information is missing."""
        played = about["played"]
        if "segments" in played:
            ends = float(played["least_level_C"]), float(played["greatest_level_C"])
            return StatedFigures(
                int(played["segments"]), float(played["duration_s"]), *ends, 0.0, float(played["step_K"]), 0, 1, "°C"
            )
        unit = next(key.removeprefix("offset_") for key in played if key.startswith("offset_"))
        ends = float(played[f"least_command_{unit}"]), float(played[f"greatest_command_{unit}"])
        display_unit = "°C" if unit == "C" else unit
        scale = float(played[f"offset_{unit}"]), float(played[f"step_{unit}"])
        lowest = int(played["lowest_code"])
        frames = int(about["format"].get("frames_per_update", 1))
        return StatedFigures(
            int(played["samples"]), float(played["duration_s"]), *ends, *scale, lowest, frames, display_unit
        )


def read_back(drive: bytes, about: Mapping[str, Any]) -> Figures | None:
    """Return what a drive file holds, None for a format that is not read; `about` is its sidecar.

    Raises ValueError where the file cannot be read as its format.
    """
    try:
        name = str(about["format"]["name"])
        if name == "psychopy":
            kinds = {"set-points": "tcs2-serial", "temperatures": "setpoint-csv"}
            name = kinds.get(about["device"]["driven_by"], "csv")
        reader = READERS.get(name)
        return None if reader is None else reader(drive, StatedFigures.of(about), about)
    except Exception as problem:  # whatever a damaged file makes a reader do, it is not what was exported
        raise ValueError(str(problem) or type(problem).__name__) from None


def differences(actual: Figures, stated: StatedFigures) -> list[str]:
    """One phrase for each disagreement between a drive file and its sidecar.

    >>> told = StatedFigures(802, 8.01, -1.0, 2.0, 0.0, 0.001, -32768, 1, "V")
    >>> differences(Figures(802, 8.01, -1.0, 2.5), told)
    ['goes up to 2.5 V, not 2 V']
    """
    sentences = []
    if actual.count is not None and actual.count != stated.count:
        sentences.append(f"holds {actual.count} values, not {stated.count}")
    if actual.duration_s is not None and abs(actual.duration_s - stated.duration_s) > max(
        2e-6, 1e-6 * stated.duration_s
    ):
        sentences.append(f"lasts {actual.duration_s:.9g} s, not {stated.duration_s:.9g} s")
    near = max(0.6 * stated.step, 1e-9)  # half a code, since some formats round to their own
    if abs(actual.least - stated.least) > near:
        sentences.append(f"goes down to {actual.least:.6g} {stated.unit}, not {stated.least:.6g} {stated.unit}")
    if abs(actual.greatest - stated.greatest) > near:
        sentences.append(f"goes up to {actual.greatest:.6g} {stated.unit}, not {stated.greatest:.6g} {stated.unit}")
    return sentences


def _table(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures:
    rows = list(csv.DictReader(io.StringIO(drive.decode("utf-8"))))
    column = "duty" if stated.unit in ("duty", "1") else f"command_{stated.unit}"
    command = np.array([float(row[column]) for row in rows])
    code = np.array([int(row["code"]) for row in rows])
    if not np.allclose(stated.offset + stated.step * code, command, rtol=0.0, atol=0.01 * stated.step):
        raise ValueError(f"codes and {column} disagree")
    return Figures(None, float(rows[-1]["time_s"]), float(command.min()), float(command.max()))


def _setpoints(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures:
    rows = list(csv.DictReader(io.StringIO(drive.decode("utf-8"))))
    levels = [float(row["display_C"]) for row in rows]
    return Figures(None, float(rows[-1]["time_s"]), min(levels), max(levels))


def _pairs(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures:
    pairs = np.loadtxt(io.BytesIO(drive), ndmin=2)
    return Figures(None, float(pairs[-1, 0]) - EDGE_S, float(pairs[:, 1].min()), float(pairs[:, 1].max()))


def _arb(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures:
    head, _, body = drive.decode("ascii").partition("Data:\r\n")
    keys = dict(line.split(":", 1) for line in head.splitlines())
    codes = np.array(body.split(), dtype=np.int64)
    if len(codes) != int(keys["Data Points"]):
        raise ValueError(f"has {len(codes)} values but says {keys['Data Points']}")
    return _of_codes(codes, (len(codes) - 1) / float(keys["Sample Rate"]), stated)


def _raf(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures:
    return _of_codes(np.frombuffer(drive, dtype="<u2").astype(np.int64), None, stated)


def _array(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures:
    match = re.search(r"_wave\[\][^{]*\{([^}]*)\}", drive.decode("ascii"))
    if match is None:
        raise ValueError("contains no array of codes")
    return _of_codes(np.array([int(code) for code in match[1].split(",") if code.strip()]), None, stated)


def _sound(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures:
    with wave.open(io.BytesIO(drive)) as sound:
        rate, pcm = sound.getframerate(), np.frombuffer(sound.readframes(sound.getnframes()), dtype="<i2")
    each = pcm[:: stated.frames] * (-stated.lowest_code * stated.step / WAV_FULL)
    return Figures(len(each), (len(each) - 1) * stated.frames / rate, float(each.min()), float(each.max()))


def _serial(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures:
    lines = drive.decode("ascii").split()
    baseline = next(int(line[1:]) for line in lines if re.fullmatch(r"N\d+", line))
    profile = next(line.removeprefix("Uw")[5:] for line in lines if line.startswith("Uw"))  # five zones first
    count, numbers = int(profile[:3]), [int(profile[k : k + 3]) for k in range(3, len(profile), 3)]
    if len(numbers) != 2 * count:
        raise ValueError(f"has {len(numbers) // 2} segments but says {count}")
    levels = stated.step * np.array([baseline, *numbers[1::2]])
    tick_s = float(about["played"]["tick_s"])
    return Figures(count, sum(numbers[::2]) * tick_s, float(levels.min()), float(levels.max()))


def _tdms(drive: bytes, stated: StatedFigures, about: Mapping[str, Any]) -> Figures | None:
    try:
        from nptdms import TdmsFile
    except ImportError:
        return None
    channel = next(each for each in TdmsFile.read(io.BytesIO(drive))["thermicon"].channels() if each.name != "code")
    values, step_s = np.asarray(channel[:]), float(channel.properties["wf_increment"])
    return Figures(len(values), (len(values) - 1) * step_s, float(values.min()), float(values.max()))


def _of_codes(codes: Any, duration_s: float | None, stated: StatedFigures) -> Figures:
    command = stated.offset + stated.step * codes
    return Figures(len(codes), duration_s, float(command.min()), float(command.max()))


READERS: dict[str, Callable[[bytes, StatedFigures, Mapping[str, Any]], Figures | None]] = {
    "csv": _table,
    "setpoint-csv": _setpoints,
    "spice-pwl": _pairs,
    "keysight-arb": _arb,
    "rigol-raf": _raf,
    "c-array": _array,
    "wav": _sound,
    "tdms": _tdms,
    "tcs2-serial": _serial,
}
