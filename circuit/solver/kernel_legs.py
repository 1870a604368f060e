"""Legs of the module as cells that store heat: what they add to one implicit step of the plates, and their own step.

Between the plates lie m equal cells with the capacity C_l/m and the Joule heat I²R/m each. Cells are joined by m/Θ, the
outer ones to their plates by 2m/Θ, half a cell. In steady state that is I²R/2 to each plate and 1/Θ between them, as
without cells. In an implicit step of length h,

    (C_l/(m·h) + g_above + g_below)·T_j = C_l/(m·h)·T_j,old + I²R/m + g_above·T_{j−1} + g_below·T_{j+1},

so that the heat from the legs to a plate is WARM or COOL − NEAR · (that plate) + ACROSS · (the other one).
Every function takes None in place of legs without capacity, for which nothing of this is compiled.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..compiled import kernel
from .network import CONDUCTANCE, LEG_J_PER_K, RESISTANCE

compiled = kernel(nogil=True, fastmath={"contract"}, error_model="numpy")

CELL, WEIGHT, UP, DOWN, INVERSE, SCRATCH = range(6)
"""Rows of the cells (row, cell, lane): K above the deep node; weight of a cell's heat in that of the hot plate's
neighbour; after elimination from the cold end, the weights of the cell above, of the cell below, and of its own heat;
scratch."""

NEAR, ACROSS, WARM, COOL, STORE, EDGE, HEATED, MIDDLE = range(8)
"""Rows of sums (row, lane): conductances in W/K as above; heat in W into the hot and the cold plate that depends on
neither; C/(m·h) of a cell, conductance of half a cell, sum of the weights; the hot plate in the middle of a step."""


def leg_room(wide: tuple[int, ...], cells: int) -> tuple[Array, Array] | None:
    """Room for the cells of a block (6, m, lanes) and their sums (8, lanes); None for none."""
    return (np.zeros((6, cells, len(wide))), np.zeros((8, len(wide)))) if cells else None


@compiled
def load_legs(state, first, lane, deep, leg):
    """Take a lane's cells from place `first` of a state in °C on, as K above the deep node; returns the next place."""
    if leg is not None:
        for j in range(leg[0].shape[1]):
            leg[0][CELL, j, lane] = state[first + j] - deep
        first += leg[0].shape[1]
    return first


@compiled
def store_legs(state, first, lane, deep, leg):
    """The reverse of `load_legs`."""
    if leg is not None:
        for j in range(leg[0].shape[1]):
            state[first + j] = leg[0][CELL, j, lane] + deep
        first += leg[0].shape[1]
    return first


@compiled
def factor_legs(half, p, leg):
    """Factor the cells for an implicit step of length `half`, from the cold plate up; `p` is (number, lane)."""
    if leg is not None:
        rows, sums = leg
        m = rows.shape[1]
        for lane in range(rows.shape[2]):
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
def legs_heat(squared, p, leg, cells):
    """Fill WARM and COOL for mean squared currents (lane,), above the deep node; `cells` are those of `leg`."""
    if leg is not None:
        rows, sums = leg
        m = rows.shape[1]
        for lane in range(rows.shape[2]):
            sums[WARM, lane], sums[COOL, lane] = 0.0, 0.0
        for j in range(m):
            for lane in range(rows.shape[2]):
                part = sums[STORE, lane] * cells[0][CELL, j, lane] + p[RESISTANCE, lane] * squared[lane] / m
                sums[WARM, lane] += sums[EDGE, lane] * rows[WEIGHT, j, lane] * part
                sums[COOL, lane] += sums[EDGE, lane] * rows[WEIGHT, m - 1 - j, lane] * part


@compiled
def step_legs(squared, cold, p, leg):
    """Move the cells by a whole step; MIDDLE and `cold` (lane,) are the plates in its middle."""
    if leg is not None:
        rows, sums = leg
        m = rows.shape[1]
        for j in range(m - 1, -1, -1):
            for lane in range(rows.shape[2]):
                below = cold[lane] if j == m - 1 else rows[SCRATCH, j + 1, lane]
                own = sums[STORE, lane] * rows[CELL, j, lane] + p[RESISTANCE, lane] * squared[lane] / m
                rows[SCRATCH, j, lane] = rows[INVERSE, j, lane] * own + rows[DOWN, j, lane] * below
        for j in range(m):
            for lane in range(rows.shape[2]):
                above = sums[MIDDLE, lane] if j == 0 else rows[SCRATCH, j - 1, lane]
                rows[SCRATCH, j, lane] += rows[UP, j, lane] * above
                rows[CELL, j, lane] = 2.0 * rows[SCRATCH, j, lane] - rows[CELL, j, lane]
