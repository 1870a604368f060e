"""The same circuit in other programs: ngspice with one process per cue or for many, solve_ivp of scipy."""

import subprocess
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Drive, Rig
from thermicon.circuit.rig.module import ZERO_C_IN_K
from thermicon.circuit.solver.network import COLD, HOT, SKIN, network_of
from thermicon.circuit.solver.steady import state_under_current

END_S, RATE_HZ = 30.0, 100
CORNERS = Drive([0, 2, 4, 8, 10, 30], [0.1, 1.1, 0.3, 0.4, -0.5, 0.1])
"""Half a minute of ramps of the current, which every program simulates."""
RTOL = 1e-4
"""Relative tolerance of solve_ivp, with which its skin is within some millikelvin, as that of ngspice is by default."""


def best_of(run: Callable[[], object], times: int = 3) -> float:
    """Least wall time in s of some runs: what the machine can do when nothing else disturbs it."""
    found = []
    for _ in range(times):
        start = time.perf_counter()
        run()
        found.append(time.perf_counter() - start)
    return min(found)


def plain(text: str) -> str:
    """The circuit at ngspice's own default tolerance and step, with nothing written."""
    lines = [line for line in text.splitlines() if not line.startswith((".options", ".tran"))]
    end = lines.index(".end")
    return "\n".join([*lines[:end], f".tran 10m {END_S:g} 0 10m", ".end", ""])


def ngspice_command(program: str, folder: Path, texts: Sequence[str]) -> list[str]:
    """Write circuits to a folder and return the command of one ngspice process that runs all of them."""
    if len(texts) == 1:
        text = texts[0].replace(".end\n", ".control\nrun\nquit 0\n.endc\n.end\n")
        (folder / "c0.cir").write_text(text, encoding="utf-8")
        return [program, "-b", "c0.cir"]
    for k, text in enumerate(texts):
        (folder / f"c{k}.cir").write_text(text, encoding="utf-8")
    script = "\n".join(f"source c{k}.cir\nrun\ndestroy all\nremcirc" for k in range(len(texts)))
    (folder / "all.sp").write_text(f"* all\n.control\n{script}\nquit 0\n.endc\n.end\n", encoding="utf-8")
    return [program, "-b", "all.sp"]


def run_ngspice(command: Sequence[str], folder: Path) -> None:
    """Run a command of ngspice in its folder; raises RuntimeError with its last words where it fails."""
    ended = subprocess.run(list(command), cwd=folder, capture_output=True, text=True, timeout=600)
    if ended.returncode:
        raise RuntimeError(f"ngspice ended with {ended.returncode}: {(ended.stdout + ended.stderr).strip()[-300:]}")


def scipy_run(rig: Rig, drive: Drive = CORNERS) -> Array:
    """Temperatures (nodes, rows) in °C of hot plate, cold plate and lumps by solve_ivp, the band of the matrix given.

    The equations are those of the circuit: heat pumped αI·T, Joule heat I²R/2 in either plate, conduction, blood.
    """
    from scipy.integrate import solve_ivp
    from scipy.sparse import diags

    network = network_of(rig)
    module, sink, deep = rig.module, rig.heat_sink, network.deep_C
    g, blood, store = network.conductance_W_per_K, network.perfusion_W_per_K, network.capacity_J_per_K
    alpha, half_ohm = module.seebeck_V_per_K, 0.5 * module.resistance_ohm

    def slope(time_s: float, state: Array) -> Array:
        amperes = np.interp(time_s, drive.time_s, drive.current_A)
        hot, cold, lumps = state[HOT], state[COLD], state[SKIN:]
        into = g * -np.diff(np.concatenate([[cold], lumps, [deep]]))
        across, joule = (hot - cold) / module.thermal_resistance_K_per_W, half_ohm * amperes**2
        change = np.empty_like(state)
        out = (hot - sink.temperature_C) / sink.resistance_K_per_W
        change[HOT] = (alpha * amperes * (hot + ZERO_C_IN_K) + joule - across - out) / module.hot_plate_J_per_K
        change[COLD] = (-alpha * amperes * (cold + ZERO_C_IN_K) + joule + across - into[0]) / module.cold_plate_J_per_K
        change[SKIN:] = (into[:-1] - into[1:] + blood * (deep - lumps)) / store
        return change

    start = state_under_current(network, float(drive.current_A[0]))[:-1]
    band = diags([1.0, 1.0, 1.0], [-1, 0, 1], shape=(len(start), len(start)))
    rows = np.linspace(0.0, END_S, round(END_S * RATE_HZ) + 1)
    # Steps no longer than the shortest piece of the drive: a longer one could pass over a corner unseen.
    found = solve_ivp(
        slope, (0.0, END_S), start, method="BDF", t_eval=rows, rtol=RTOL, atol=RTOL, jac_sparsity=band, max_step=1.0
    )
    return np.asarray(found.y)
