"""The legs of `kernel_legs` for blocks of LANES lanes; temperatures in °C, innermost loops over the lanes."""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import numpy as np

from ..compiled import kernel
from .kernel_legs import ACROSS, CELL, DOWN, EDGE, HEATED, INVERSE, NEAR, SCRATCH, STORE, UP, WEIGHT
from .plate import CONDUCTANCE, LEG_J_PER_K, RESISTANCE

compiled = kernel(nogil=True, fastmath={"contract"}, error_model="numpy")

LANES = 32
"""Runs in a block: enough to fill the vectors, few enough for the first-level cache."""

NEARS, ACROSSES, WARM, COOL = range(4)
"""Rows of the heat of a block, as `kernel_legs.legs_heat` returns it."""


@compiled
def leg_room(cells):
    """Room for the cells of a block (6, m, LANES), their sums (5, LANES) and heat (4, LANES)."""
    if cells is None:
        return None
    return np.zeros((6, cells.shape[1], LANES)), np.zeros((5, LANES)), np.zeros((4, LANES))


@compiled
def load_legs(cells, block, leg):
    """Take the cells of a block's lanes."""
    if leg is not None:
        for lane in range(LANES):
            for j in range(cells.shape[1]):
                leg[0][CELL, j, lane] = cells[block[lane], j]


@compiled
def store_legs(cells, block, leg):
    """Give the cells of a block's lanes back."""
    if leg is not None:
        for lane in range(LANES):
            for j in range(cells.shape[1]):
                cells[block[lane], j] = leg[0][CELL, j, lane]


@compiled
def factor_legs(half, p, leg):
    """Factor the cells for an implicit step of length `half`; `p` is (parameter, lane)."""
    if leg is not None:
        rows, sums, _ = leg
        m = rows.shape[1]
        for lane in range(LANES):
            between = m * p[CONDUCTANCE, lane]
            edge, store = 2.0 * between, p[LEG_J_PER_K, lane] / (m * half)
            share, below = 0.0, edge
            for j in range(m - 1, -1, -1):
                above = between if j > 0 else edge
                inverse = 1.0 / (store + above + below - below * share)
                share = above * inverse
                rows[UP, j, lane], rows[DOWN, j, lane], rows[INVERSE, j, lane] = share, below * inverse, inverse
                below = between
            product, total = 1.0, 0.0
            for j in range(m):
                rows[WEIGHT, j, lane] = product * rows[INVERSE, j, lane]
                product *= rows[DOWN, j, lane]
                total += rows[WEIGHT, j, lane]
            sums[NEAR, lane], sums[ACROSS, lane] = edge * (1.0 - rows[UP, 0, lane]), edge * product
            sums[STORE, lane], sums[EDGE, lane], sums[HEATED, lane] = store, edge, total


@compiled
def legs_heat(squared, p, leg):
    """Fill the heat of a block, for mean squared currents (lane,)."""
    if leg is not None:
        rows, sums, heat = leg
        m = rows.shape[1]
        for lane in range(LANES):
            heat[NEARS, lane], heat[ACROSSES, lane] = sums[NEAR, lane], sums[ACROSS, lane]
            heat[WARM, lane], heat[COOL, lane] = 0.0, 0.0
        for j in range(m):
            for lane in range(LANES):
                part = sums[STORE, lane] * rows[CELL, j, lane] + p[RESISTANCE, lane] * squared[lane] / m
                heat[WARM, lane] += sums[EDGE, lane] * rows[WEIGHT, j, lane] * part
                heat[COOL, lane] += sums[EDGE, lane] * rows[WEIGHT, m - 1 - j, lane] * part


@compiled
def step_legs(squared, hot, cold, p, leg):
    """Move the cells by a whole step; `hot` and `cold` (lane,) are the plates in its middle; `cold` is kept."""
    if leg is not None:
        rows = leg[0]
        m = rows.shape[1]
        for j in range(m - 1, -1, -1):
            for lane in range(LANES):
                below = cold[lane] if j == m - 1 else rows[SCRATCH, j + 1, lane]
                own = leg[1][STORE, lane] * rows[CELL, j, lane] + p[RESISTANCE, lane] * squared[lane] / m
                rows[SCRATCH, j, lane] = rows[INVERSE, j, lane] * own + rows[DOWN, j, lane] * below
        for j in range(m):
            for lane in range(LANES):
                above = hot[lane] if j == 0 else rows[SCRATCH, j - 1, lane]
                rows[SCRATCH, j, lane] += rows[UP, j, lane] * above
                rows[CELL, j, lane] = 2.0 * rows[SCRATCH, j, lane] - rows[CELL, j, lane]


@compiled
def legs_ahead(lane, p, leg, period_leg):
    """`kernel_legs.legs_ahead` for one lane of a block."""
    if leg is None:
        return None
    rows, sums, _ = period_leg
    m = rows.shape[1]
    hot, cold = 0.0, 0.0
    for j in range(m):
        heat = sums[STORE, lane] * leg[0][CELL, j, lane]
        hot += rows[WEIGHT, j, lane] * heat
        cold += rows[WEIGHT, m - 1 - j, lane] * heat
    ohm = 2.0 * sums[EDGE, lane] * sums[HEATED, lane] * p[RESISTANCE, lane] / m
    return sums[NEAR, lane], sums[ACROSS, lane], ohm, sums[EDGE, lane] * hot, sums[EDGE, lane] * cold


@compiled
def begin_sinks(warm, block, sink):
    """Start the passive heat sinks of a block at their own temperatures, `warm` (lanes,) in °C."""
    if warm is not None:
        for lane in range(LANES):
            sink[lane, 0], sink[lane, 1], sink[lane, 2], sink[lane, 3] = warm[block[lane]], 0.0, 0.0, 0.0
