"""Whitened residuals of a run whose drive is not known between rows.

An unknown drive between two rows affects all later rows by the response of the circuit. Their errors are correlated,
with a covariance K; residuals r become L⁻¹·r, where L·Lᵀ = K + σ² of the sensors. Long runs are split.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from ..rig.rig import Rig
from .forward import predict
from .runs import DISPLAY, Run

MOST_ALIKE = 500
"""Rows in one part of a run, of all columns together; between parts, rows are taken as independent."""

MEMORY_S = 30.0
"""So long a drive is remembered: what it did before is the same to all rows of a part, to within their noise."""

STEP = {DISPLAY: 0.5}
OTHER_STEP = 0.02
"""Step in K, else in A or V, of which the response is taken: small, so that it is linear."""


@dataclass(frozen=True, slots=True, eq=False)
class CommonErrors:
    """Common errors of a run's rows: the rows (n,) of each part among the run's, and their covariance (n, n)."""

    rows: tuple[Index, ...]
    covariance: tuple[Array, ...]
    kept: dict[tuple[float, ...], list[Array]] = field(default_factory=dict)

    def independent(self, parts: Sequence[Array], sigma: tuple[float, ...]) -> list[Array]:
        """Differences (rows,) of each channel, whose own noise has the SD `sigma`, as independent ones of SD 1."""
        from scipy.linalg import solve_triangular

        counts = [len(part) for part in parts]
        if sigma not in self.kept:
            self.kept.clear()
            noise, pairs = np.repeat(sigma, counts) ** 2, zip(self.rows, self.covariance, strict=True)
            self.kept[sigma] = [np.asarray(np.linalg.cholesky(alike + np.diag(noise[rows]))) for rows, alike in pairs]
        differences = np.concatenate(parts)
        for rows, lower in zip(self.rows, self.kept[sigma], strict=True):
            differences[rows] = solve_triangular(lower, differences[rows], lower=True, check_finite=False)
        return list(np.split(differences, np.cumsum(counts)[:-1]))


def shared(rig: Rig, run: Run, times: Sequence[Array]) -> CommonErrors | None:
    """Common errors of rows at `times` of each channel, on the drive's clock; None where the drive is known."""
    if run.unknown is None or not run.unknown.any():
        return None
    after_step = responses(rig, run)
    time = np.concatenate(times)
    channel = np.repeat(np.arange(len(times)), [len(each) for each in times])
    parts = -(-len(time) // MOST_ALIKE)
    edges = np.quantile(time, np.linspace(0.0, 1.0, parts + 1))[1:-1]
    place = np.searchsorted(edges, time, side="right")
    rows = tuple(np.flatnonzero(place == part) for part in range(parts))
    return CommonErrors(rows, tuple(_covariance(run, after_step, time[each], channel[each]) for each in rows))


def responses(rig: Rig, run: Run) -> tuple[Array, list[Array]]:
    """Times (n,) in s after a step of the drive, and what a step of one does to each channel (n,), but I·R."""
    size, level = STEP.get(run.driven_by, OTHER_STEP), float(np.median(run.drive))
    time, begin = np.arange(0.0, MEMORY_S, 0.01), 0.02
    drive, times = level + size * np.array([0.0, 1.0, 1.0]), np.array([0.0, begin, begin + MEMORY_S])
    step = replace(run, time_s=times, drive=drive, phase=None, logged=None)
    found, out = predict(rig, step), []
    for each in run.channels:
        after = found.at(each.column, time + begin) - found.at(each.column, np.zeros(1))
        jump = found.drive.at(time + begin) - level if each.column == "voltage_V" else 0.0
        out.append((after - found.gain * found.resistance_ohm * jump) / size)
    return time, out


def _covariance(run: Run, responses: tuple[Array, list[Array]], time: Array, channel: Index) -> Array:
    assert run.unknown is not None
    since, each = responses
    near = (run.time_s[1:] > time.min() - MEMORY_S) & (run.time_s[:-1] < time.max()) & (run.unknown > 0.0)
    begin, end, spread = run.time_s[:-1][near], run.time_s[1:][near], run.unknown[near]
    effect = np.zeros((len(time), len(begin)))
    for place, response in enumerate(each):
        mine = channel == place
        for edge, sign in ((begin, 1.0), (end, -1.0)):
            effect[mine] += sign * np.interp(time[mine, np.newaxis] - edge, since, response, left=0.0)
    effect *= spread
    return np.asarray(effect @ effect.T)
