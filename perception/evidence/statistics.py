"""Published statistics as data: what was measured, with standard errors and conditions; no trial data.

`data/evidence.csv` has one row a statistic and `data/evidence.toml` one table an experiment.
"""

from __future__ import annotations

import csv
import math
import tomllib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from thermicon.circuit.records import RecordError
from thermicon.icons.near_words import did_you_mean

DATA = Path(__file__).parents[1] / "data"


def _blank_is_none(text: object) -> object:
    return None if text == "" else text


Number = Annotated[float | None, BeforeValidator(_blank_is_none)]


class Statistic(BaseModel):
    """One published number. On a log scale `value` is a geometric mean and `se` is in natural-log units."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    experiment: str = Field(min_length=1)
    statistic: str = Field(min_length=1)
    channel: Literal["cold", "warm", "both"]
    value: float
    se: float = Field(ge=0.0)
    unit: str
    scale: Literal["linear", "log"]
    n_people: Number
    n_trials: Number
    between_people_sd: Number
    site: str
    area_cm2: str
    baseline_C: Number
    rate_K_per_s: str
    stimulus: str

    @property
    def place(self) -> float:
        """The value on its own scale: its natural logarithm where that is the scale."""
        return math.log(self.value) if self.scale == "log" else self.value


class Experiment(BaseModel):
    """Where an experiment was published, under which licence, and how it asked."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    key: str = Field(min_length=1)
    title: str
    citation: str = Field(min_length=1)
    repository: str
    commit: str
    licence: str
    method: str
    notes: str


@dataclass(frozen=True, slots=True)
class Evidence:
    """All published statistics and the experiments that they come from.

    >>> evidence = load_evidence()
    >>> evidence.find("E3", "threshold_gm", "warm").value
    1.859
    """

    statistics: tuple[Statistic, ...]
    experiments: tuple[Experiment, ...]

    def find(self, experiment: str, statistic: str, channel: str) -> Statistic:
        """One statistic; a RecordError names the nearest where it is not there."""
        for row in self.statistics:
            if (row.experiment, row.statistic, row.channel) == (experiment, statistic, channel):
                return row
        near = did_you_mean(statistic, {row.statistic for row in self.statistics if row.experiment == experiment})
        raise RecordError(f"evidence.csv: experiment {experiment!r} has no statistic {statistic!r} ({channel}): {near}")

    def experiment(self, key: str) -> Experiment:
        """One experiment by its key."""
        for each in self.experiments:
            if each.key == key:
                return each
        raise RecordError(
            f"evidence.toml: no experiment {key!r}; there are {', '.join(e.key for e in self.experiments)}"
        )


@lru_cache(maxsize=1)
def load_evidence() -> Evidence:
    """The shipped evidence."""
    return read_evidence(DATA / "evidence.csv", DATA / "evidence.toml")


def read_evidence(statistics: Path, experiments: Path) -> Evidence:
    """Evidence from a table of statistics and a file of experiments; raises RecordError with row and column."""
    known = tuple(Experiment.model_validate(row) for row in tomllib.loads(experiments.read_text("utf-8"))["experiment"])
    keys = {each.key for each in known}
    rows = []
    with statistics.open(encoding="utf-8", newline="") as file:
        for line, row in enumerate(csv.DictReader(file), start=2):
            try:
                rows.append(Statistic.model_validate(row))
            except ValidationError as fault:
                first = fault.errors()[0]
                column = ".".join(str(part) for part in first["loc"])
                raise RecordError(f"{statistics.name}, line {line}: {column}: {first['msg']}") from None
            if rows[-1].experiment not in keys:
                raise RecordError(f"{statistics.name}, line {line}: {experiments.name} has no {rows[-1].experiment!r}")
    return Evidence(tuple(rows), known)
