"""A study of the skin mesh: graded meshes or fixed elements against a mesh-converged solution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from thermicon.base.numbers.arrays import Array
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.rig.skin import CELL_GROWTH, FIRST_CELL_M, column_of
from thermicon.circuit.solver.batch_inputs import Bank, cut, run_follow, run_forward
from thermicon.circuit.solver.drive import Drive
from thermicon.circuit.solver.inverse import baseline_C, design, periods, target_at
from thermicon.circuit.solver.network import Network, network_on
from thermicon.circuit.solver.simulate import rows_until
from thermicon.circuit.solver.steady import holding_current_A, state_under_current
from thermicon.icons import Icon

WAYS = ("current", "temperature")
DEPTHS = ("cold_receptor_C", "warm_receptor_C")


@dataclass(frozen=True, slots=True)
class Mesh:
    """A division of skin into lumps: graded (cell at the surface m, growth per unit depth), or elements per layer."""

    name: str
    first_cell_m: float = FIRST_CELL_M
    growth: float = CELL_GROWTH
    elements: tuple[int, ...] | None = None


SHIPPED = Mesh("shipped")
CONVERGED = Mesh("converged", 5e-6, 0.02)
HALVED = Mesh("converged, halved", 2.5e-6, 0.01)
"""What meshes are compared with, and one twice as fine, which says how far that is from converged."""


def usual_meshes(rig: Rig) -> tuple[Mesh, ...]:
    """The shipped mesh, coarser and finer ones, and fixed elements: one for the outer layers, a few for the rest."""
    layers = len(rig.skin.layers)
    outer = max(1, layers - 3)
    fixed = [(1,) * outer + (few,) * (layers - outer) for few in (5, 10, 20)]
    return (
        SHIPPED,
        Mesh("twice as coarse", 2 * FIRST_CELL_M, 2 * CELL_GROWTH),
        Mesh("twice as fine", FIRST_CELL_M / 2, CELL_GROWTH / 2),
        *(Mesh(" + ".join(map(str, elements)) + " elements", elements=elements) for elements in fixed),
    )


@dataclass(frozen=True, slots=True)
class MeshStudy:
    """Errors of m meshes at both receptor depths; `error_K` (m, 2, rows), `reference_C` (2, rows): cold, then warm.

    `reference_error_K` is what halving the converged mesh changes.
    """

    stimulus: str
    way: str
    meshes: tuple[Mesh, ...]
    lumps: tuple[int, ...]
    time_s: Array
    reference_C: Array
    error_K: Array
    reference_error_K: float

    def part(self, mesh: int, at_s: float) -> tuple[float, float]:
        """Error of the change from the start at a time in s, in parts of that change: at cold and at warm depth."""
        row = int(np.searchsorted(self.time_s, at_s - 1e-9))
        so_far = self.reference_C[:, row] - self.reference_C[:, 0]
        cold, warm = np.abs((self.error_K[mesh, :, row] - self.error_K[mesh, :, 0]) / so_far).tolist()
        return cold, warm

    def to_frame(self) -> pd.DataFrame:
        """Largest errors of each mesh in K, and that at cold depth in parts of the change so far at 0.5 s and 4 s."""
        return pd.DataFrame(
            {
                "mesh": [mesh.name for mesh in self.meshes],
                "lumps": self.lumps,
                "cold_error_K": np.abs(self.error_K[:, 0]).max(axis=1),
                "warm_error_K": np.abs(self.error_K[:, 1]).max(axis=1),
                "cold_part_at_half_s": [self.part(k, 0.5)[0] for k in range(len(self.meshes))],
                "cold_part_at_4_s": [self.part(k, 4.0)[0] for k in range(len(self.meshes))],
            }
        )


def mesh_study(
    rig: Rig, cue: Icon | Drive, *, way: str = "current", meshes: Sequence[Mesh] | None = None, rate_Hz: float = 1000.0
) -> MeshStudy:
    """Simulate a cue or a drive on several meshes of a rig's skin, and compare them with a converged one.

    With `way` "current" all get the current designed on the rig as it is; with "temperature" each follows the cue
    with its own. At 1000 Hz rows and time steps do not affect the comparison.
    """
    if way not in WAYS:
        raise RigError(f"way {way!r} is not known; it is one of {', '.join(WAYS)}")
    prescribed = isinstance(cue, Icon) and cue.context.control != "current"
    if way == "temperature" and not prescribed:
        raise RigError("a drive prescribes no temperature to follow; compare meshes with way='current'")
    meshes = usual_meshes(rig) if meshes is None else tuple(meshes)
    networks = [_network(rig, mesh) for mesh in (*meshes, CONVERGED, HALVED)]
    played, rest_A, end_s = _currents(rig, cue)
    rows = rows_until(end_s, rate_Hz)
    runs = []
    for network in networks:
        if way == "current":
            drive, state = played, state_under_current(network, rest_A)
        else:
            drive, state = _led(rig, cue, network, end_s)
        bank, lane = Bank.of([network]), np.zeros(1, dtype=np.int64)
        intervals = cut(rows, drive.time_s, drive.current_A[np.newaxis], drive.held)
        runs.append(run_forward(bank, lane, lane, intervals, bank.states([state]), DEPTHS)[:, 0])
    reference = runs[-2]
    return MeshStudy(
        _name(cue),
        way,
        meshes,
        tuple(len(network.capacity_J_per_K) for network in networks[:-2]),
        rows,
        reference,
        np.array([run - reference for run in runs[:-2]]),
        float(np.abs(runs[-1] - reference).max()),
    )


def _name(cue: Icon | Drive) -> str:
    if isinstance(cue, Drive):
        return f"a drive of {cue.current_A.min():g} … {cue.current_A.max():g} A over {cue.time_s[-1]:g} s"
    return f"{cue.name} ({cue.context.control})"


def _network(rig: Rig, mesh: Mesh) -> Network:
    skin = replace(rig.skin, elements=mesh.elements)
    column = column_of(skin, rig.column.blood_capacity_J_per_m3K, mesh.first_cell_m, mesh.growth)
    deep = skin.deep_C
    if deep is None:
        loss = rig.ambient.film_W_per_m2K * (skin.rest_C - rig.ambient.temperature_C)
        deep = skin.rest_C - column.steady_drop_K(-loss)
    return network_on(rig, column, float(deep))


def _currents(rig: Rig, cue: Icon | Drive) -> tuple[Drive, float, float]:
    """The current that all meshes are played, what holds the steady state before it in A, and its end in s."""
    if isinstance(cue, Drive):
        return cue, float(cue.current_A[0]), float(cue.time_s[-1])
    start = baseline_C(cue, rig)
    if cue.context.control == "current":  # such a cue starts from the current that holds its baseline
        start = design(cue, rig, 0.0).rest_A
    end = float(cue.corners(start).duration_s)
    plan = design(cue, rig, end)
    return plan.drive, plan.rest_A, end


def _led(rig: Rig, cue: Icon | Drive, network: Network, end_s: float) -> tuple[Drive, Array]:
    """The current that leads one mesh along a cue, and where it starts."""
    assert isinstance(cue, Icon)
    control, base, ends = cue.context.control, baseline_C(cue, rig), periods(rig, end_s)
    state = state_under_current(network, holding_current_A(network, control, base))
    bank, lane = Bank.of([network]), np.zeros(1, dtype=np.int64)
    target = target_at(cue, base, ends)[np.newaxis]
    currents, _, _ = run_follow(
        bank, lane, lane, 1.0 / rig.driver.update_Hz, target, control == "skin", bank.states([state])
    )
    return Drive([0.0, *ends], [*currents[0], currents[0, -1]], held=True), state
