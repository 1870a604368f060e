"""Legs of the module as cells that store heat: what they add to one implicit step of the plates, and their own step.

Between the plates lie m equal cells with the capacity C_l/m and the Joule heat I²R/m each. Cells are joined by m/Θ, the
outer ones to their plates by 2m/Θ, half a cell. In steady state that is I²R/2 to each plate and 1/Θ between them, as
without cells. In an implicit step of length h,

    (C_l/(m·h) + g_above + g_below)·T_j = C_l/(m·h)·T_j,old + I²R/m + g_above·T_{j−1} + g_below·T_{j+1},

so that the heat from the legs to a plate is `into` − NEAR · (that plate) + ACROSS · (the other one).
Every function takes None in place of legs without capacity, for which nothing of this is compiled. Those that begin
with `block_` are the same for blocks of LANES lanes, whose temperatures are in °C, with the innermost loops over lanes.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..compiled import kernel
from .plate import CONDUCTANCE, DEEP_C, INTEGRAL, LEG_J_PER_K, POWER, RESISTANCE, REST_POWER, TEMPERATURE

compiled = kernel(nogil=True, fastmath={"contract"}, error_model="numpy")

CELL, WEIGHT, UP, DOWN, INVERSE, SCRATCH = range(6)
"""Rows of the cells (row, cell): K above the deep node; weight of a cell's heat in that of the hot plate's neighbour;
after elimination from the cold end, the weights of the cell above, of the cell below, and of its own heat; scratch."""

NEAR, ACROSS, STORE, EDGE, HEATED = range(5)
"""Sums of a step: conductances in W/K as above, C/(m·h) of a cell, that of half a cell, and the sum of the weights."""


def leg_room(cells: Array | None) -> tuple[Array, Array] | None:
    """Room for the cells of a lane (6, m) and their sums (5,), for `cells` (lanes, m); None where there are none."""
    return None if cells is None else (np.zeros((6, cells.shape[1])), np.zeros(5))


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
def legs_ahead(p, leg, period_leg, ahead):
    """Fill `ahead` (5,) with what the legs do in one implicit step over a period, for `kernel.wanted`.

    NEAR, ACROSS, the resistance in Ω whose Joule heat reaches a plate within the period, and the heat in W into the hot
    and the cold plate that depends on neither plate nor current, for temperatures in °C.
    """
    if leg is not None:
        rows, sums = period_leg
        m = rows.shape[1]
        hot, cold = 0.0, 0.0
        for j in range(m):
            heat = sums[STORE] * (leg[0][CELL, j] + p[DEEP_C])
            hot += rows[WEIGHT, j] * heat
            cold += rows[WEIGHT, m - 1 - j] * heat
        ahead[0], ahead[1], ahead[2] = sums[NEAR], sums[ACROSS], 2.0 * sums[EDGE] * sums[HEATED] * p[RESISTANCE] / m
        ahead[3], ahead[4] = sums[EDGE] * hot, sums[EDGE] * cold


@compiled
def begin_sink(warm, lane, sink):
    """Start a passive heat sink at its own temperature, `warm` (lanes,) in °C; it has no power of its own at rest."""
    if warm is not None:
        sink[TEMPERATURE], sink[INTEGRAL], sink[POWER], sink[REST_POWER] = warm[lane], 0.0, 0.0, 0.0


LANES = 32
"""Runs in a block: enough to fill the vectors, few enough for the first-level cache."""

NEARS, ACROSSES, WARM, COOL = range(4)
"""Rows of the heat of a block, as `legs_heat` returns it."""


def block_room(cells: Array | None) -> tuple[Array, Array, Array] | None:
    """Room for the cells of a block (6, m, LANES), their sums (5, LANES) and heat (4, LANES); None without cells."""
    if cells is None:
        return None
    return np.zeros((6, cells.shape[1], LANES)), np.zeros((5, LANES)), np.zeros((4, LANES))


@compiled
def block_load(cells, block, leg):
    """Take the cells of a block's lanes."""
    if leg is not None:
        for lane in range(LANES):
            for j in range(cells.shape[1]):
                leg[0][CELL, j, lane] = cells[block[lane], j]


@compiled
def block_store(cells, block, leg):
    """Give the cells of a block's lanes back."""
    if leg is not None:
        for lane in range(LANES):
            for j in range(cells.shape[1]):
                cells[block[lane], j] = leg[0][CELL, j, lane]


@compiled
def block_factor(half, p, leg):
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
def block_heat(squared, p, leg):
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
def block_step(squared, hot, cold, p, leg):
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
def block_ahead(lane, p, leg, period_leg, ahead):
    """`legs_ahead` for one lane of a block."""
    if leg is not None:
        rows, sums, _ = period_leg
        m = rows.shape[1]
        hot, cold = 0.0, 0.0
        for j in range(m):
            heat = sums[STORE, lane] * leg[0][CELL, j, lane]
            hot += rows[WEIGHT, j, lane] * heat
            cold += rows[WEIGHT, m - 1 - j, lane] * heat
        ahead[0], ahead[1] = sums[NEAR, lane], sums[ACROSS, lane]
        ahead[2] = 2.0 * sums[EDGE, lane] * sums[HEATED, lane] * p[RESISTANCE, lane] / m
        ahead[3], ahead[4] = sums[EDGE, lane] * hot, sums[EDGE, lane] * cold


@compiled
def block_sinks(warm, block, sink):
    """Start the passive heat sinks of a block at their own temperatures, `warm` (lanes,) in °C."""
    if warm is not None:
        for lane in range(LANES):
            sink[lane, TEMPERATURE], sink[lane, INTEGRAL] = warm[block[lane]], 0.0
            sink[lane, POWER], sink[lane, REST_POWER] = 0.0, 0.0
