"""Adaptation: a level that follows the receptors' input.

The equations of limits, integration and adaptation stand in `kernels.kernels`, which computes all three at once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.numbers.arrays import Array, as_rows

from ...kernels.parallel import over_rows
from ..channels import SIGN, Channel
from ..constants import Both, constant
from .bounds import Bounds

RESTS_C = (30.0, 34.25)
"""Where receptors rest in the experiments, under skin of 30 to 34 °C. Elsewhere abstracts have directions at most: it
is assumed to be as at the nearer end."""


@dataclass(frozen=True, kw_only=True)
class Adaptation(Bounds):
    """Drive is what exceeds a level that follows slowly; outside the neutral zone a hold keeps a residue."""

    equation = "dq_i/dt = (q − q_i)/τ_i, dA/dt = (clip(q) − A)/τ_s, drive = max(0, s·(q_i − A))"
    source = "Shani & Lineykin 2021 (neutral zone); Kenshalo, Holmes & Wood 1968"
    integration_s: float = constant("integration time")
    adaptation_s: float = constant("slow adaptation time")
    neutral_C: tuple[float, float] = constant("neutral zone", span=True)
    neutral_flux: Both[tuple[float, float]] | None = constant(
        "{} neutral heat flow", span=True, only="heat flow", default=None
    )

    def neutral(self, channel: Channel) -> tuple[float, float]:
        """Range of complete adaptation, in °C or, where heat flow is felt, in W/m² into the skin."""
        if self.variable == "temperature" or self.neutral_flux is None:
            return self.neutral_C
        return self.neutral_flux.of(channel)

    def drive(self, received: ArrayLike, dt_s: float, channel: Channel) -> Array:
        """Drive (never negative, in `drive_unit`) of one channel for what reaches its receptors, of the same shape.

        `received` (..., n_time) is °C at the depth of the channel or, as `variable` says, W/m² into the skin there. At
        the first sample, at rest, nothing is felt: what is felt in every task is a change from there.
        """
        from ...kernels.kernels import adapted_drive

        rows, shape = as_rows(received)
        drive = np.empty_like(rows)
        sign, limit, (low, high) = SIGN[channel], self.limit_C.of(channel), self.neutral(channel)
        rests = RESTS_C if self.variable == "temperature" else (low, high)
        times = self.integration_s, self.adaptation_s

        def work(part: slice) -> None:
            adapted_drive(rows[part], dt_s, sign, limit, self.softness_K, low, high, *rests, *times, drive[part])

        over_rows(work, rows.shape[0], rows.size)
        return drive.reshape(shape)
