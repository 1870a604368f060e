"""The robust least-squares solution of a fit."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from thermicon.base.numbers.arrays import Array

from .between import MAD_TO_SD
from .problem import FitProblem
from .rounding import rounding

ROUNDS: tuple[tuple[float, Literal["linear", "huber"]], ...] = ((1e-3, "linear"), (1e-5, "huber"), (1e-6, "huber"))
"""Relative change of the sum of squares at which each round ends, and its loss; the first finds the noise alone."""

SAME_NOISE = 0.02
"""Noise that changes by less than 2 % from round to round is known."""

OUTLIER = 3.0
"""Residuals beyond three standard deviations pull with a constant force (Huber): a few wild rows do no harm."""

LEAST_SD = {True: 1e-4, False: 1e-5}
"""Least standard deviation of a temperature in K and of a voltage in V, below any instrument."""

ROUGH = 1.7
"""So many rows that err alike count as one at least: half a difference says only roughly what a drive does between."""
MOST_EVALUATIONS = 30
FEWEST_INDEPENDENT = 8.0
"""However alike neighbouring residuals are, a channel counts as at least so many independent rows."""
NEGLIGIBLE = 1e-2
"""Residuals of so many standard deviations of the noise are rounding, however alike."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The end point of the fit; `inflation`: how many alike neighbouring rows of a channel count as one."""

    theta: Array
    covariance: Array
    sigma: tuple[float, ...]
    inflation: tuple[float, ...]
    converged: bool


def solve(problem: FitProblem, begin: Array | None = None, evaluations: int = MOST_EVALUATIONS) -> Solution:
    """Fit, from the problem's own first point or another, with so many evaluations a round at most."""
    from scipy.optimize import least_squares

    theta = np.clip(problem.first if begin is None else begin, *problem.bounds)
    scale = np.array([item.sd for item in problem.unknowns])
    sigma, converged = spreads(problem, theta), False
    for close, loss in ROUNDS:
        answer = least_squares(
            problem.residuals, theta, jac=problem.jacobian, args=(sigma,), bounds=problem.bounds, x_scale=scale,
            loss=loss, f_scale=OUTLIER, xtol=1e-5, ftol=close, gtol=None, max_nfev=evaluations,
        )  # fmt: skip
        theta, converged = np.asarray(answer.x, dtype=np.float64), bool(answer.success)
        before, sigma = sigma, spreads(problem, theta, sigma)
        if loss == "huber" and np.allclose(before, sigma, rtol=SAME_NOISE):
            break
    parts = parts_of(problem, problem.residuals(theta, sigma))
    least = [1.0 if run.unknown is None else ROUGH for run in problem.runs for _ in run.channels]
    inflation = tuple(max(alike(part), each) for part, each in zip(parts, least, strict=True))
    jacobian = problem.jacobian(theta, sigma)
    mesh = jacobian.T @ problem.mesh_error(theta, sigma)
    common = np.outer(mesh, mesh) + rounding(problem, theta, jacobian, sigma)
    covariance = covariance_of(problem, jacobian, inflation, common)
    return Solution(theta, covariance, sigma, inflation, converged)


def huber(residuals: Array) -> float:
    """Huber's sum: squares, and beyond OUTLIER linear."""
    size = np.abs(residuals)
    return float(np.sum(np.where(size <= OUTLIER, size**2, 2 * OUTLIER * size - OUTLIER**2)))


def parts_of(problem: FitProblem, residuals: Array) -> list[Array]:
    """Residuals of each channel."""
    ends = np.cumsum([len(channel.values) for _, _, channel in problem.channels()])
    return list(np.split(residuals, ends))[:-1]


def spreads(problem: FitProblem, theta: Array, before: Sequence[float] = ()) -> tuple[float, ...]:
    """Robust SD of each channel's residuals, made independent by the noise `before`, and at least that between rows."""
    channels = [channel for _, _, channel in problem.channels()]
    least = [max(channel.noise, LEAST_SD[channel.temperature]) for channel in channels]
    sigma = before or least
    found = zip(sigma, parts_of(problem, problem.residuals(theta, sigma)), least, strict=True)
    return tuple(max(low, sd * MAD_TO_SD * float(np.median(np.abs(part - np.median(part))))) for sd, part, low in found)


def alike(residuals: Array) -> float:
    """Return how many neighbouring residuals count as one, by their correlation; 1 for white noise."""
    count = len(residuals)
    clipped = np.clip(residuals - np.median(residuals), -OUTLIER, OUTLIER)
    power = float(clipped @ clipped)
    if count < 3 or power <= count * NEGLIGIBLE**2:
        return 1.0
    neighbour = float(clipped[1:] @ clipped[:-1]) / power
    if neighbour < 3.0 / np.sqrt(count):
        return 1.0
    return float(min((1 + neighbour) / max(1 - neighbour, 1e-9), max(1.0, count / FEWEST_INDEPENDENT)))


def covariance_of(
    problem: FitProblem, jacobian: Array, inflation: Sequence[float], common: Array | float = 0.0
) -> Array:
    """Covariance of all parameters; what no row and no prior fixes gets the width of its room.

    The sandwich form H⁻¹·B·H⁻¹, where B counts alike neighbouring rows once, and adds what is `common` to many rows
    (unknowns, unknowns): the errors of the mesh and of rounding.
    """
    counts = [len(channel.values) for _, _, channel in problem.channels()]
    rows = np.split(jacobian, np.cumsum(counts))
    prior = rows[-1].T @ rows[-1]
    information, middle = prior.copy(), prior.copy()
    for part, factor in zip(rows[:-1], inflation, strict=True):
        product = part.T @ part
        information += product
        middle += factor * product
    middle += common
    room = np.diag([(0.5 * (item.high - item.low)) ** -2.0 if item.kind == "key" else 0.0 for item in problem.unknowns])
    inverse = inverse_of(information + room)
    return np.asarray(inverse @ (middle + room) @ inverse)


def inverse_of(information: Array) -> Array:
    """Inverse of information (n, n), 0 for what nothing is known of.

    Each number is taken in SDs that it has alone: in one scale, rows enough on one number, such as a clock's drift,
    would make all that is known of another look like rounding, and its variance 0.
    """
    size = np.sqrt(np.diag(information))
    alone = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0.0)
    scale = np.outer(alone, alone)
    return np.asarray(scale * np.linalg.pinv(scale * information, hermitian=True))
