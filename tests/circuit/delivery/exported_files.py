"""Readers of exported files that know each format by its documentation only."""

import csv
import io
import json
import re
import wave
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.circuit.delivery.independent import Array
from tests.circuit.delivery.replay import Held

TICK_S = 0.01


@dataclass(frozen=True)
class Course:
    """Display temperatures at steps in s; `held` until the next or linear."""

    display_C: Array
    step_s: float
    held: bool


def sidecar_in(files: Mapping[str, bytes], stem: str) -> dict[str, Any]:
    """The sidecar of an icon."""
    return dict(json.loads(files[f"{stem}.json"]))


def read_file(files: Mapping[str, bytes], stem: str) -> Held | Course:
    """What a device makes of a file: currents held, or display temperatures."""
    told = sidecar_in(files, stem)
    data, kind, driver = files[told["file"]], told["device"]["driven_by"], told["rig"]["document"].get("driver")
    if kind == "set-points":
        return serial(data)
    if kind == "temperatures":
        times, levels = table(data, "display_C") if data[:4] != b"TDSm" else channel(data, "display_C")
        return Course(levels, float(times[1] - times[0]), held=True)
    times, command = samples(told, data)
    if kind == "duty":
        span = next(each for each in told["device"]["records"] if each["quantity"] == "output range")
        peak = min(-span["low"], span["high"])
        return Held.of(times, command * peak, np.abs(command) * peak**2)
    ampere = command * (driver["transconductance_A_per_V"] if kind == "volts" else 1.0)
    return Held.of(times, ampere, ampere**2)


def samples(told: Mapping[str, Any], data: bytes) -> tuple[Array, Array]:
    """Times in s and commands."""
    played, name = told["played"], told["format"]["name"]
    if name in ("csv", "psychopy"):
        return table(data, "command_V", "command_A", "duty")
    if name == "tdms":
        return channel(data, "command_V", "command_A", "duty")
    if name == "c-array":
        return array(data.decode("ascii"))
    assert name == "wav"
    with wave.open(io.BytesIO(data)) as sound:
        rate, pcm = sound.getframerate(), np.frombuffer(sound.readframes(sound.getnframes()), dtype="<i2")
    kept = np.append(True, np.diff(pcm) != 0)
    kept[-1] = True
    return np.flatnonzero(kept) / rate, pcm[kept] / 32768 * -played["low_level_V"]


def table(data: bytes, *names: str) -> tuple[Array, Array]:
    """Columns of a CSV file with a header."""
    rows = list(csv.DictReader(io.StringIO(data.decode())))
    name = next(name for name in names if name in rows[0])
    return np.array([float(row["time_s"]) for row in rows]), np.array([float(row[name]) for row in rows])


def channel(data: bytes, *names: str) -> tuple[Array, Array]:
    """A waveform channel of a TDMS file, read by npTDMS."""
    from nptdms import TdmsFile

    group = TdmsFile.read(io.BytesIO(data))["thermicon"]
    found = next(one for one in group.channels() if one.name in names)
    values = np.asarray(found[:], dtype=np.float64)
    return np.arange(len(values)) * float(found.properties["wf_increment"]), values


def array(text: str) -> tuple[Array, Array]:
    """Codes of a C header, with the scale that its comment tells."""
    scale, period = re.search(r"= (\S+) \+ (\S+) \* code", text), re.search(r"_period_ns = (\d+)UL", text)
    assert scale is not None
    assert period is not None
    codes = np.array([int(word) for word in text.partition("PROGMEM = {")[2].partition("}")[0].split(",")[:-1]])
    return np.arange(len(codes)) * int(period[1]) * 1e-9, float(scale[1]) + float(scale[2]) * codes


def serial(data: bytes) -> Course:
    """Commands of a TCS II: baseline, and segments of ticks of 10 ms to levels in 0.1 °C."""
    neutral, _, profile, _, _ = data.decode("ascii").split()
    count, body = int(profile[7:10]), profile[10:]
    assert len(body) == 6 * count
    ticks, levels = [0], [int(neutral[1:])]
    for k in range(count):
        ticks.append(ticks[-1] + int(body[6 * k : 6 * k + 3]))
        levels.append(int(body[6 * k + 3 : 6 * k + 6]))
    return Course(np.interp(np.arange(ticks[-1] + 1), ticks, levels) / 10, TICK_S, held=False)
