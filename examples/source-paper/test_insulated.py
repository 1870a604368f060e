"""A probe on insulated skin against a finer field in depth and radius from an independent solver."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import splu

from source_paper.insulated import Pad
from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Drive, Rig, Trace, simulate, simulate_current
from thermicon.icons import load_library

THENAR = Rig.load("thenar")
STEP = load_library("six-icons")["cooling-step"]
PAD = 2e-3 / 0.015


def under(
    trace: Trace, radius_mm: float, lateral_mm: float | None = None, depth_m: float = 0.0, pad: float = PAD
) -> Array:
    lateral = radius_mm if lateral_mm is None else lateral_mm
    return Pad(lateral * 1e-3, 2e-3 * radius_mm, depth_m, pad).reads(trace, THENAR)


def along(rig: Rig, faces_m: np.ndarray) -> np.ndarray:
    """Conductivity times height in W/K between depths."""
    fine = np.linspace(0.0, rig.skin.thickness_m, 200_001)
    middle, k, top = (fine[1:] + fine[:-1]) / 2, np.zeros(200_000), 0.0
    for layer in rig.skin.layers:
        k[(middle >= top) & (middle < top + layer.thickness_m)] = layer.conductivity_W_per_mK
        top += layer.thickness_m
    return np.diff(np.interp(faces_m, fine, np.concatenate([[0.0], np.cumsum(k * np.diff(fine))])))


def field(rig: Rig, radius_m: float, reading_m: float, display_C: np.ndarray, step_s: float) -> np.ndarray:
    """Face of the skin in °C at a radius: uniform rings of 1/20 of the pad, the rig's own lumps, Crank–Nicolson."""
    column, ring = rig.column, radius_m / 20
    count = 20 + round(max(2 * radius_m, 6e-3) / ring)
    faces = np.arange(count + 1) * ring
    area, lumps = np.pi * np.diff(faces**2), len(column.depth_m)
    middles = np.concatenate([[0.0], (column.depth_m[1:] + column.depth_m[:-1]) / 2])
    sideways = along(rig, np.append(middles, (column.depth_m[-1] + rig.skin.thickness_m) / 2))
    at = np.arange(lumps * count).reshape(lumps, count)
    rows, columns, values = [], [], []

    def add(one: np.ndarray, other: np.ndarray, value: np.ndarray) -> None:
        rows.append(one.ravel())
        columns.append(other.ravel())
        values.append(np.broadcast_to(value, one.shape).ravel())

    def join(one: np.ndarray, other: np.ndarray, value: np.ndarray) -> None:
        for a, b, sign in ((one, one, 1), (other, other, 1), (one, other, -1), (other, one, -1)):
            add(a, b, sign * value)

    join(at[:-1], at[1:], area / column.resistance_m2K_per_W[1:-1, np.newaxis])
    join(at[:, :-1], at[:, 1:], sideways[:, np.newaxis] * 2 * np.pi * faces[1:-1] / ring)
    sink = column.perfusion_W_per_m2K[:, np.newaxis] * area
    sink[-1] += area / column.resistance_m2K_per_W[-1]
    add(at, at, sink)
    top = area / np.where(np.arange(count) < 20, PAD, rig.contact.resistance_m2K_per_W)
    add(at[0], at[0], top)
    size = lumps * count
    matrix = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (size, size)).tocsc()
    source, drive = np.zeros(size), np.zeros(size)
    source[at.ravel()] = sink.ravel() * rig.deep_C
    drive[at[0]] = top
    store = (column.capacity_J_per_m2K[:, np.newaxis] * area).ravel() * 2 / step_s
    state = splu(matrix).solve(source + drive * display_C[0])
    solve = splu((diags(store) + matrix).tocsc()).solve
    seen = [state]
    for level in 0.5 * (display_C[1:] + display_C[:-1]):
        state = 2 * solve(store * state + source + drive * level) - state
        seen.append(state)
    centre = (faces[1:] + faces[:-1]) / 2
    return np.array([np.interp(reading_m, centre, state[at[0]]) for state in seen])


@pytest.mark.parametrize(("radius_mm", "lateral_mm"), [(2.5, 2.5), (2.5, 1.0), (5.0, 5.0)])
def test_the_probe_is_the_field_of_a_round_patch(radius_mm: float, lateral_mm: float) -> None:
    trace = simulate(STEP, THENAR, tail_s=4.0)
    exact = field(THENAR, radius_mm * 1e-3, (radius_mm - lateral_mm) * 1e-3, trace.display_C[::8], 0.08)
    read = under(trace, radius_mm, lateral_mm)[::8]
    swing = float(np.ptp(exact))
    assert swing > 0.08
    assert np.abs(read - exact).max() < 0.04 * max(swing, 0.5)
    assert np.ptp(read) == pytest.approx(swing, rel=0.04)


@pytest.mark.slow
@pytest.mark.parametrize("radius_mm", [1.0, 2.0, 4.0])
def test_other_patches_and_a_slow_drive(radius_mm: float) -> None:
    drive = Drive([0, 5, 30, 60], [0.08, 0.5, 0.5, 0.08])
    trace = simulate_current(drive, THENAR)
    exact = field(THENAR, radius_mm * 1e-3, 0.0, trace.display_C[::4], 0.04)
    assert np.abs(under(trace, radius_mm)[::4] - exact).max() < 0.02 * np.ptp(exact)


def test_a_tiny_patch_is_skin_in_contact_and_a_thin_pad_too() -> None:
    trace = simulate(STEP, THENAR.with_(probe=[{"name": "at", "place": "skin", "depth_mm": 0.5}]))
    assert np.abs(under(trace, 0.02, depth_m=0.5e-3, pad=0.1) - trace.probe("at")).max() < 0.03
    assert np.abs(under(trace, 3.0, pad=THENAR.contact.resistance_m2K_per_W) - trace.skin_C).max() < 0.06


def test_it_starts_in_a_steady_state_and_ends_in_one() -> None:
    trace = simulate_current(Drive([0, 300], [0.08, 0.08]), THENAR)
    assert np.ptp(under(trace, 3.0)) < 1e-6
