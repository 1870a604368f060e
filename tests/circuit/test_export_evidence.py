"""What export lets out stays inside the limits: random cues, rigs and devices, read back from the exported file.

Every file is parsed by readers written here, and what it makes flow is run by itself, scenario by scenario, against
the limits as published; some are run by ngspice. The ordinary suite has 40 drives, each in a few of its scenarios;
`pytest -m slow tests/circuit/test_export_evidence.py` has 2,000 in all of them. A bridge is not run by ngspice, which
cannot start from its ripple.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
import subprocess
import wave
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Device, Drive, Prepared, Rig, RigError, Setpoints, prepare, simulate_current, steady_state
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.export import pack
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.netlist import netlist
from thermicon.circuit.delivery.realise import followed
from thermicon.circuit.delivery.worstcase import regulated_corners
from thermicon.circuit.rig.skin import Array
from thermicon.circuit.safety.corners import corners_of
from thermicon.circuit.safety.tally import WATCHED
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.pwm import steady_of
from thermicon.icons import Icon, parse

PARTS, PER_PART, NGSPICE_PER_PART = 8, 250, 25
CLOSE = 3e-3
"""Nearer to a limit than this, in K, K/s or a share, either verdict is right."""

WAYS = (
    ("dac-12", "csv"), ("dac-16", "csv"), ("ni-analogue-output", "csv"), ("dac-16", "spice-pwl"), ("dac-12", "c-array"),
    ("keysight-33500b", "keysight-arb"), ("rigol-dg1000z", "rigol-raf"), ("dc-coupled-audio", "wav"),
    ("pwm-h-bridge-10", "csv"), ("pwm-h-bridge-10", "c-array"),
    ("qst-tcs2", "tcs2-serial"), ("qst-tcs2", "tcs2-serial"),
)  # fmt: skip

HARD = {"skin_C": (15.0, 42.0), "cold_receptor_C": (15.0, 42.0), "display_C": (5.0, 45.0), "hot_plate_C": (None, 60.0)}
SOFT = {"skin_C": (22.0, 40.0), "display_C": (10.0, 43.0)}


def between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(f"{rng.uniform(low, high):.4g}")


def some_rig(rng: np.random.Generator) -> Rig:
    base = Rig.load(str(rng.choice(["thenar", "shani2021", "fingertip", "forearm", "hand-dorsum"])))
    changes: dict[str, object] = {
        "heat_sink.temperature_C": between(rng, 25, 42),
        "heat_sink.resistance_K_per_W": between(rng, 0.1, 0.6),
        "module.cold_plate_J_per_K": between(rng, 1.5, 6),
        "module.seebeck_V_per_K": between(rng, 0.03, 0.06),
        "contact.area_cm2": between(rng, 4, 16),
        "contact.resistance_m2K_per_W": between(rng, 3e-4, 2e-3),
        "driver.current_limit_A": between(rng, 0.5, 2),
        "driver.update_Hz": float(rng.choice([20, 50, 100])),
    }
    if rng.random() < 0.5:
        changes["uncertainty.contact_resistance_relative"] = between(rng, 0, 0.5)
        changes["uncertainty.ambient_K"] = between(rng, 0, 5)
        changes["uncertainty.gain_relative"] = between(rng, 0, 0.2)
        changes["uncertainty.reason"] = "a rig made up by chance for a test"
    return base.with_(**changes)


def some_icon(rng: np.random.Generator) -> Icon:
    way, control = rng.choice(["cool", "warm"]), rng.choice(["skin", "display"])
    back = "" if rng.random() < 0.1 else f"; return at {rng.uniform(0.5, 4):.2f} °C/s"
    text = (
        f"cue 1\nset s {{ control {control}\n baseline {rng.integers(30, 34)} °C }}\nicon a {{ {way} by "
        f"{rng.uniform(0.5, 11):.2f} °C at {rng.uniform(0.5, 5):.2f} °C/s; "
        f"hold for {rng.uniform(0.2, 5):.2f} s{back} }}"
    )
    return parse(text)["a"]


@dataclass(frozen=True)
class Case:
    """One cue that was prepared, and the files it gave; none where the gate says red."""

    ready: Prepared
    form: str
    files: dict[str, bytes]

    def __repr__(self) -> str:
        return f"{self.ready.realised!r} as {self.form}, {self.ready.verdict.colour}: {self.ready.realised.icon}"


def cases(seed: int, count: int) -> Iterator[Case]:
    """Cues that a device can play; what is red is tried to be packed, and must not be."""
    rng, found = np.random.default_rng([11, seed]), 0
    while found < count:
        rig, icon, (device, name) = some_rig(rng), some_icon(rng), WAYS[rng.integers(len(WAYS))]
        form = load_format(name)
        try:
            ready = prepare(icon, rig, Device.load(device), form)
        except (RigError, DeviceError):  # a baseline that this rig, or a level that this device, cannot have
            continue
        found += 1
        if ready.verdict.colour == "red":
            with pytest.raises(FormatError, match="a: NOT SAFE: "):
                pack([ready], form)
            yield Case(ready, name, {})
        else:
            yield Case(ready, name, pack([ready], form))


def read_back(case: Case) -> tuple[Array, Array]:
    """Times in s and commands, from nothing but the exported files."""
    told: dict[str, Any] = json.loads(case.files["a.json"])
    data, played = case.files[told["file"]], told["played"]
    if case.form == "csv":
        table = list(csv.DictReader(io.StringIO(data.decode())))
        name = next(key for key in ("command_V", "command_A", "duty") if key in table[0])
        return np.array([float(row["time_s"]) for row in table]), np.array([float(row[name]) for row in table])
    if case.form == "spice-pwl":
        times, volts = np.loadtxt(io.BytesIO(data)).T
        return times, volts
    if case.form == "c-array":
        text = data.decode("ascii")
        scale, period = re.search(r"= (\S+) \+ (\S+) \* code", text), re.search(r"_period_ns = (\d+)UL", text)
        assert scale is not None
        assert period is not None
        codes = np.array([int(word) for word in text.partition("PROGMEM = {")[2].partition("}")[0].split(",")[:-1]])
        return np.arange(len(codes)) * int(period[1]) * 1e-9, float(scale[1]) + float(scale[2]) * codes
    if case.form == "keysight-arb":
        head, _, body = data.decode("ascii").partition("Data:\r\n")
        header = dict(line.split(":", 1) for line in head.splitlines())
        high, low = float(header["High Level"]), float(header["Low Level"])
        codes = np.array([int(line) for line in body.splitlines()])
        return np.arange(len(codes)) / float(header["Sample Rate"]), low + (codes + 32767) / 65534 * (high - low)
    if case.form == "rigol-raf":
        codes = np.frombuffer(data, dtype="<u2")
        low, high = played["low_level_V"], played["high_level_V"]
        return np.arange(len(codes)) / told["update_rate_Hz"]["realised"], low + codes / 0x3FFF * (high - low)
    assert case.form == "wav"
    with wave.open(io.BytesIO(data)) as sound:
        rate, pcm = sound.getframerate(), np.frombuffer(sound.readframes(sound.getnframes()), dtype="<i2")
    kept = np.append(True, np.diff(pcm) != 0)
    kept[-1] = True
    return np.flatnonzero(kept) / rate, pcm[kept] / 32768 * -played["low_level_V"]


def read_setpoints(case: Case) -> Setpoints:
    """The segments of a thermode's commands, ticks of 10 ms and steps of 0.1 °C."""
    neutral, _, profile, _, _ = case.files["a.tcs2.txt"].decode("ascii").split()
    body = profile[len("Uw11111000") :]
    pairs = tuple((int(body[k : k + 3]), int(body[k + 3 : k + 6])) for k in range(0, len(body), 6))
    return Setpoints(0.01, 0.1, int(neutral[1:]), pairs)


