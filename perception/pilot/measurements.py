"""Thresholds, reaction times and ratings that a laboratory measured, each under a condition that can be simulated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..arrays import Array, own_arrays
from ..observer.channels import CHANNELS, Channel

Kind = Literal["threshold", "reaction_time", "rating"]
METHODS: dict[Kind, tuple[str, ...]] = {
    "threshold": ("forced_choice", "yes_no", "limits"),
    "reaction_time": ("choice", "simple"),
    "rating": ("magnitude",),
}
"""Methods of each kind; the first of reaction times and ratings is meant where none is given."""
ADAPTIVE = ("forced_choice", "yes_no")
"""Methods that find the size themselves."""
UNITS: dict[Kind, str] = {"threshold": "K", "reaction_time": "s", "rating": "points"}
"""Units inside; ratings are points of 100."""
WORDS = {
    "forced_choice": "forced choice",
    "yes_no": "yes/no",
    "limits": "limits",
    "choice": "choice reaction time",
    "simple": "simple reaction time",
    "magnitude": "rating",
}


@dataclass(frozen=True, slots=True)
class Condition:
    """What was measured, and the ramp of the display it was measured with.

    `size_K` is the change that was timed or rated, and where a ramp of limits ends; None for forced choice and yes/no.
    Changes and rates are without sign.
    """

    kind: Kind
    method: str
    channel: Channel
    baseline_C: float
    size_K: float | None
    rate_K_per_s: float
    hold_s: float

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind) or self.method not in METHODS[self.kind] or self.channel not in CHANNELS:
            raise ValueError(f"there is no {self.kind} by {self.method} of {self.channel}")
        if not self.rate_K_per_s > 0.0 or not self.hold_s >= 0.0:
            raise ValueError("a rate above 0 and a hold of at least 0 s are needed")
        if self.method not in ADAPTIVE and (self.size_K is None or not self.size_K > 0.0):
            raise ValueError(f"{WORDS[self.method]} needs the size of the change, above 0 K")

    @property
    def unit(self) -> str:
        """Unit of its values."""
        return UNITS[self.kind]

    @property
    def label(self) -> str:
        """What it is in words."""
        words = f"{self.channel}, {WORDS[self.method]}"
        if self.kind == "threshold":
            return f"{words}, {self.rate_K_per_s:g} K/s"
        return f"{words}, {self.size_K:g} K at {self.rate_K_per_s:g} K/s"


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
