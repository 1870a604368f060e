"""A computer and a display, as the exported player of one line meets them, by true times."""

import csv
import io
import math
import sys
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.circuit.daq import Daq
from tests.circuit.delivery.one_drive import prepare
from tests.circuit.serial_line import Serial
from tests.circuit.verdicts import GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library

LINES = {"ni": "ni-analogue-output", "tcs2": "qst-tcs2", "function": "closed-loop-controller"}
REST_S, PAUSE_S, ICON_S = 30.0, 20.0, 8.0
TICK_S = 0.016
HANG = threading.Event()
"""What a reading that never comes back waits for."""


@cache
def exported(device: str) -> tuple[dict[str, bytes], str, Any]:
    form, rig = load_format("psychopy"), Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
    ready = prepare(load_library("six-icons")["double-dip"], rig, Device.load(device), form, gate=GreenVerdict)
    return pack([ready], form), form.file_name(ready.delivery), ready.delivery


class Sensor:
    """A thermistor on the display: late by `lag_s`, off by `off_K`, in steps; from `fault_s` on something is wrong."""

    def __init__(self, world: "World", step_K: float = 0.0) -> None:
        self.world, self.step_K = world, step_K
        self.lag_s = self.off_K = self.takes_s = 0.0
        self.fault, self.fault_s, self.lie_K = "", math.inf, 0.0
        self.stuck_C, self.reads = 32.0, 0

    def __call__(self) -> float:
        world, self.reads = self.world, self.reads + 1
        fault = self.fault if world.true_s >= self.fault_s else ""
        now_C = world.display_C(world.true_s - self.lag_s) + self.off_K
        world.true_s += self.takes_s * float(world.sensor_rng.uniform(0.2, 1.0))
        noise_K = float(world.sensor_rng.normal(0, 1e-3))
        now_C = round(now_C / self.step_K) * self.step_K if self.step_K else now_C + noise_K
        if fault == "hangs":
            assert HANG.wait(60.0), "a reading that hangs is waited for"
        if fault == "slow":
            world.true_s += 1.5 * world.player["REACT_S"]
        if fault == "frozen":
            return self.stuck_C
        self.stuck_C = now_C
        return {"no number": math.nan, "steps": now_C + 12.0, "lies": now_C + self.lie_K}.get(fault, now_C)


