"""The shipped results of the inference as CSV tables.

A test checks that they belong to the shipped evidence and priors; the ablation says by which version it was made.
"""

import csv
import hashlib
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from io import StringIO
from pathlib import Path
from statistics import median
from typing import Any

from ..observer.channels import Variable
from ..observer.observer import DATA
from ..observer.priors import WITHIN_95, load_priors
from .rows import Row, load_evidence, load_rows

UNMOVED_SD = 0.9
"""A constant that keeps more of its prior's SD was hardly moved by the evidence."""
CONSTANTS, PREDICTIONS, ABLATION = "constants.csv", "predictions.csv", "ablation.csv"
SPANS = "spans.csv"


@dataclass(frozen=True, slots=True)
class Constant:
    """One constant at its maximum with 95 % intervals; `narrowed` is the SD over the prior's (1: nothing learnt)."""

    variable: str
    name: str
    unit: str
    value: float
    low: float
    high: float
    prior_low: float
    prior_high: float
    narrowed: float
    mechanism: str
    source: str


@dataclass(frozen=True, slots=True)
class OfRow:
    """A result for a row of the likelihood."""

    experiment: str
    statistic: str
    channel: str

    @property
    def row(self) -> Row:
        """The row of the likelihood."""
        key = self.experiment, self.statistic, self.channel
        return next(row for row in load_rows() if row.key == key)


@dataclass(frozen=True, slots=True)
class PredictedRow(OfRow):
    """A published number with its 95 % interval, fitted by each variant, and predicted without its experiment."""

    label: str
    unit: str
    published: float
    published_low: float
    published_high: float
    fitted: float
    heat_flow: float
    left_out: float
    left_out_low: float
    left_out_high: float
    score: float
    log_score: float

    @property
    def log(self) -> bool:
        """Whether it is judged on a log scale."""
        return self.row.log

    @property
    def covered(self) -> bool:
        """Whether the 95 % interval of what would be measured, left out, contains what was."""
        return abs(self.score) <= WITHIN_95

    @property
    def half_width(self) -> float:
        """Half the 95 % interval: a factor above 1 on a log scale, otherwise a share of the published number."""
        low, high = self.left_out_low, self.left_out_high
        return math.sqrt(high / low) if self.log else 0.5 * (high - low) / abs(self.published)

    @property
    def suspected(self) -> str:
        """The mechanism behind a miss; nothing where the row is covered."""
        known = load_evidence().suspected
        return "" if self.covered else known.get((self.experiment, self.statistic, self.channel), "none named yet")


@dataclass(frozen=True, slots=True)
class AblatedRow:
    """A variant without a mechanism; a `difference` of log evidence to the whole under about 2 says nothing."""

    variable: str
    without: str
    log_evidence: float
    difference: float
    squares: float
    worst: str
    worst_sd: float
    replaced_by: str
    sources: str


def load_constants(variable: Variable = "temperature") -> tuple[Constant, ...]:
    """Constants of a variant at its maximum."""
    return tuple(row for row in read_rows(CONSTANTS, Constant) if row.variable == variable)


def load_predictions() -> tuple[PredictedRow, ...]:
    """Predictions of every row, in the fit and out of it."""
    return tuple(read_rows(PREDICTIONS, PredictedRow))


def load_missed() -> tuple[PredictedRow, ...]:
    """Rows outside of their interval when left out, the worst first."""
    return tuple(sorted((row for row in load_predictions() if not row.covered), key=lambda row: -abs(row.score)))


def judging_predictions() -> tuple[PredictedRow, ...]:
    """Predictions of the rows by which coverage is judged."""
    return tuple(each for each in load_predictions() if each.row.judges)


def median_half_width(*, log: bool) -> float:
    """Median of the half widths of these rows on one scale."""
    return median(each.half_width for each in judging_predictions() if each.log == log)


def load_ablation() -> tuple[AblatedRow, ...]:
    """The worth of each mechanism."""
    return tuple(read_rows(ABLATION, AblatedRow))


def write_rows(rows: Sequence[Any], name: str, folder: Path = DATA) -> None:
    """Write frozen rows of one kind as a table, numbers to six figures, below what it was made from."""
    text = StringIO()
    writer = csv.DictWriter(text, [field.name for field in fields(rows[0])], lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in asdict(row).items()})
    head = f"# written by python -m thermicon.perception.evidence from inputs {inputs_digest()}\n"
    (folder / name).write_text(head + text.getvalue(), encoding="utf-8")


def inputs_digest() -> str:
    """Hash of everything that was conditioned on, rows and priors; the first line of every table ends with it."""
    return hashlib.sha256(repr((load_rows(), load_priors())).encode()).hexdigest()[:16]


def read_rows(name: str, kind: Any) -> Iterable[Any]:
    """Rows of a shipped table as frozen rows of a kind."""
    with (DATA / name).open(encoding="utf-8", newline="") as file:
        file.readline()
        types = {field.name: field.type for field in fields(kind)}
        for row in csv.DictReader(file):
            yield kind(**{k: float(v) if types[k] in (float, "float") else v for k, v in row.items()})