def pulses(times: Array, duty: Array, cycle_s: float, peak_A: float) -> Drive:
    """The current of a bridge, cycle by cycle; every cycle begins with the on-time."""
    updates = np.diff(times)
    count = np.rint(updates / cycle_s).astype(int)
    first = np.repeat(np.cumsum(count) - count, count)
    width, share = np.repeat(updates / count, count), np.repeat(duty[:-1], count)
    begin = np.repeat(times[:-1], count) + (np.arange(count.sum()) - first) * width
    on, off = share != 0, np.abs(share) < 1
    at = np.concatenate([begin[on], (begin + np.abs(share) * width)[off]])
    current = np.concatenate([np.copysign(peak_A, share[on]), np.zeros(off.sum())])
    order = np.argsort(at)
    return Drive([*at[order], times[-1]], [*current[order], 0.0], held=True)


Scenario = tuple[str, Rig, Drive, Array]


def scenarios(case: Case, few: np.random.Generator | None = None) -> Iterator[Scenario]:
    """In words, the rig, what flows through it until 60 s after the end, and the state it starts from."""
    rig, device = case.ready.realised.rig, case.ready.realised.device
    if device.driven_by == "set-points":
        setpoints, lead = read_setpoints(case), 1.0 / rig.driver.update_Hz
        for words, there in regulated_corners(rig):
            try:
                drive = followed(there, setpoints, lead, lead + float(setpoints.time_s[-1]))
            except RigError:  # a module that cannot hold the baseline there
                continue
            start = steady_state(network_of(there), float(drive.current_A[0]))
            if few is None or few.random() < 0.2:
                yield words, there, extended(drive, float(drive.current_A[-1])), start
                yield f"{words}, off", there, extended(drive, 0.0), start
        return
    times, command = read_back(case)
    for corner in corners_of(rig):
        gain = 1.0 + corner.gain_relative
        if few is not None and few.random() < 0.8:
            continue
        words, network = str(corner), network_of(corner.rig)
        if device.driven_by == "duty":
            low, high = device.interval("output range")
            peak, cycle = min(-low, high), 1.0 / device.most("carrier frequency")
            later = np.arange(1, round(60 / (times[1] - times[0]))) * (times[1] - times[0])
            whole, rest = np.concatenate([times, times[-1] + later]), float(command[0])
            for last in (float(command[-1]), 0.0):
                duty = np.concatenate([command[:-1], np.full(len(later) + 1, last)])
                drive = pulses(whole, duty, cycle, peak * gain)
                yield f"{words}, then duty {last:g}", corner.rig, drive, steady_of(corner.rig, rest, peak * gain)
            continue
        volts = 1.0 if device.driven_by == "amperes" else rig.driver.transconductance_A_per_V
        drive = Drive(times, command * volts * gain, held=case.form != "spice-pwl")
        try:
            start = steady_state(network, float(drive.current_A[0]))
        except ArithmeticError:
            continue
        yield words, corner.rig, extended(drive, float(drive.current_A[-1])), start
        yield f"{words}, off", corner.rig, extended(drive, 0.0), start


