"""A simulated board around the exported C player."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from tests.circuit.delivery.followed import Follower
from tests.circuit.delivery.independent import worlds_of
from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import LOOP, MADE_UP, GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library

RIG = Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
ICON = load_library("six-icons")["double-dip"]
CFLAGS = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"]
VOLTS, CONTROLLER = "dac-12", "closed-loop-controller"
BOARDS = {VOLTS: ("-DRANGE=10.0", "-DA_PER_UNIT=0.1"), CONTROLLER: ("-DRANGE=1.5", "-DA_PER_UNIT=1.0")}
"""What an output takes at most, and the current in A that a unit of it gives."""
REAL_LOOP = replace(LOOP, playing_kp_A_per_K=(0.39, 0.39), playing_ki_A_per_Ks=(0.098, 0.098))
DEMANDS: dict[str, dict[str, Any]] = {VOLTS: {}, CONTROLLER: {"loop": REAL_LOOP, "current_limit_A": (-1.5, 1.5)}}
"""Where they differ from the made-up ones: the loop is the one that the set-points are shaped for."""
CORNERS = 65
"""Worlds of the rig: as given, and the corners of its uncertainty."""


def build(folder: Path, device: str, compiler: str, *flags: str, **demands: Any) -> Path:
    """Export the icon for a device, with made-up demands but these, and compile its player."""
    form = load_format("c-array")
    verdict = type("Verdict", (GreenVerdict,), {"demands": replace(MADE_UP, **{**DEMANDS[device], **demands})})
    files = pack([prepare(ICON, RIG, Device.load(device), form, gate=verdict)], form)
    assert set(files) == {"double_dip.h", "double_dip.json", "thermicon_player.h", "thermicon_serial.h"}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    shutil.copy(Path(__file__).with_name("player_main.c"), folder / "main.c")
    return compiled(folder, compiler, *flags, *BOARDS[device])


def compiled(folder: Path, compiler: str, *flags: str) -> Path:
    """The program of a folder that has drive, player and board."""
    program = folder / "player"
    subprocess.run([compiler, *CFLAGS, *flags, "main.c", "-o", str(program), "-lm"], cwd=folder, check=True)
    return program


def run(program: Path, world: int = 0, start: str = "held", **scenario: float) -> dict[str, Any]:
    """What became of a scenario; its names are those of `player_main.c`."""
    text = plate(world, start) + " ".join(f"{name} {value!r}" for name, value in scenario.items())
    words = subprocess.run([str(program)], input=text, capture_output=True, text=True, check=True).stdout.split()
    return {name: float(value) for name, value in zip(words[::2], words[1::2], strict=True)}


@cache
def plate(world: int, start: str) -> str:
    """A world of the rig at rest, as the board reads it: held at the baseline of the icon, or without power (`off`)."""
    rig = json.loads(RIG.document)
    follower = Follower(rig, np.random.default_rng(0), worlds=[worlds_of(rig)[world]])
    circuit, amperes = follower.circuit, follower.holding(32.0) if start == "held" else np.zeros(1)
    at_rest = follower._steady(amperes)[0]
    head = [float(circuit.alpha[0]), float(circuit.ohm[0]), float(circuit.gain[0])]
    beside = np.diagonal(circuit.matrix[0], 1)
    numbers = [*head, *circuit.capacity[0], *np.diagonal(circuit.matrix[0]), *beside, *circuit.heat[0], *at_rest]
    return f"{len(at_rest)} " + " ".join(map(repr, map(float, numbers))) + "\n"
