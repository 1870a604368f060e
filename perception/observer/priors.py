"""Parameters of the observer with their prior distributions.

Every parameter is inferred on a scale where its prior is normal: `to_value` goes from there to its own unit.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from thermicon.base.numbers.arrays import Array

from .channels import CHANNELS, Variable
from .constants import names_of
from .observer import Observer

Scale = Literal["linear", "log", "logit"]
WITHIN_95 = 1.959964
"""Half the central 95 % of a normal distribution, in SDs."""
WIDTH_95 = 2.0 * WITHIN_95


@dataclass(frozen=True, slots=True)
class Prior:
    """One parameter: `middle` and `sd` on its scale, `mechanism` that it belongs to, and the source of the interval."""

    name: str
    unit: str
    scale: Scale
    middle: float
    sd: float
    mechanism: str
    source: str

    def __post_init__(self) -> None:
        if not self.sd > 0.0 or not math.isfinite(self.middle):
            raise ValueError(f"{self.name}: a prior needs a finite middle and an SD above 0, not {self.sd:g}")

    def to_value(self, place: float) -> float:
        """The parameter in its own unit, from its place on the scale."""
        if self.scale == "log":
            return math.exp(place)
        return place if self.scale == "linear" else 1.0 / (1.0 + math.exp(-place))

    def to_place(self, value: float) -> float:
        """The place on the scale of a value in the parameter's own unit."""
        if self.scale == "log":
            return math.log(value)
        return value if self.scale == "linear" else math.log(value / (1.0 - value))

    @property
    def interval(self) -> tuple[float, float]:
        """The central 95 % interval in the parameter's own unit."""
        half = 0.5 * WIDTH_95 * self.sd
        return self.to_value(self.middle - half), self.to_value(self.middle + half)


@dataclass(frozen=True, slots=True)
class Priors:
    """All parameters in order; vectors of the inference have one place for each."""

    each: tuple[Prior, ...]

    def __post_init__(self) -> None:
        names = [prior.name for prior in self.each]
        if len(set(names)) < len(names):
            raise ValueError("two parameters have one name")

    def __len__(self) -> int:
        return len(self.each)

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order."""
        return tuple(prior.name for prior in self.each)

    @property
    def middle(self) -> Array:
        """Places (n,) of the medians."""
        return np.array([prior.middle for prior in self.each])

    @property
    def sd(self) -> Array:
        """SD (n,) on the parameters' scales."""
        return np.array([prior.sd for prior in self.each])

    def values(self, places: Sequence[float] | Array) -> dict[str, float]:
        """Values by name, from places (n,)."""
        return {prior.name: prior.to_value(float(place)) for prior, place in zip(self.each, places, strict=True)}

    def places(self, values: Mapping[str, float]) -> Array:
        """Places (n,) from values by name."""
        return np.array([prior.to_place(values[prior.name]) for prior in self.each])

    def without(self, names: Sequence[str]) -> Priors:
        """The parameters but for some."""
        return Priors(tuple(prior for prior in self.each if prior.name not in names))


LABORATORIES = ("E1", "E3", "E4", "thenar", "wrist")
"""Laboratories with an offset of their own in each channel; E2 is E1's, E5 is E4's, and ratings have their own unit."""
DRIVE_SCALE: dict[Variable, float] = {"temperature": 1.0, "heat flow": 600.0}
"""What the prior of a threshold drive is multiplied by: W/m² for each K, roughly; the prior is wide."""
FILE = Path(__file__).parents[1] / "data" / "priors.toml"


class _Row(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str = Field(min_length=1)
    unit: str
    scale: Literal["log", "linear", "share"]
    median: float
    low: float
    high: float
    mechanism: str
    source: str = Field(min_length=1)


def load_priors() -> Priors:
    """The shipped priors, in the order of the file."""
    rows = [_Row.model_validate(row) for row in tomllib.loads(FILE.read_text("utf-8"))["prior"]]
    return Priors(tuple(_prior(row) for row in rows))


def priors_of(variable: Variable) -> Priors:
    """Priors of a variant of the observer: the shipped ones, and an offset for each laboratory and channel."""
    log_scale = math.log(DRIVE_SCALE[variable])
    shipped = tuple(
        replace(prior, unit="own", middle=prior.middle + log_scale)
        if log_scale and prior.name in names_of(Observer, "threshold_drive")
        else prior
        for prior in load_priors().each
    )
    source = "the spread between laboratories"
    offsets = tuple(
        Prior(f"{place} {channel}", "SD", "linear", 0.0, 1.0, "laboratories", source)
        for place, channel in product(LABORATORIES, CHANNELS)
    )
    return Priors((*shipped, *offsets))


def _prior(row: _Row) -> Prior:
    scale: Scale = "logit" if row.scale == "share" else row.scale
    if scale == "log":
        middle, width = math.log(row.median), math.log(row.high / row.low)
    elif scale == "linear":
        middle, width = row.median, row.high - row.low
    else:
        middle, low, high = (math.log(share / (1.0 - share)) for share in (row.median, row.low, row.high))
        width = high - low
    return Prior(row.name, row.unit, scale, middle, width / WIDTH_95, row.mechanism, row.source)
