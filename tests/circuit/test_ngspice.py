"""The same circuit in ngspice: an independent solver for the same physics."""

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, netlist, simulate_current
from thermicon.circuit.inverse import design
from thermicon.circuit.network import PROBES
from thermicon.icons import load_library

Tool = Callable[[str], str]
TEMPERATURES = [probe for probe in PROBES if probe.endswith("_C")]


def largest_difference(rig: Rig, drive: Drive, ngspice: str, folder: Path) -> float:
    """Largest difference in K between our trace and ngspice's over all temperature probes, at our rows."""
    out = folder / "out.txt"
    (folder / "rig.cir").write_text(netlist(rig, drive, out_file=out.name))
    run = subprocess.run([ngspice, "-b", "rig.cir"], cwd=folder, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stdout + run.stderr
    table = np.loadtxt(out)
    trace = simulate_current(drive, rig)
    return max(
        float(np.abs(np.interp(trace.time_s, table[:, 0], table[:, 1 + k]) - getattr(trace, probe)).max())
        for k, probe in enumerate(TEMPERATURES)
    )


CORNERS = Drive([0, 1, 2, 5, 9, 12, 20], [0.1, 0.1, 1.2, 1.2, -0.8, 0.3, 0.3])
JUMPS = Drive([0, 1, 1.5, 6, 9, 12, 20], [0.1, 0.5, 1.2, -0.9, -0.8, 0.3, 0.3], held=True)


@pytest.mark.parametrize("name", ["thenar", "shani2021"])
@pytest.mark.parametrize("drive", [CORNERS, JUMPS], ids=["corners", "jumps"])
def test_a_20_s_drive_agrees_within_2_mK(name: str, drive: Drive, tool: Tool, tmp_path: Path) -> None:
    assert largest_difference(Rig.load(name), drive, tool("ngspice"), tmp_path) < 2e-3


@pytest.mark.parametrize("name", ["thenar", "shani2021"])
def test_the_drive_of_a_skin_cue_agrees_within_2_mK(name: str, tool: Tool, tmp_path: Path) -> None:
    rig = Rig.load(name)
    drive = design(load_library("cooling-step-skin").icons[0], rig, 20.0).drive
    assert largest_difference(rig, drive, tool("ngspice"), tmp_path) < 2e-3
