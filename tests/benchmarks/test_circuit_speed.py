"""Speed of the circuit as a ratio to ngspice or scipy on the same simulation.

Run with `pytest -m benchmark tests/benchmarks -s`. Each ratio comes with the error of both against a tight reference.
"""

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from tests.benchmarks.peers import CORNERS, best_of, ngspice_command, plain, run_ngspice, scipy_run
from thermicon.circuit import Drive, Rig, fit, netlist, simulate_current
from thermicon.circuit.fitting.synthetic_log import synthetic_log
from thermicon.circuit.solver.batch_inputs import Bank, cut, run_forward
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current

pytestmark = pytest.mark.benchmark
Tool = Callable[[str], str]
ROWS = np.arange(3001) / 100
PROBES = ("skin_C", "cold_receptor_C", "warm_receptor_C")
FITTED = {"contact.resistance_m2K_per_W": 7e-4, "module.seebeck_V_per_K": 0.0505, "module.resistance_ohm": 6.6}
MOST_FIT_S = 2.0
RIGS = {"shani2021": Rig.load("shani2021"), "thenar": Rig.load("thenar")}


def ngspice_run(ngspice: str, folder: Path, texts: list[str]) -> float:
    """Least wall time in s of one ngspice process that runs all the circuits."""
    command = ngspice_command(ngspice, folder, texts)
    return best_of(lambda: run_ngspice(command, folder), 5 if len(texts) == 1 else 2)


def tight(rig: Rig, drive: Drive) -> dict[str, np.ndarray]:
    """The reference: steps of 1 ms."""
    fine = simulate_current(drive, rig, rate_Hz=1000)
    return {probe: getattr(fine, probe)[::10] for probe in PROBES}


def ngspice_error(ngspice: str, folder: Path, rig: Rig, reference: dict[str, np.ndarray]) -> float:
    text = netlist(rig, CORNERS, out_file="out.txt").replace("reltol=1e-06 abstol=1e-12 vntol=1e-9", "reltol=0.001")
    text = "\n".join(".tran 10m 30 0 10m" if line.startswith(".tran") else line for line in text.splitlines())
    (folder / "error.cir").write_text(text)
    subprocess.run([ngspice, "-b", "error.cir"], cwd=folder, capture_output=True, check=True, timeout=60)
    with (folder / "out.txt").open() as file:
        names = [name.lower() for name in file.readline().split()]
        table = np.loadtxt(file)
    return max(
        float(np.abs(np.interp(ROWS, table[:, 0], table[:, names.index(f"v({probe.lower()})")]) - values).max())
        for probe, values in reference.items()
    )


@pytest.mark.parametrize("name", RIGS)
def test_one_cue(name: str, tool: Tool, tmp_path: Path, benchmark: BenchmarkFixture) -> None:
    rig = RIGS[name]
    trace = simulate_current(CORNERS, rig)
    reference = tight(rig, CORNERS)
    ours = max(float(np.abs(getattr(trace, probe) - values).max()) for probe, values in reference.items())
    theirs = ngspice_error(tool("ngspice"), tmp_path, rig, reference)
    process = ngspice_run(tool("ngspice"), tmp_path, [plain(netlist(rig, CORNERS))])
    benchmark(simulate_current, CORNERS, rig)
    cue = float(benchmark.stats.stats.min)
    bank, one = Bank.of([network_of(rig)]), np.zeros(1, dtype=np.int64)
    intervals = cut(ROWS, CORNERS.time_s, CORNERS.current_A[None], held=False)
    start = bank.states([state_under_current(network_of(rig), 0.1)])
    kernel = best_of(lambda: run_forward(bank, one, one, intervals, start.copy()), 30)
    print(f"\n{name}: the compiled run alone {kernel * 1e3:.2f} ms: {process / kernel:.0f} times an ngspice process")
    benchmark.extra_info.update(nodes=len(network_of(rig).capacity_J_per_K) + 3, ratio=process / cue)
    said = f"ours {cue * 1e3:.2f} ms (error {ours * 1e3:.3f} mK), "
    said += f"ngspice process {process * 1e3:.1f} ms (error {theirs * 1e3:.3f} mK): {process / cue:.0f} times"
    print(f"\n{name}: {len(network_of(rig).capacity_J_per_K) + 3} nodes, 30 s: {said}")
    assert ours <= theirs


def test_one_cue_by_scipy(benchmark: BenchmarkFixture) -> None:
    theirs = benchmark.pedantic(scipy_run, args=(RIGS["thenar"],), rounds=5, warmup_rounds=1)
    ours = simulate_current(CORNERS, RIGS["thenar"])
    assert np.abs(theirs[1] - ours.display_C).max() < 0.05
    assert np.abs(theirs[0] - ours.hot_plate_C).max() < 0.05


@pytest.mark.parametrize("name", RIGS)
def test_a_batch_of_64_with_a_rig_per_lane(name: str, tool: Tool, tmp_path: Path, benchmark: BenchmarkFixture) -> None:
    rigs = [RIGS[name].with_(**{"contact.area_cm2": 8 + k / 32}) for k in range(64)]
    bank = Bank.of([network_of(rig) for rig in rigs])
    scale = 1 + np.arange(64) / 640
    intervals = cut(ROWS, CORNERS.time_s, CORNERS.current_A * scale[:, None], held=False)
    lanes = np.arange(64)
    start = bank.states([state_under_current(network_of(rig), 0.1 * by) for rig, by in zip(rigs, scale, strict=True)])
    benchmark(lambda: run_forward(bank, lanes, lanes, intervals, start.copy(), PROBES))
    cue = float(benchmark.stats.stats.min) / 64
    process = ngspice_run(tool("ngspice"), tmp_path, [plain(netlist(RIGS[name], CORNERS))])
    drives = [Drive(CORNERS.time_s, CORNERS.current_A * by) for by in scale]
    many = ngspice_run(
        tool("ngspice"), tmp_path, [plain(netlist(rig, drive)) for rig, drive in zip(rigs, drives, strict=True)]
    )
    benchmark.extra_info.update(ratio_process=process / cue, ratio_one_process=many / 64 / cue)
    print(
        f"\n{name}: batch of 64, per cue {cue * 1e3:.3f} ms: {process / cue:.0f} times an ngspice process, "
        f"{many / 64 / cue:.0f} times a cue in one ngspice process of 64 ({many / 64 * 1e3:.1f} ms)"
    )


def test_a_fit_of_three_parameters_takes_less_than_two_seconds(benchmark: BenchmarkFixture) -> None:
    log, rig = synthetic_log(RIGS["thenar"].with_(**FITTED), seed=1), RIGS["thenar"]
    found = benchmark.pedantic(fit, (log, rig), {"free": list(FITTED), "fixed_skin": True}, rounds=3, warmup_rounds=1)
    assert all(abs(found[key].value / value - 1) < 0.02 for key, value in FITTED.items())
    assert benchmark.stats.stats.min < MOST_FIT_S