def extended(drive: Drive, last_A: float) -> Drive:
    """The drive with 60 s of a last current behind it; a jump is 1 µs wide."""
    end = float(drive.time_s[-1])
    if drive.held:
        return Drive([*drive.time_s, end + 60], [*drive.current_A[:-1], last_A, last_A], held=True)
    return Drive([*drive.time_s, end + 1e-6, end + 60], [*drive.current_A, last_A, last_A])


def beyond(time: Array, columns: dict[str, Array]) -> tuple[float, float]:
    """How far beyond the nearest hard and soft limits one run goes; negative where it stays inside."""
    hard: list[float] = []
    soft: list[float] = []
    for limits, far in ((HARD, hard), (SOFT, soft)):
        for name, (low, high) in limits.items():
            if high is not None:
                far.append(float(columns[name].max()) - high)
            if low is not None:
                far.append(low - float(columns[name].min()))
    skin, steps = columns["skin_C"], np.diff(time)
    soft.append(float(np.abs(skin - skin[0]).max()) - 8.0)
    whole = steps > 1e-3
    hard.append(float(np.abs(np.diff(skin)[whole] / steps[whole]).max()) - 10.0)
    middle = 0.5 * (skin[1:] + skin[:-1])
    rate = np.where(middle < 37, 0.0, np.where(middle < 43, 0.25, 0.5) ** (43 - middle))
    hard.append(math.log(max(float(rate @ steps) / 60 / 1.0, 1e-30)))
    burn = np.exp(math.log(3.1) + 98 * math.log(10) - 6.28e5 / 8.31446 / (middle + 273.15))
    hard.append(math.log(max(float(burn @ steps) / 0.01, 1e-30)))
    shown = 0.5 * (columns["display_C"][1:] + columns["display_C"][:-1])
    hard += [float(steps[shown > 43].sum()) / 600 - 1, float(steps[shown > 48].sum()) / 60 - 1]
    return max(hard), max(soft)


