"""The rule of first passage along one course, as response times and detection follow it."""

import numpy as np
from numpy.typing import ArrayLike

from thermicon.perception import Observer
from thermicon.perception.arrays import Array, as_rows
from thermicon.perception.kernels.reports import AT_ONCE, changing, survive


def log_survival(psi: ArrayLike, dt_s: float, criterion: ArrayLike, observer: Observer) -> Array:
    """Log probability (..., n_time) that a channel has not passed its criterion (one, or one a row) by each sample.

    What counts is the change of sensation from its first sample, in either direction.
    """
    rows, shape = as_rows(psi)
    survived, room = np.empty_like(rows), np.empty((2, AT_ONCE + 1))
    for row, own, left in zip(rows, np.broadcast_to(criterion, len(rows)), survived, strict=True):
        survive(
            np.expm1(row / observer.a), 1.0, observer.a, *changing(row), dt_s, own, observer.noise_correlation_s, False,
            room, left,
        )  # fmt: skip
    return survived.reshape(shape)
