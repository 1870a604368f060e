"""Module and skin as subcircuits: in ngspice they are the circuit of the netlist, with any parameter."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, netlist
from thermicon.circuit.delivery.netlist_landing import points
from thermicon.circuit.delivery.subcircuit import subcircuits
from thermicon.circuit.rig.rigfile import RigError

Tool = Callable[[str], str]
DRIVE = Drive([0, 1, 2, 5, 9, 12], [0.1, 0.1, 1.2, 1.2, -0.8, 0.3])
NODES = ("hot", "cold", "skin", "cold_receptor", "warm_receptor")
WITHIN_K = 1e-3


def bench(rig: Rig, library: str, *, skin: str = "", module: str = "") -> str:
    """A schematic that uses the library: a current source, the module on an ideal heat sink, the skin."""
    command = " ".join(f"{time!r} {current!r}" for time, current in points(DRIVE, None))
    return (
        f"* bench\n{library}\nIdrive 0 plus PWL({command})\n"
        f"Xmodule plus 0 hot cold thermicon_module {module}\n"
        f"Rsink sink hot {rig.heat_sink.resistance_K_per_W!r}\nVsink sink 0 {rig.heat_sink.temperature_C!r}\n"
        f"Xskin cold skin cold_receptor warm_receptor thermicon_skin {skin}\n"
        ".options reltol=1e-6 abstol=1e-12 vntol=1e-9\n.tran 0.01 12 0 0.0025\n.control\nset wr_singlescale\n"
        f"set numdgt=15\nrun\nwrdata out.txt v(plus) {' '.join(f'v({node})' for node in NODES)}\nquit 0\n.endc\n.end\n"
    )


def run(text: str, ngspice: str, folder: Path) -> np.ndarray:
    folder.mkdir(exist_ok=True)
    (folder / "a.cir").write_text(text, encoding="ascii")
    run = subprocess.run([ngspice, "-b", "a.cir"], cwd=folder, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stdout + run.stderr
    return np.loadtxt(folder / "out.txt", skiprows=1 if "wr_vecnames" in text else 0)


def plain(rig: Rig, ngspice: str, folder: Path) -> np.ndarray:
    """Time, voltage and temperatures of the netlist as it always was."""
    table = run(netlist(rig, DRIVE, out_file="out.txt"), ngspice, folder)
    return table[:, [0, 2, 3, 4, 5, 6, 7]]


def apart_K(ours: np.ndarray, theirs: np.ndarray, columns: range = range(2, 7)) -> float:
    times = np.linspace(0.0, 12.0, 1201)
    return max(
        float(np.abs(np.interp(times, ours[:, 0], ours[:, k]) - np.interp(times, theirs[:, 0], theirs[:, k])).max())
        for k in columns
    )


def apart_V(ours: np.ndarray, theirs: np.ndarray) -> float:
    times = np.linspace(0.0, 12.0, 1201)
    return float(np.abs(np.interp(times, ours[:, 0], ours[:, 1]) - np.interp(times, theirs[:, 0], theirs[:, 1])).max())


LEGS = {"module.leg_nodes": 3, "module.leg_capacity_J_per_K": 0.8}


@pytest.mark.parametrize(("name", "keys"), [("thenar", {}), ("shani2021", {}), ("thenar", LEGS)])
def test_it_is_the_circuit_of_the_netlist(name: str, keys: dict[str, float], tool: Tool, tmp_path: Path) -> None:
    rig = Rig.load(name).with_(**keys)
    table = run(bench(rig, subcircuits(rig)), tool("ngspice"), tmp_path / "own")
    theirs = plain(rig, tool("ngspice"), tmp_path / "plain")
    assert apart_K(table, theirs) < WITHIN_K
    assert apart_V(table, theirs) < WITHIN_K


@pytest.mark.parametrize(
    ("keys", "skin", "module"),
    [
        ({"contact.area_cm2": 4.0, "contact.resistance_m2K_per_W": 1e-3}, "area_cm2=4 contact_m2K_per_W=1e-3", ""),
        ({"module.resistance_ohm": 5.0, "module.cold_plate_J_per_K": 4.0}, "", "resistance_ohm=5 cold_plate_J_per_K=4"),
        ({"skin.layer.2.conductivity_W_per_mK": 0.3}, "conductivity3_W_per_mK=0.3", ""),
        ({"skin.layer.2.perfusion_per_s": 0.004}, "perfusion3_W_per_m3K={perfused}", ""),
    ],
    ids=["contact", "module", "conductivity", "perfusion"],
)
def test_a_parameter_is_the_key_of_the_rig(
    keys: dict[str, float], skin: str, module: str, tool: Tool, tmp_path: Path
) -> None:
    rig = Rig.load("thenar")
    other = rig.with_(**keys)
    perfused = 0.004 * rig.column.blood_capacity_J_per_m3K
    skin = f"{skin} blood_C={other.deep_C!r}".replace("{perfused}", repr(perfused))
    table = run(bench(other, subcircuits(rig), skin=skin, module=module), tool("ngspice"), tmp_path / "own")
    theirs = plain(other, tool("ngspice"), tmp_path / "plain")
    assert apart_K(table, theirs) < WITHIN_K
    assert apart_K(run(bench(rig, subcircuits(rig)), tool("ngspice"), tmp_path / "as"), theirs) > 0.02  # it mattered


@pytest.mark.parametrize(("layer", "thickness_mm", "columns"), [(2, 0.8, range(2, 5)), (0, 0.25, range(2, 7))])
def test_another_thickness_differs_by_the_mesh_alone(
    layer: int, thickness_mm: float, columns: range, tool: Tool, tmp_path: Path
) -> None:
    """A rig has other cells then; a subcircuit scales its own, and with them a receptor that lies in that layer."""
    rig = Rig.load("thenar")
    other = rig.with_(**{f"skin.layer.{layer}.thickness_mm": thickness_mm})
    skin = f"thickness{layer + 1}_mm={thickness_mm} blood_C={other.deep_C!r}"
    table = run(bench(other, subcircuits(rig), skin=skin), tool("ngspice"), tmp_path / "own")
    theirs = plain(other, tool("ngspice"), tmp_path / "plain")
    assert apart_K(table, theirs, columns) < 5e-3


def test_every_parameter_of_a_layer_is_used_and_only_ascii_is_written() -> None:
    text = subcircuits(Rig.load("thenar"))
    assert text.isascii()
    for name in re.findall(r"^\+ (\w+)=", text, flags=re.MULTILINE):
        assert len(re.findall(rf"\b{name}\b", text.partition("\n*\n")[2])) > 1, name


def test_a_thermode_has_no_circuit() -> None:
    with pytest.raises(RigError, match="thermode"):
        subcircuits(Rig.load("tcs2"))


def test_the_schematic_of_the_page_runs(tool: Tool, tmp_path: Path) -> None:
    """What docs/how-to/netlist.md shows: a light touch leaves the skin warmer than a firm one."""
    page = Path(__file__).resolve().parents[3] / "docs" / "how-to" / "netlist.md"
    shown = re.search(r"```\n(\* The display under.*?\n\.end\n)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert shown is not None
    (tmp_path / "thenar.lib").write_text(subcircuits(Rig.load("thenar")), encoding="ascii")
    control = ".control\nset wr_singlescale\nrun\nwrdata out.txt v(skin_light) v(skin_firm)\nquit 0\n.endc\n.end\n"
    table = run(shown[1].replace(".end\n", control), tool("ngspice"), tmp_path)
    assert table[-1, 1] > table[-1, 2] + 0.5