def hold_to_promise(case: Case, few: np.random.Generator | None = None) -> int:
    """Run every scenario of an exported drive by itself; the number of runs."""
    runs = 0
    for words, rig, drive, start in scenarios(case, few):
        trace = simulate_current(drive, rig, start_C=start)
        hard, soft = beyond(trace.time_s, {name: getattr(trace, name) for name in WATCHED})
        said = f"{case!r} with {words}: hard {hard:.4f}, soft {soft:.4f}"
        assert hard <= CLOSE, said
        assert soft <= CLOSE or case.ready.verdict.colour == "amber", said
        runs += 1
    return runs


def check_all(seed: int, count: int, few: bool) -> Counter[str]:
    """Every drive of a part; what was counted."""
    told: Counter[str] = Counter()
    rng = np.random.default_rng([12, seed])
    for case in cases(seed, count):
        told[case.ready.verdict.colour] += 1
        if case.files:
            told["runs"] += hold_to_promise(case, rng if few else None)
            told[case.form] += 1
    return told


def test_forty_exported_drives_stay_inside_their_limits() -> None:
    told = check_all(100, 40, few=True)
    assert told["red"] > 3, "cues that must not be exported are among them"
    assert min(told["green"], told["amber"]) > 3
    assert told["runs"] > 60


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_every_exported_drive_stays_inside_its_limits(part: int) -> None:
    told = check_all(part, PER_PART, few=False)
    print(part, dict(told))
    assert min(told[colour] for colour in ("green", "amber", "red")) > PER_PART // 20, told
    assert all(told[form] for _, form in WAYS), told


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_ngspice_finds_exported_drives_inside_their_limits(
    part: int, tool: Callable[[str], str], tmp_path: Path
) -> None:
    far = done = 0.0
    for number, case in enumerate(cases(part, 10 * NGSPICE_PER_PART)):
        if not case.files or case.ready.realised.device.driven_by == "duty":
            continue
        every = list(scenarios(case))
        words, rig, drive, start = every[(7 * number) % len(every)]
        text = netlist(rig, drive, out_file="out.txt")
        (tmp_path / "rig.cir").write_text(text, encoding="ascii")
        run = subprocess.run(
            [tool("ngspice"), "-b", "rig.cir"], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False
        )
        assert run.returncode == 0, run.stdout + run.stderr
        table = np.loadtxt(tmp_path / "out.txt", skiprows=1)
        trace = simulate_current(drive, rig, start_C=start)
        for column, name in enumerate(("hot_plate_C", "display_C", "skin_C", "cold_receptor_C"), start=3):
            low, high = HARD[name]
            theirs, ours = table[:, column], getattr(trace, name)
            assert high is None or theirs.max() <= high + CLOSE, f"{case!r} with {words}"
            assert low is None or theirs.min() >= low - CLOSE, f"{case!r} with {words}"
            apart = np.abs(np.interp(trace.time_s, table[:, 0], theirs) - ours)
            far = max(far, float((apart / np.maximum(1.0, np.abs(ours - ours[0]) / 20)).max()))
        done += 1
        if done == NGSPICE_PER_PART:
            break
    print(part, f"{done:g} drives, temperatures within {1e3 * far:.2f} mK")
    assert far < 2e-3
    assert done == NGSPICE_PER_PART
