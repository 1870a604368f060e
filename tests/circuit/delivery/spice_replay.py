"""One world of the independent circuit as a netlist for ngspice."""

import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.circuit.delivery.independent import KELVIN, Array, Circuit
from tests.circuit.delivery.replay import Held

FLANK_S, STEP_S, AFTER_S = 1e-6, 2.5e-3, 5.0


def lines_of(circuit: Circuit, world: int, held: Held) -> Iterator[str]:
    """The netlist: nodes n0 (hot plate), n1 (display), n2 … (skin); 1 V is 1 °C, 1 A is 1 W. Zero current follows."""
    matrix, heat, gain = circuit.matrix[world], circuit.heat[world], circuit.gain[world]
    count = len(matrix)
    yield "independent circuit"
    corners, time, before = [], 0.0, float(held.mean_A[0])
    for length, ampere in zip([*held.length_s, AFTER_S], [*held.mean_A, 0.0], strict=True):
        if length < 4 * FLANK_S:  # the end of a source in SPICE's own format, 1 µs behind the last row
            continue
        corners += [(max(0.0, time - FLANK_S / 2), before), (time + FLANK_S / 2, float(ampere))]
        time, before = time + float(length), float(ampere)
    yield "Vampere ampere 0 PWL("
    yield from (f"+ {at!r} {float(gain * ampere)!r}" for at, ampere in [*corners, (time, before)])
    yield "+ )"
    alpha, ohm = float(circuit.alpha[world]), float(circuit.ohm[world])
    for node, sign in ((0, "+"), (1, "-")):
        pumped = f"{alpha!r}*(V(n{node})+{KELVIN!r})*V(ampere)"
        yield f"Bpump{node} 0 n{node} I={sign}{pumped}+{0.5 * ohm!r}*V(ampere)*V(ampere)"
    for i in range(count):
        yield f"C{i} n{i} 0 {float(circuit.capacity[world, i])!r}"
        yield f"I{i} 0 n{i} {float(heat[i])!r}"
        left = float(matrix[i].sum())
        if abs(left) > 1e-9:
            yield f"G{i} n{i} 0 n{i} 0 {left!r}"
        yield from (f"R{i}_{j} n{i} n{j} {-1 / float(matrix[i, j])!r}" for j in range(i + 1, count) if matrix[i, j])
    yield ".options reltol=1e-6 abstol=1e-12 vntol=1e-9"
    yield f".tran {STEP_S!r} {time!r} 0 {STEP_S!r}"
    yield from (".control", "set wr_singlescale", "set numdgt=15", "run")
    yield f"wrdata out.txt {' '.join(f'v(n{i})' for i in range(count))}"
    yield from ("quit 0", ".endc", ".end")


def by_ngspice(ngspice: str, circuit: Circuit, world: int, held: Held, folder: Path) -> tuple[Array, Array]:
    """Times in s and watched temperatures (rows, 4) of one play and 5 s of zero current."""
    (folder / "own.cir").write_text("\n".join(lines_of(circuit, world, held)) + "\n", encoding="ascii")
    run = subprocess.run(
        [ngspice, "-b", "own.cir"], cwd=folder, capture_output=True, text=True, timeout=300, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
    table = np.loadtxt(folder / "out.txt")
    return table[:, 0], table[:, 1:] @ circuit.watch[world].T + circuit.offset[world]
