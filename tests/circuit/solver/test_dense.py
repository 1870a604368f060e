"""The circuit against one dense linear system under a constant current, with or without a passive heat sink."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from thermicon.circuit import Drive, Rig, simulate, simulate_current, simulate_many
from thermicon.circuit.rig.corner import perturbed
from thermicon.circuit.solver.batch_inputs import Bank, Intervals, State, run_on
from thermicon.circuit.solver.network import RECORDED, network_of
from thermicon.circuit.solver.steady import state_under_current
from thermicon.icons import load_library

THENAR = Rig.load("thenar")
RIGS = [THENAR, Rig.load("shani2021")]
FAST = Drive([0, 1, 1.5, 6, 9, 12, 20], [0.1, 0.5, 1.2, -0.9, -0.8, 0.3, 0.3], held=True)
LEG_J_PER_K = 0.8
"""127 couples of 1.0 × 1.0 × 2.5 mm legs of bismuth telluride, 1.2e6 J/(m³·K)."""
FINE = 200
PASSIVE: dict[str, object] = {"capacity_J_per_K": 90.0, "air_resistance_K_per_W": 1.5}
WARM = THENAR.with_(heat_sink={**PASSIVE, "temperature_C": 28.0})
STEADY = THENAR.with_(heat_sink={**PASSIVE, "temperature_C": None})
THIN = {"skin.layer.muscle.thickness_mm": 4.0}
"""A column of fewer lumps."""


@dataclass(frozen=True)
class Dense:
    """C·dx/dt = (A + I·B)·x + c + I·d + I²·e, with legs of `cells` cells; kelvin enter by 273.15 alone.

    State: hot plate, legs from hot to cold, cold plate, skin lumps, then heat sink.
    """

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


def read(rig: Rig, states: np.ndarray, probe: str) -> np.ndarray:
    """A recorded quantity at exact states (rows, nodes), whose last node is the heat sink."""
    network = network_of(rig)
    return np.array([network.read(np.append(state[:-1], network.deep_C), probe) for state in states])


@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
def test_half_an_ampere_held_agrees_with_the_matrix_exponential(rig: Rig) -> None:
    # The drive jumps 0 → 0.5 A right after its first row.
    drive = Drive([0, 0.01, 300.01], [0.0, 0.5, 0.5], held=True)
    trace = simulate_current(drive, rig)
    exact = Dense.of(rig, 0, 0.0).run(drive, rig.heat_sink.temperature_C, 0.01)
    assert len(trace.time_s) == len(exact) == 30_002
    for probe in RECORDED[:5]:
        assert np.abs(getattr(trace, probe) - read(rig, exact, probe)).max() < 1e-4, probe


@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
@pytest.mark.parametrize("current", [-0.3, 0.0, 0.4])
def test_a_constant_current_stays_at_its_steady_state(rig: Rig, current: float) -> None:
    trace = simulate_current(Drive([0, 60], [current, current]), rig)
    steady = Dense.of(rig, 0, 0.0).rest(current, rig.heat_sink.temperature_C)
    for probe in RECORDED[:5]:
        assert np.abs(getattr(trace, probe) - read(rig, steady[np.newaxis], probe)).max() < 1e-6, probe


@pytest.mark.parametrize("rigs", [RIGS, [WARM, WARM.with_(**THIN)]], ids=["ideal sinks", "passive sinks"])
def test_a_step_is_the_trapezoidal_rule_of_the_whole_circuit(rigs: list[Rig]) -> None:
    # Intervals as short as these are one step each: in whatever coordinates, the rule is the same to its last digits.
    edges_s = np.append(0.0, np.cumsum(np.tile([0.25e-3, 0.2e-3, 0.1e-3, 0.1e-3], 100)))
    ends_A = np.random.default_rng(1).uniform(-2.0, 2.0, (2, len(edges_s) - 1, 2))
    networks, lanes = [network_of(rig) for rig in rigs], np.arange(2)
    bank = Bank.of(networks)
    begun = [np.append(30.0 + np.arange(network.nodes - 1) % 5, network.deep_C) for network in networks]
    intervals = Intervals(edges_s, np.arange(len(edges_s)), *ends_A)
    values, end = run_on(bank, lanes, lanes, intervals, State(bank.states(begun)))
    for lane, (rig, network, start) in enumerate(zip(rigs, networks, begun, strict=True)):
        dense = Dense.of(rig, 0, 0.0)
        states = [start[:-1] if network.passive else np.append(start[:-1], rig.heat_sink.temperature_C)]
        for half, begins, ends in zip(np.diff(edges_s) / 2, *ends_A[:, :, lane], strict=True):
            mean_A, store = (begins + ends) / 2, np.diag(dense.capacity / half)
            matrix, source = dense.under(mean_A)
            source += dense.per_A2 * (begins - ends) ** 2 / 12  # mean square less squared mean of a line
            states.append(2 * np.linalg.solve(store - matrix, store @ states[-1] + source) - states[-1])
        for row, probe in enumerate(RECORDED):
            close = 1e-9 if probe.endswith("_C") else 1e-5  # K, W/m²
            assert np.abs(values[row, lane] - read(rig, np.array(states), probe)).max() < close, probe
        inner = network.nodes - 1
        assert np.abs(end.nodes_C[lane, :inner] - states[-1][:inner]).max() < 1e-9
        assert end.nodes_C[lane, inner] == network.deep_C


@pytest.fixture(scope="module")
def field() -> np.ndarray:
    """Display in °C every 0.1 s of FAST, with the legs in 200 cells and exact steps in time."""
    fine = Dense.of(THENAR, FINE, LEG_J_PER_K)
    return fine.run(FAST, 40.0, 0.1)[:, fine.cold]


@pytest.mark.parametrize(("share", "least_K", "most_K"), [(0.0, 1.0, 1.2), (0.5, 0.8, 1.0)])
def test_what_legs_that_store_heat_would_change(share: float, least_K: float, most_K: float, field: np.ndarray) -> None:
    plates = {f"{side}_plate_J_per_K": getattr(THENAR.module, f"{side}_plate_J_per_K") for side in ("hot", "cold")}
    rig = THENAR.with_(module={key: value + share * LEG_J_PER_K for key, value in plates.items()})
    assert least_K < np.abs(simulate_current(FAST, rig, rate_Hz=10).display_C - field).max() < most_K


@pytest.mark.slow
def test_the_field_is_fine_enough(field: np.ndarray) -> None:
    coarser = Dense.of(THENAR, FINE // 2, LEG_J_PER_K)
    assert np.abs(coarser.run(FAST, 40.0, 0.1)[:, coarser.cold] - field).max() < 2e-4


@pytest.mark.slow
def test_columns_of_different_length_share_a_batch() -> None:
    icons, rigs = tuple(load_library("six-icons"))[:4], [WARM, WARM.with_(**THIN)]
    assert network_of(rigs[0]).nodes != network_of(rigs[1]).nodes
    together = simulate_many(icons, rigs, nominal=rigs[0], end_s=8.0, tracking="ideal")
    for place, rig in enumerate(rigs):
        for number, icon in enumerate(icons):
            alone = simulate(icon, rig)
            assert np.abs(together["skin_C"][place, number] - alone.skin_C).max() < 2e-5


@pytest.mark.slow
@pytest.mark.parametrize(("rig", "start_C"), [(WARM, 28.0), (STEADY, None)], ids=["warm", "steady"])
def test_a_drive_is_the_exact_solution(rig: Rig, start_C: float | None) -> None:
    trace, exact = simulate_current(FAST, rig, rate_Hz=10), Dense.of(rig, 0, 0.0)
    states = exact.run(FAST, start_C, 0.1)
    assert np.abs(trace.display_C - states[:, exact.cold]).max() < 1e-4
    assert np.abs(trace.hot_plate_C - states[:, 0]).max() < 2e-4


def test_a_sink_alone_cools_exponentially() -> None:
    # A module that conducts nothing and no current: the sink has only its air and the hot plate, which follows it.
    rig = THENAR.with_(
        module={"thermal_resistance_K_per_W": 1e9, "hot_plate_J_per_K": 1e-6},
        heat_sink={"capacity_J_per_K": 30.0, "air_resistance_K_per_W": 2.0, "temperature_C": 50.0, "air_C": 20.0},
    )
    trace = simulate_current(Drive([0, 120], [0.0, 0.0]), rig, rate_Hz=10)
    exact = 20.0 + 30.0 * np.exp(-trace.time_s / 60.0)
    assert np.abs(trace.hot_plate_C - exact).max() < 1e-3


def test_in_the_end_the_sink_is_in_balance_with_its_air() -> None:
    network = network_of(WARM)
    begun, end = state_under_current(network, 0.5), state_under_current(network, 0.5, in_the_end=True)
    assert begun[-2] == pytest.approx(28.0)
    late = simulate_current(Drive([0, 3600], [0.5, 0.5]), WARM, rate_Hz=0.1)
    assert late.hot_plate_C[-1] == pytest.approx(end[0], abs=1e-3)
    assert end[-2] > 29.0


def test_its_air_is_the_rooms_unless_it_is_given() -> None:
    assert WARM.heat_sink.passive.air_C == 24.0
    warmer = perturbed(WARM, ambient_K=3.0, heat_sink_K=1.0)
    assert (warmer.heat_sink.passive.air_C, warmer.heat_sink.temperature_C) == (25.0, 29.0)
    only_room = perturbed(STEADY, ambient_K=3.0)
    assert math.isclose(only_room.heat_sink.passive.air_C, 24.0)


def test_what_stores_heat_survives_a_file(tmp_path: Path) -> None:
    for rig in (STEADY, WARM):
        rig.save(tmp_path / "stores.toml")
        assert Rig.load(tmp_path / "stores.toml").heat_sink == rig.heat_sink
