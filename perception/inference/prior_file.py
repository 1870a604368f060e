"""The shipped priors, read and checked."""

from __future__ import annotations

import math
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from .priors import WIDTH_95, Prior, Priors

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


def _prior(row: _Row) -> Prior:
    if row.scale == "log":
        return Prior.log(row.name, row.unit, row.median, row.low, row.high, row.mechanism, row.source)
    if row.scale == "linear":
        return Prior.normal(row.name, row.unit, row.median, (row.high - row.low) / WIDTH_95, row.mechanism, row.source)
    ends = [math.log(end / (1.0 - end)) for end in (row.low, row.high)]
    return Prior.share(row.name, row.median, (ends[1] - ends[0]) / WIDTH_95, row.mechanism, row.source)
