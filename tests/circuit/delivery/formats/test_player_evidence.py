"""Players with bad clocks or sensors, restarts or aborts: the judged drive, or a stop.

`-m slow` makes 500 runs, or fewer if THERMICON_EVIDENCE says so, half of them in C. All times are true ones, by which a
clock is judged too.
"""

import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.circuit.delivery.formats.test_c_player import FROZEN, LATE, LOST, STANDS, STOPPED, build, run
from tests.circuit.delivery.formats.world import LINES, PAUSE_S, REST_S, TICK_S, Sensor, World, exported

pytestmark = pytest.mark.slow
RUNS = min(500, int(os.environ.get("THERMICON_EVIDENCE", "500"))) // 2


@pytest.mark.parametrize("line", LINES)
def test_scripts(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plays = stops = 0
    for number in range(-(-RUNS // len(LINES))):
        rng = np.random.default_rng([7, list(LINES).index(line), number])
        world = World(line, rng, tmp_path, monkeypatch)
        world.clock = str(rng.choice(["right", "right", "coarse", "no number", "back", "stands"]))
        sensor, step_K = world.first, world.first.step_K
        sensor.fault = str(rng.choice(["live", "live", "frozen", "no number", "steps"]))
        free_s, least_s, rested = world.true_s, max(REST_S, PAUSE_S), False
        world.clock_s, sensor.fault_s, world.abort_s = world.true_s + rng.uniform(0, 100, 3)
        for _ in range(4):
            log, called_s = len(world.out), world.true_s
            try:
                world.play()
                why = ""
            except RuntimeError as problem:
                why = str(problem)
            began_s, wrong = world.began_and_wrong(world.out[log:], rested)
            told = f"{line} {number}: {world.clock}, {sensor.fault}: {why}"
            assert not wrong, f"{told}: {wrong}"
            if began_s is not None:
                plays += 1
                assert began_s - free_s >= least_s - TICK_S, f"{told}: sooner than rest and pause"
            if "pause of" in why:
                world.true_s += float(rng.uniform(0, PAUSE_S))
                continue
            if not why:
                seen_s = world.true_s - max(sensor.fault_s, called_s)
                assert began_s is not None
                frozen = sensor.fault == "frozen" and (sensor.fault_s > began_s + 0.5 or step_K == 0.1)
                assert seen_s < 0.2 or sensor.fault == "live" or frozen, f"{told}: the sensor was not noticed"
                between = world.clock == "back" and world.clock_s < called_s  # then it only makes the pause longer
                assert world.true_s - world.clock_s < 0.2 or world.clock in ("right", "coarse") or between, told
                free_s, least_s, rested = world.true_s, PAUSE_S, True
                world.true_s += float(rng.uniform(0, 2 * PAUSE_S))
                continue
            stops += 1
            assert world.is_off(), told
            due = {"frozen": "frozen", "live": "abort", "no number": "lost", "steps": "outside"}[sensor.fault]
            assert any(word in why for word in (due, "abort", "clock", "stopped before", "prediction")), told
            free_s, least_s, rested = world.true_s, max(REST_S, PAUSE_S), False
            world.true_s += float(rng.uniform(0, 3.0))
            world.player["reset"]() if world.clock in ("right", "coarse") and rng.random() < 0.5 else world.start()
            sensor.fault_s = math.inf
        assert not world.daq.open_tasks
        assert not world.port.device.garbled
    assert plays > RUNS // 4
    assert stops > RUNS // 12


@pytest.mark.parametrize("line", LINES)
def test_many_plays_in_one_process(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With aborts and resets at any time: each play is right, and what it needed is free again."""
    rng = np.random.default_rng([9, list(LINES).index(line)])
    world, plays, rested = World(line, rng, tmp_path, monkeypatch), 0, False
    free_s, least_s = world.true_s, max(REST_S, PAUSE_S)
    while plays < (4 * RUNS) // 5:
        log, is_aborted = len(world.out), bool(rng.random() < 0.2)
        world.abort_s = world.true_s + float(rng.uniform(0, 40)) if is_aborted else math.inf
        try:
            world.play()
        except RuntimeError as problem:
            assert "abort() was called" in str(problem)
            assert is_aborted
            assert world.is_off()
            world.true_s += float(rng.uniform(0, 3.0))
            world.player["reset"]()
            free_s, least_s, rested = world.true_s, max(REST_S, PAUSE_S), False
        else:
            began_s, wrong = world.began_and_wrong(world.out[log:], rested)
            assert not wrong
            assert world.is_whole(world.out[log:], rested)
            assert began_s is not None
            assert began_s - free_s >= least_s - TICK_S
            plays += 1
            free_s, least_s, rested = world.true_s, PAUSE_S, True
            world.true_s += PAUSE_S + float(rng.uniform(0, 3.0))
        assert not world.daq.open_tasks
        if world.line == "tcs2":
            world.is_prepared &= bool(rng.random() < 0.7)


def test_healthy_plays_are_not_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Sensors off by 0.3 K, in steps, the second one late, readings of up to 0.8 of the time to react."""
    for number in range(3 * RUNS * 2 // 5):
        rng = np.random.default_rng([10, number])
        line = list(LINES)[number % 3]
        world = World(line, rng, tmp_path, monkeypatch)
        world.clock, react_s = str(rng.choice(["right", "coarse"])), float(rng.choice([0.05, 0.1, 0.5, 2.0]))
        world.player.update(REACT_S=react_s, LOOK_EVERY_S=react_s / 2.0, LATE_S=react_s)
        gain = float(rng.uniform(0.8, 1.2)) if line == "ni" else 1.0  # a loop corrects the gain of its driver
        world.gain, world.late_s = gain, 0.0 if line == "ni" else float(rng.uniform(-0.1, 0.1))  # of other loops
        world.first.step_K = float(rng.choice([0.01, 0.0625, 0.1]))
        world.first.off_K = float(rng.uniform(-0.3, 0.3))
        share = 0.8 if rng.random() < 0.7 else 0.0
        world.first.takes_s = share * react_s
        if rng.random() < 0.7:
            world.second = Sensor(world, float(rng.choice([0.01, 0.0625, 0.1])))
            world.second.off_K, world.second.lag_s = float(rng.uniform(-0.3, 0.3)), float(rng.uniform(0, 0.3))
            world.first.takes_s = world.second.takes_s = share * react_s / 2.0
        world.play()
        world.true_s += PAUSE_S + 1.0
        log = len(world.out)
        world.play()
        assert world.is_whole(world.out[log:], rested=True)


STOPS_S = {"lies": 0.3, "hangs": 0.0, "slow": 0.0, "frozen": 1.0}
"""How long what a sensor does must last, besides two looks and the time to react."""


@pytest.mark.parametrize("which", ["first", "second"])
@pytest.mark.parametrize("fault", STOPS_S)
def test_a_sensor_that_fails_in_mid_play_stops(
    fault: str, which: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number in range(-(-RUNS // 16)):
        rng = np.random.default_rng([11, list(STOPS_S).index(fault), number])
        world = World(list(LINES)[number % 3], rng, tmp_path, monkeypatch)
        world.second = Sensor(world, world.first.step_K)
        world.second.lag_s = float(rng.uniform(0, 0.3))
        sensor = world.first if which == "first" else world.second
        sensor.fault, sensor.lie_K = fault, float(rng.choice([-1, 1]) * rng.uniform(1.5, 5.0))
        if fault == "lies":
            sensor.lie_K += math.copysign(0.6, sensor.lie_K)  # what the other one's lag may hide
        begins_s = (
            world.true_s + REST_S + (float(rng.uniform(0.1, 1.2)) if fault == "frozen" else rng.uniform(0.1, 7.0))
        )
        sensor.fault_s = begins_s
        with pytest.raises(RuntimeError) as stopped:
            world.play()
        words = {"lies": "apart|outside|prediction", "hangs": "for a reading", "slow": "for a reading"}
        assert any(word in str(stopped.value) for word in words.get(fault, "frozen|apart").split("|"))
        assert world.is_off()
        assert not world.daq.open_tasks
        react_s = world.player["REACT_S"]
        most_s = STOPS_S[fault] + 3.0 * react_s + (2.5 if fault == "frozen" else 0.0)
        assert world.true_s - begins_s <= most_s, f"{fault} {number}: {stopped.value}"


REMOVED = {
    "outside 20 to 40": ("if not low_C <= now_C <= high_C:", "ni", "steps"),
    "is lost": ("if not SENSOR_LOWEST_C < now_C < SENSOR_HIGHEST_C:", "ni", "no number"),
    "K apart": ("apart_K > APART_K, now_s) >= APART_S - COARSE_S:", "ni", "lies"),
    "from its prediction": ("beside_K > BESIDE_K, now_s) > BESIDE_S:", "function", "lies"),
    "is frozen": ("SENSOR_STEP_K", "ni", "frozen"),
    "allowed": ("if most_s is not None and lasts_s > most_s:", "ni", ""),
    "for a reading": ("if is_watched and self._answer_s + NOTHING_S < gap_s < math.inf:", "ni", "slow"),
    "clock of this computer is wrong": ("if not before_s <= now_s < math.inf:", "ni", ""),
}
"""Words of each stop, with the text that is changed to remove it, and the line and the fault that it stops."""


@pytest.mark.parametrize("words", REMOVED)
def test_each_stop_is_needed(words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without it the same fault is not stopped for the same reason."""
    old, line, fault = REMOVED[words]
    new = "if False:" if old.startswith("if ") else old.rpartition(">")[0] + "> math.inf:"
    if words == "is frozen":
        old, new = "> numbers.frozen_s:", "> math.inf:"
    for is_removed in (False, True):
        world = World(line, np.random.default_rng([12]), tmp_path, monkeypatch)
        if is_removed:
            assert world.script.count(old) == 1
            world.start(lambda script: script.replace(old, new))
        world.first.fault, world.first.lie_K, world.first.step_K = fault, 3.0, 0.01
        world.first.fault_s = world.true_s + REST_S + 0.2
        if words == "K apart":
            world.second = Sensor(world, 0.01)
        if words == "allowed":
            world.player.update(HELD_LOW_C=31.9, HELD_HIGH_C=36.0, HELD_S=0.5)
        if words.startswith("clock"):
            world.clock, world.clock_s = "back", world.true_s + REST_S + 2.0
        why = ""
        try:
            world.play()
        except (RuntimeError, ValueError, AssertionError) as problem:
            why = str(problem)
        assert (words in why) != is_removed, why


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
