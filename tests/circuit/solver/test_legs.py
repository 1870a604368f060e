"""Legs that store heat: against a fine field of the legs, exact in time, and the same on every path of the solver."""

from __future__ import annotations

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, simulate, simulate_current, simulate_many
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons import load_library

from .dense import Dense

THENAR = Rig.load("thenar")
LEG_J_PER_K = 0.8
"""127 couples of 1.0 × 1.0 × 2.5 mm legs of bismuth telluride, 1.2e6 J/(m³·K)."""
FINE = 200
FAST = Drive([0, 1, 1.5, 6, 9, 12, 20], [0.1, 0.5, 1.2, -0.9, -0.8, 0.3, 0.3], held=True)
SLOW = Drive([0, 1, 2, 5, 9, 12, 20], [0.1, 0.15, 0.3, 0.5, 0.4, 0.1, 0.1], held=True)


def legs(nodes: int, rig: Rig = THENAR) -> Rig:
    return rig.with_(module={"leg_nodes": nodes, "leg_capacity_J_per_K": LEG_J_PER_K})


@pytest.fixture(scope="module")
def field() -> np.ndarray:
    """Display in °C every 0.1 s of FAST, with the legs in 200 cells and exact steps in time."""
    fine = Dense.of(THENAR, FINE, LEG_J_PER_K)
    return fine.run(FAST, 40.0, 0.1)[:, fine.cold]


@pytest.mark.parametrize("nodes", [1, 3, 5])
def test_the_kernel_solves_the_same_cells_exactly(nodes: int) -> None:
    trace = simulate_current(FAST, legs(nodes), rate_Hz=10)
    exact = Dense.of(THENAR, nodes, LEG_J_PER_K)
    states = exact.run(FAST, 40.0, 0.1)
    assert np.abs(trace.display_C - states[:, exact.cold]).max() < 1e-4
    assert np.abs(trace.hot_plate_C - states[:, 0]).max() < 2e-4
    assert np.abs(trace.skin_C - states[:, exact.cold + 1]).max() < 2e-4


@pytest.mark.parametrize(
    ("nodes", "least_K", "most_K"), [(0, 1.0, 1.2), (1, 1.0, 1.2), (3, 0.1, 0.15), (5, 0.04, 0.06)]
)
def test_nodes_bring_the_display_to_the_field_of_the_legs(
    nodes: int, least_K: float, most_K: float, field: np.ndarray
) -> None:
    rig = legs(nodes) if nodes else THENAR
    miss = np.abs(simulate_current(FAST, rig, rate_Hz=10).display_C - field).max()
    assert least_K < miss < most_K


@pytest.mark.slow
def test_the_field_is_fine_enough(field: np.ndarray) -> None:
    coarser = Dense.of(THENAR, FINE // 2, LEG_J_PER_K)
    assert np.abs(coarser.run(FAST, 40.0, 0.1)[:, coarser.cold] - field).max() < 2e-4


def test_nodes_do_not_change_what_is_steady() -> None:
    for level in (25.0, 32.0, 36.0):
        plain, with_legs = (steady_state(rig, "skin", level) for rig in (THENAR, legs(4)))
        assert with_legs[0] == pytest.approx(plain[0], abs=1e-12)
        assert with_legs[1][:10] == pytest.approx(plain[1][:10], abs=1e-9)
    current, state = steady_state(legs(4), "skin", 25.0)
    exact = Dense.of(THENAR, 4, LEG_J_PER_K)
    cells = state[-5:-1]
    assert cells == pytest.approx(exact.rest(current, 40.0)[1:5], abs=1e-6)


@pytest.mark.slow
def test_columns_of_different_length_share_a_batch() -> None:
    icons, thin = tuple(load_library("six-icons"))[:4], {"skin.layer.muscle.thickness_mm": 4.0}
    rigs = [legs(3), legs(3).with_(**thin)]
    assert network_of(rigs[0]).nodes != network_of(rigs[1]).nodes
    together = simulate_many(icons, rigs, nominal=rigs[0], end_s=8.0, tracking="ideal")
    for place, rig in enumerate(rigs):
        for number, icon in enumerate(icons):
            alone = simulate(icon, rig)
            assert np.abs(together["skin_C"][place, number] - alone.skin_C).max() < 2e-5
