"""Players with bad clocks or sensors, restarts or aborts: the judged drive, or a stop.

`-m slow` makes 500 runs, or fewer if THERMICON_EVIDENCE says so, half of them in C. All times are true ones, by which a
clock is judged too.
"""

import csv
import io
import math
import os
import sys
import types
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.circuit.daq import Daq
from tests.circuit.delivery.formats.test_c_player import FROZEN, LATE, LOST, STANDS, STOPPED, build, run
from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library

pytestmark = pytest.mark.slow
RUNS = min(500, int(os.environ.get("THERMICON_EVIDENCE", "500"))) // 2
LINES = {"ni": "ni-analogue-output", "tcs2": "qst-tcs2", "function": "closed-loop-controller"}
REST_S, PAUSE_S, ICON_S = 30.0, 20.0, 8.0
TICK_S = 0.016


@cache
def exported(device: str) -> tuple[dict[str, bytes], str, Any]:
    form, rig = load_format("psychopy"), Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
    ready = prepare(load_library("six-icons")["double-dip"], rig, Device.load(device), form, gate=GreenVerdict)
    return pack([ready], form), form.file_name(ready.delivery), ready.delivery


class World:
    """A computer and a display, as the player of one line meets them; `out` has what was put out by the true time."""

    def __init__(self, line: str, rng: np.random.Generator, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        files, name, self.delivery = exported(LINES[line])
        self.line, self.rng, self.path, self.script = line, rng, str(folder / name), files["play_icons.py"]
        Path(self.path).write_bytes(files[name])
        self.rows = list(csv.DictReader(io.StringIO(files[name].decode()))) if line != "tcs2" else []
        self.true_s = self.began_s = float(rng.uniform(0, 1e5))
        self.out: list[tuple[float, Any]] = []
        self.daq = Daq(lambda: self.true_s)
        self.daq.out = types.SimpleNamespace(append=self.put)  # type: ignore[assignment]
        monkeypatch.setitem(sys.modules, "nidaqmx", self.daq)
        monkeypatch.setitem(sys.modules, "nidaqmx.constants", self.daq)
        self.port = types.SimpleNamespace(write=self.put)
        self.clock, self.clock_s = "right", math.inf
        self.sensor, self.sensor_s, self.stuck_C = "live", math.inf, 32.0
        self.abort_s, self.quantum_K = math.inf, float(rng.choice([0.0, 0.01, 0.1]))
        self.start()

    def start(self) -> None:
        """A new process, on a computer that was mended."""
        self.clock_s = self.sensor_s = math.inf
        self.player: dict[str, Any] = {}
        exec(compile(self.script, "play_icons.py", "exec"), self.player)
        self.player["time"] = self
        self.player["TEST_POLARITY"] = False

    def put(self, value: Any) -> None:
        self.out.append((self.true_s, value))
        if isinstance(value, list) or value == b"L":
            self.began_s = self.true_s

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

    def measured(self) -> float:
        trace, bad = self.delivery.trace, self.true_s >= self.sensor_s
        now_C = float(np.interp(self.true_s - self.began_s, trace.time_s, trace.display_C))
        if self.line == "function":
            now_C = next((float(level) for _, level in reversed(self.out) if level != "off"), 32.0)
        now_C = round(now_C / self.quantum_K) * self.quantum_K if self.quantum_K else now_C + self.rng.normal(0, 1e-3)
        if not bad:
            self.stuck_C = now_C
        return (
            {"frozen": self.stuck_C, "no number": math.nan, "steps": now_C + 12.0}.get(self.sensor, now_C)
            if bad
            else now_C
        )

    def play(self) -> None:
        if self.line == "tcs2":
            if not self.player["_course"]:
                self.player["prepare"](self.port, self.path)
            self.player["play"](self.port, self.measured)
        elif self.line == "ni":
            self.player["play"](self.path, self.measured)
        else:
            self.player["play"](self.path, self.put, lambda: self.put("off"), self.measured)

    def is_off(self) -> bool:
        return self.out[-1][1] in (0.0, b"A", "off")

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


@pytest.mark.parametrize("line", LINES)
def test_scripts(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plays = stops = 0
    for number in range(-(-RUNS // len(LINES))):
        rng = np.random.default_rng([7, list(LINES).index(line), number])
        world = World(line, rng, tmp_path, monkeypatch)
        world.clock = str(rng.choice(["right", "right", "coarse", "no number", "back", "stands"]))
        world.sensor = str(rng.choice(["live", "live", "frozen", "no number", "steps"]))
        free_s, least_s, rested = world.true_s, max(REST_S, PAUSE_S), False
        world.clock_s, world.sensor_s, world.abort_s = world.true_s + rng.uniform(0, 100, 3)
        for _ in range(4):
            log, called_s = len(world.out), world.true_s
            try:
                world.play()
                why = ""
            except RuntimeError as problem:
                why = str(problem)
            began_s, wrong = world.began_and_wrong(world.out[log:], rested)
            told = f"{line} {number}: {world.clock}, {world.sensor}: {why}"
            assert not wrong, f"{told}: {wrong}"
            if began_s is not None:
                plays += 1
                assert began_s - free_s >= least_s - TICK_S, f"{told}: sooner than rest and pause"
            if "pause of" in why:
                world.true_s += float(rng.uniform(0, PAUSE_S))
                continue
            if not why:
                seen_s = world.true_s - max(world.sensor_s, called_s)
                assert began_s is not None
                frozen = world.sensor == "frozen" and (world.sensor_s > began_s + 0.5 or world.quantum_K == 0.1)
                assert seen_s < 0.2 or world.sensor == "live" or frozen, f"{told}: the sensor was not noticed"
                between = world.clock == "back" and world.clock_s < called_s  # then it only makes the pause longer
                assert world.true_s - world.clock_s < 0.2 or world.clock in ("right", "coarse") or between, told
                free_s, least_s, rested = world.true_s, PAUSE_S, True
                world.true_s += float(rng.uniform(0, 2 * PAUSE_S))
                continue
            stops += 1
            assert world.is_off(), told
            due = {"frozen": "frozen", "live": "abort", "no number": "lost", "steps": "outside"}[world.sensor]
            assert any(word in why for word in (due, "abort", "clock", "stopped before")), told
            free_s, least_s, rested = world.true_s, max(REST_S, PAUSE_S), False
            world.true_s += float(rng.uniform(0, 3.0))
            world.player["reset"]() if world.clock in ("right", "coarse") and rng.random() < 0.5 else world.start()
            world.sensor_s = math.inf
    assert plays > RUNS // 4
    assert stops > RUNS // 12


@pytest.mark.parametrize("device", ["dac-12", "closed-loop-controller"])
def test_in_c(device: str, tmp_path: Path, tool: Callable[[str], str]) -> None:
    program = build(tmp_path, device, tool("cc"))
    rng, faults = np.random.default_rng([8, len(device)]), set()
    for _ in range(RUNS // 2):
        dt_us = float(rng.choice([1000, 5000, 10_000]))
        turns = 80e6 / dt_us
        at = [float(each) for each in rng.integers(0, turns, 4)]
        clocks: list[dict[str, float]] = [
            {}, {"tick_us": 1000.0}, {"tick_us": 10_000.0}, {"start_us": 2**32 - float(rng.uniform(0, 80e6))},
            {"stand_at": at[0]}, {"back_at": at[0], "back_us": float(rng.uniform(dt_us + 1, 1e9))},
            {"late_at": at[0], "late_us": float(rng.uniform(2.1e4, 5e5))},
        ]  # fmt: skip
        others: list[dict[str, float]] = [
            {"step_mK": float(rng.choice([0, 10, 100]))}, {"abort_at": at[1]}, {"mute_at": at[1]},
            {"bad_at": at[1], "kind": float(rng.integers(1, 5)), "which": float(rng.integers(1, 4))},
        ]  # fmt: skip
        again = {"begin_at": at[3]} if rng.random() < 0.3 else {}
        story = {
            "dt_us": dt_us,
            "turns": turns,
            **clocks[rng.integers(len(clocks))],
            **others[rng.integers(len(others))],
        }
        told = run(program, **story, **again)
        faults.add(told["fault"])
        standing_s = 1.05e-4 * dt_us if "stand_at" in story else 0.0
        assert told["wrong"] <= standing_s, (story, again, told)
        assert told["waited"] >= REST_S - 1e-6 * story.get("tick_us", 0.0), (story, again, told)
        assert told["paused"] >= PAUSE_S - 1e-6 * story.get("tick_us", 0.0), (story, again, told)
        assert told["state"] != STOPPED or told["out"] == 0.0
        if not again and {"stand_at", "back_at"} & set(story) and at[0] < turns - 200:
            assert told["state"] == STOPPED, (story, told)
        if not again and story.get("kind") in (1, 3, 4) and at[1] < turns - 1:
            assert told["state"] == STOPPED, (story, told)
    assert RUNS < 200 or faults >= {0, LATE, LOST, FROZEN, STANDS}


@pytest.mark.parametrize(("device", "how"), [("ni-analogue-output", "play"), ("closed-loop-controller", "rest")])
def test_a_script_plays_no_drive_that_was_not_exported_with_it(device: str, how: str, tmp_path: Path) -> None:
    """Its cut-off, rest and pause are those of other drives."""
    files, drive, _ = exported(device)
    script: dict[str, Any] = {}
    exec(compile(files["play_icons.py"], "play_icons.py", "exec"), script)
    (tmp_path / f"other-{drive}").write_bytes(files[drive])
    out = [] if device == "ni-analogue-output" else [lambda level: None, lambda: None]
    with pytest.raises(RuntimeError, match=f"was not exported with this script, which plays {drive}"):
        script[how](str(tmp_path / f"other-{drive}"), *out)
