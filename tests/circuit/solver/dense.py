"""The circuit as one dense linear system under a constant current, assembled apart from the solver and solved exactly.

State: hot plate, legs from hot to cold, cold plate, skin lumps, then heat sink. Kelvin enter by 273.15 alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from thermicon.circuit import Drive, Rig
from thermicon.circuit.solver.network import network_of


@dataclass(frozen=True)
class Dense:
    """C·dx/dt = (A + I·B)·x + c + I·d + I²·e, with legs of `cells` cells."""

    capacity: np.ndarray
    matrix: np.ndarray
    pump: np.ndarray
    constant: np.ndarray
    per_A: np.ndarray
    per_A2: np.ndarray
    cold: int

    @staticmethod
    def of(rig: Rig, cells: int, leg_J_per_K: float) -> Dense:
        module, sink, skin = rig.module, rig.heat_sink, network_of(rig)
        lumps, cold = len(skin.capacity_J_per_K), cells + 1
        count = cold + lumps + 2
        capacity, matrix = np.full(count, 1e-9), np.zeros((count, count))
        pump, constant, per_A, per_A2 = np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(count)
        leak = 1.0 / module.thermal_resistance_K_per_W

        def join(one: int, other: int, conductance: float) -> None:
            matrix[one, [one, other]] += -conductance, conductance
            matrix[other, [other, one]] += -conductance, conductance

        capacity[[0, cold]] = module.hot_plate_J_per_K, module.cold_plate_J_per_K
        pump[[0, cold]] = module.seebeck_V_per_K, -module.seebeck_V_per_K
        per_A[:] = 273.15 * pump
        if cells:
            capacity[1:cold] = leg_J_per_K / cells
            per_A2[1:cold] = module.resistance_ohm / cells
            for cell in range(cold):
                join(cell, cell + 1, leak * cells * (2.0 if cell in (0, cold - 1) else 1.0))
        else:
            per_A2[[0, cold]] = module.resistance_ohm / 2
            join(0, cold, leak)
        capacity[cold + 1 : -1] = skin.capacity_J_per_K
        for lump in range(lumps):
            join(cold + lump, cold + lump + 1, float(skin.conductance_W_per_K[lump]))
            sides = float(skin.perfusion_W_per_K[lump]) + (
                float(skin.conductance_W_per_K[-1]) if lump == lumps - 1 else 0.0
            )
            matrix[cold + lump + 1, cold + lump + 1] -= sides
            constant[cold + lump + 1] += sides * skin.deep_C
        join(0, count - 1, 1.0 / sink.resistance_K_per_W)
        if sink.passive is None:
            capacity[-1] = 1e12
        else:
            capacity[-1] = sink.passive.capacity_J_per_K
            matrix[-1, -1] -= 1.0 / sink.passive.air_resistance_K_per_W
            constant[-1] = sink.passive.air_C / sink.passive.air_resistance_K_per_W
        return Dense(capacity, matrix, pump, constant, per_A, per_A2, cold)

    def under(self, amperes: float) -> tuple[np.ndarray, np.ndarray]:
        return self.matrix + np.diag(
            self.pump * amperes
        ), self.constant + self.per_A * amperes + self.per_A2 * amperes**2

    def rest(self, amperes: float, sink_C: float | None) -> np.ndarray:
        """Steady state with the heat sink at a temperature, or in balance with its air."""
        matrix, source = self.under(amperes)
        if sink_C is None:
            return np.linalg.solve(matrix, -source)
        inner = np.linalg.solve(matrix[:-1, :-1], -source[:-1] - matrix[:-1, -1] * sink_C)
        return np.append(inner, sink_C)

    def run(self, drive: Drive, sink_C: float | None, step_s: float) -> np.ndarray:
        """States (rows, nodes) every `step_s` of a held drive, whose rows are multiples of it, from rest."""
        state = self.rest(float(drive.current_A[0]), sink_C)
        states = [state]
        for begin, end, amperes in zip(drive.time_s[:-1], drive.time_s[1:], drive.current_A[:-1], strict=True):
            matrix, source = self.under(float(amperes))
            whole = np.zeros((len(state) + 1, len(state) + 1))
            whole[:-1, :-1], whole[:-1, -1] = matrix / self.capacity[:, np.newaxis], source / self.capacity
            moved = expm(whole * step_s)
            for _ in range(round((end - begin) / step_s)):
                state = moved[:-1, :-1] @ state + moved[:-1, -1]
                states.append(state)
        return np.array(states)
