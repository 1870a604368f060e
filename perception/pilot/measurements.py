"""Thresholds, reaction times and ratings that a laboratory measured, each under a condition that can be simulated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, own_arrays
from ..experiments.measure import Condition


@dataclass(frozen=True, slots=True)
class Measurements:
    """Values of some participants under some conditions.

    Attributes
    ----------
    conditions
        The conditions.
    participants
        Labels of the participants.
    values
        Means or medians (participants, conditions) in the unit of the condition; NaN where nothing was measured.
    errors
        Their standard errors in the same unit; NaN where none is given.
    trials
        Trials behind each value; NaN where that is not known.
    source, digest
        Name of the file, and the first 16 digits of its SHA-256.

    Raises
    ------
    ValueError
        For arrays of another shape, values that are not above 0, and rows or columns without a value.

    Examples
    --------
    >>> import numpy as np
    >>> limits = Condition("threshold", "limits", "cold", 32.0, 12.0, 1.0, 0.0)
    >>> none = np.full((1, 1), np.nan)
    >>> Measurements((limits,), ("P1",), np.array([[1.1]]), none, none)
    Measurements(1 participant, 1 value, 1 condition)
    """

    conditions: tuple[Condition, ...]
    participants: tuple[str, ...]
    values: Array
    errors: Array
    trials: Array
    source: str = ""
    digest: str = ""

    def __post_init__(self) -> None:
        own_arrays(self, "values", "errors", "trials")
        wanted = (len(self.participants), len(self.conditions))
        for name, own in (("values", self.values), ("errors", self.errors), ("trials", self.trials)):
            if own.shape != wanted or 0 in wanted:
                raise ValueError(f"{name} of measurements must have shape {wanted}, with at least one row and column")
            if (own[~np.isnan(own)] <= 0.0).any() or np.isinf(own).any():
                raise ValueError(f"{name} of measurements must be above 0 and finite")
        there = self.given
        if not there.any(axis=0).all() or not there.any(axis=1).all():
            raise ValueError("every participant and every condition needs at least one value")

    @property
    def given(self) -> Array:
        """Where there is a value (participants, conditions)."""
        return ~np.isnan(self.values)

    @property
    def total(self) -> int:
        """Number of values."""
        return int(self.given.sum())

    @property
    def means(self) -> Array:
        """Geometric mean over participants (conditions,)."""
        found: Array = np.exp(np.nanmean(np.log(self.values), axis=0))
        return found

    @property
    def assumed_errors(self) -> int:
        """Values whose error is neither stated nor follows from a number of trials."""
        return int((self.given & np.isnan(self.errors) & np.isnan(self.trials)).sum())

    def __repr__(self) -> str:
        counts = ((len(self.participants), "participant"), (self.total, "value"), (len(self.conditions), "condition"))
        words = [f"{count} {word}{'s' * (count != 1)}" for count, word in counts]
        return f"Measurements({', '.join(words)})"
