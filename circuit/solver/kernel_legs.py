"""Legs of the module as cells that store heat: what they add to one implicit step of the plates, and their own step.

Between the plates lie m equal cells with the capacity C_l/m and the Joule heat I²R/m each. Cells are joined by m/Θ, the
outer ones to their plates by 2m/Θ, half a cell. In steady state that is I²R/2 to each plate and 1/Θ between them, as
without cells. In an implicit step of length h,

    (C_l/(m·h) + g_above + g_below)·T_j = C_l/(m·h)·T_j,old + I²R/m + g_above·T_{j−1} + g_below·T_{j+1},

so that the heat from the legs to a plate is `into` − NEAR · (that plate) + ACROSS · (the other one).
Every function takes None in place of legs without capacity, for which nothing of this is compiled.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import numpy as np

from ..compiled import kernel
from .plate import CONDUCTANCE, DEEP_C, LEG_J_PER_K, RESISTANCE

compiled = kernel(nogil=True, fastmath={"contract"}, error_model="numpy")

CELL, WEIGHT, UP, DOWN, INVERSE, SCRATCH = range(6)
"""Rows of the cells (row, cell): K above the deep node; weight of a cell's heat in that of the hot plate's neighbour;
after elimination from the cold end, the weights of the cell above, of the cell below, and of its own heat; scratch."""

NEAR, ACROSS, STORE, EDGE, HEATED = range(5)
"""Sums of a step: conductances in W/K as above, C/(m·h) of a cell, that of half a cell, and the sum of the weights."""


@compiled
def leg_room(cells):
    """Room for the cells of a lane (6, m) and their sums (5,), where `cells` (lanes, m) is not None."""
    if cells is None:
        return None
    return np.zeros((6, cells.shape[1])), np.zeros(5)


@compiled
def load_legs(cells, lane, p, leg):
    """Take a lane's cells (°C) as K above the deep node."""
    if leg is not None:
        for j in range(cells.shape[1]):
            leg[0][CELL, j] = cells[lane, j] - p[DEEP_C]


@compiled
def store_legs(cells, lane, p, leg):
    """Give a lane's cells back in °C."""
    if leg is not None:
        for j in range(cells.shape[1]):
            cells[lane, j] = leg[0][CELL, j] + p[DEEP_C]


@compiled
def factor_legs(half, p, leg):
    """Factor the cells for an implicit step of length `half`, from the cold plate up."""
    if leg is not None:
        rows, sums = leg
        m = rows.shape[1]
        between, edge, store = m * p[CONDUCTANCE], 2.0 * m * p[CONDUCTANCE], p[LEG_J_PER_K] / (m * half)
        share, below = 0.0, edge
        for j in range(m - 1, -1, -1):
            above = between if j > 0 else edge
            inverse = 1.0 / (store + above + below - below * share)
            share = above * inverse
            rows[UP, j], rows[DOWN, j], rows[INVERSE, j] = share, below * inverse, inverse
            below = between
        product, total = 1.0, 0.0
        for j in range(m):
            rows[WEIGHT, j] = product * rows[INVERSE, j]
            product *= rows[DOWN, j]
            total += rows[WEIGHT, j]
        sums[NEAR], sums[ACROSS] = edge * (1.0 - rows[UP, 0]), edge * product
        sums[STORE], sums[EDGE], sums[HEATED] = store, edge, total


@compiled
def legs_heat(squared, p, leg):
    """NEAR, ACROSS, and the heat into the hot and the cold plate that depends on neither, in W above the deep node."""
    rows, sums = leg
    m = rows.shape[1]
    joule, hot, cold = p[RESISTANCE] * squared / m, 0.0, 0.0
    for j in range(m):
        heat = sums[STORE] * rows[CELL, j] + joule
        hot += rows[WEIGHT, j] * heat
        cold += rows[WEIGHT, m - 1 - j] * heat
    return sums[NEAR], sums[ACROSS], sums[EDGE] * hot, sums[EDGE] * cold


@compiled
def step_legs(squared, hot, cold, p, leg):
    """Move the cells by a whole step; `hot` and `cold` are the plates in its middle, in K above the deep node."""
    if leg is not None:
        rows, sums = leg
        m = rows.shape[1]
        joule, below = p[RESISTANCE] * squared / m, cold
        for j in range(m - 1, -1, -1):
            below = rows[INVERSE, j] * (sums[STORE] * rows[CELL, j] + joule) + rows[DOWN, j] * below
            rows[SCRATCH, j] = below
        above = hot
        for j in range(m):
            above = rows[SCRATCH, j] + rows[UP, j] * above
            rows[CELL, j] = 2.0 * above - rows[CELL, j]


@compiled
def legs_ahead(p, leg, period_leg):
    """What the legs do in one implicit step over a period, for `kernel.wanted`; None without legs that store heat.

    NEAR, ACROSS, the resistance in Ω whose Joule heat reaches a plate within the period, and the heat in W into the hot
    and the cold plate that depends on neither plate nor current, for temperatures in °C.
    """
    if leg is None:
        return None
    rows, sums = period_leg
    m = rows.shape[1]
    hot, cold = 0.0, 0.0
    for j in range(m):
        heat = sums[STORE] * (leg[0][CELL, j] + p[DEEP_C])
        hot += rows[WEIGHT, j] * heat
        cold += rows[WEIGHT, m - 1 - j] * heat
    ohm = 2.0 * sums[EDGE] * sums[HEATED] * p[RESISTANCE] / m
    return sums[NEAR], sums[ACROSS], ohm, sums[EDGE] * hot, sums[EDGE] * cold


@compiled
def begin_sink(warm, lane, sink):
    """Start a passive heat sink at its own temperature, `warm` (lanes,) in °C; it has no power of its own at rest."""
    if warm is not None:
        sink[0], sink[1], sink[2], sink[3] = warm[lane], 0.0, 0.0, 0.0
