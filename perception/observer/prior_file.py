"""The shipped priors, read and checked."""

from __future__ import annotations

import math
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from .channels import CHANNELS
from .priors import WIDTH_95, Prior, Priors
from .variants import Variable

LABORATORIES = ("E1", "E3", "E4", "thenar", "wrist")
"""Laboratories with an offset of their own in each channel; E2 is E1's, E5 is E4's, and ratings have their own unit."""
DRIVE_SCALE: dict[Variable, float] = {
    "temperature": 1.0,
    "heat flow": 600.0,
}
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


@lru_cache(maxsize=1)
def load_priors() -> Priors:
    """The shipped priors, in the order of the file."""
    rows = [_Row.model_validate(row) for row in tomllib.loads(FILE.read_text("utf-8"))["prior"]]
    return Priors(tuple(_prior(row) for row in rows))


def priors_of(variable: Variable) -> Priors:
    """Priors of a variant of the observer: the shipped ones, and an offset for each laboratory and channel."""
    log_scale = math.log(DRIVE_SCALE[variable])
    shipped = tuple(_moved(prior, log_scale) for prior in load_priors().each)
    offsets = tuple(
        Prior.normal(f"{place} {channel}", "SD", 0.0, 1.0, "laboratories", "the spread between laboratories")
        for place in LABORATORIES
        for channel in CHANNELS
    )
    return Priors((*shipped, *offsets))


def _moved(prior: Prior, log_scale: float) -> Prior:
    if not prior.name.endswith("threshold drive") or log_scale == 0.0:
        return prior
    return Prior(prior.name, "own", prior.scale, prior.middle + log_scale, prior.sd, prior.mechanism, prior.source)


def _prior(row: _Row) -> Prior:
    if row.scale == "log":
        return Prior.log(row.name, row.unit, row.median, row.low, row.high, row.mechanism, row.source)
    if row.scale == "linear":
        return Prior.normal(row.name, row.unit, row.median, (row.high - row.low) / WIDTH_95, row.mechanism, row.source)
    ends = [math.log(end / (1.0 - end)) for end in (row.low, row.high)]
    return Prior.share(row.name, row.median, (ends[1] - ends[0]) / WIDTH_95, row.mechanism, row.source)