class World:
    """A computer with a clock, a script and a device; `out` has what was put out by the true time."""

    def __init__(self, line: str, rng: np.random.Generator, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        files, name, self.delivery = exported(LINES[line])
        self.line, self.rng, self.path, self.script = line, rng, str(folder / name), files["play_icons.py"].decode()
        self.sensor_rng = np.random.default_rng(int(rng.integers(2**32)))
        Path(self.path).write_bytes(files[name])
        self.rows = list(csv.DictReader(io.StringIO(files[name].decode()))) if line != "tcs2" else []
        self.true_s = float(rng.uniform(0, 1e5))
        self.began_s = math.inf
        self.out: list[tuple[float, Any]] = []
        self.daq = Daq(lambda: self.true_s)
        self.daq.out = Puts(self.put)
        monkeypatch.setitem(sys.modules, "nidaqmx", self.daq)
        monkeypatch.setitem(sys.modules, "nidaqmx.constants", self.daq)
        self.port = Serial(self.passes)
        self.port.commands = self.port.device.commands = Puts(self.put)
        self.clock, self.clock_s, self.abort_s = "right", math.inf, math.inf
        self.first = Sensor(self, float(rng.choice([0.0, 0.01, 0.1])))
        self.second: Sensor | None = None
        self.gain, self.late_s = 1.0, 0.0
        self.start()

    def start(self, change: Callable[[str], str] = str) -> None:
        """A new process, on a computer that was mended; `change` makes another script of the exported one."""
        self.clock_s = self.first.fault_s = math.inf
        self.is_prepared, self.player = False, dict[str, Any]()
        exec(compile(change(self.script), "play_icons.py", "exec"), self.player)
        self.player["atexit"].unregister(self.player["abort"])
        self.player["time"] = self
        self.player["TEST_POLARITY"] = False

    def passes(self, seconds: float) -> None:
        self.true_s += seconds

    def put(self, value: Any) -> None:
        self.out.append((self.true_s, value))
        starts = isinstance(value, list) or value == b"L" or (self.line == "function" and self.player["_guard"].rested)
        is_first = self.line != "function" or not self.true_s <= self.began_s + ICON_S + 1.0 or self.began_s == math.inf
        if value == "off":
            self.began_s = math.inf
        elif starts and is_first:
            self.began_s = self.true_s

    def display_C(self, at_s: float) -> float:
        """A display that goes where it is predicted to go, by its gain and the time by which it is late."""
        trace, since_s = self.delivery.trace, at_s - self.late_s - self.began_s
        return 32.0 + self.gain * (float(np.interp(since_s, trace.time_s, trace.display_C)) - 32.0) * (since_s > 0)

    def monotonic(self) -> float:
        after_s = self.true_s - self.clock_s
        if after_s >= 0:
            faults = {"no number": math.nan, "back": self.true_s - 7.0, "stands": self.clock_s, "right": self.true_s}
            return faults.get(self.clock, math.floor(self.true_s / TICK_S) * TICK_S)
        return math.floor(self.true_s / TICK_S) * TICK_S if self.clock == "coarse" else self.true_s

    def sleep(self, seconds: float) -> None:
        self.true_s += seconds + float(self.rng.exponential(2e-4))
        if self.true_s > self.abort_s:
            self.abort_s = math.inf
            self.player["abort"]()

    def play(self) -> None:
        sensors = (self.first, *([self.second] if self.second else []))
        if self.line == "tcs2":
            if not self.is_prepared:
                self.player["prepare"](self.port, self.path)
                self.is_prepared = True
            self.player["play"](self.port, *sensors)
        elif self.line == "ni":
            self.player["play"](self.path, *sensors)
        else:
            self.player["play"](self.path, self.put, lambda: self.put("off"), *sensors)

    def is_off(self) -> bool:
        return not self.out or self.out[-1][1] in (0.0, b"A", "off")

    def began_and_wrong(self, log: list[tuple[float, Any]], rested: bool) -> tuple[float | None, str]:
        """When a play began, if it did, and what it put out that is not the drive."""
        if self.line != "function":
            begun = [(at_s, value) for at_s, value in log if isinstance(value, list) or value == b"L"]
            for _, value in begun:
                if isinstance(value, list) and value != [float(row["command_V"]) for row in self.rows]:
                    return begun[0][0], "other volts"
                if isinstance(value, list) and abs(self.daq.rate - self.delivery.rate_Hz) > 1e-6:
                    return begun[0][0], "another rate"
            return (begun[0][0] if begun else None), ""
        sent = [each for each in log if each[1] != "off"][0 if rested else 1 :]
        for (at_s, level), row in zip(sent, self.rows, strict=False):
            late_s = at_s - sent[0][0] - float(row["time_s"])
            if level != float(row["display_C"]) or not -TICK_S <= late_s <= self.player["LATE_S"] + TICK_S:
                return sent[0][0], f"{level} °C, {late_s} s late"
        return (sent[0][0] if sent else None), ""

    def is_whole(self, log: list[tuple[float, Any]], rested: bool) -> bool:
        """Whether a play put out all of its drive."""
        values = [value for _, value in log]
        if self.line == "tcs2":
            return values[-1] == b"L"
        if self.line == "ni":
            return values[-1] == [float(row["command_V"]) for row in self.rows]
        return values[0 if rested else 1 :] == [float(row["display_C"]) for row in self.rows]


class Puts(list[Any]):
    """A list that tells what is appended."""

    def __init__(self, put: Callable[[Any], None]) -> None:
        super().__init__()
        self._put = put

    def append(self, value: Any) -> None:
        super().append(value)
        self._put(value)
