"""Forms of memory compared on published identification, which no constant was inferred from.

Each form predicts the six icons and the three waveforms with the draws of its constants; its log score is the log
density of what was published. ``python -m thermicon.perception.validation.memory_forms`` writes the shipped table.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from statistics import NormalDist

import numpy as np

from thermicon.circuit import Rig

from ..observer.channels import NORMS, Norm
from ..observer.observer import DATA
from .evidence import SIX
from .identified import show, six_icons, wave_shapes
from .predicted import Predicted
from .targets import Row, load_targets
from .waves import LIBRARY, likeness, skin_waves, with_others

FORMS_TABLE = "memory_forms.csv"
PEOPLE, DRAWS, TRIALS = 200, 64, 48
NUMBERS = ("proportion correct", "plug-in information")
"""Published numbers of the six icons; the intervals of targets.toml are taken as 95 %."""
MAIN_CONFUSIONS = (
    "confusion of square and sine over any other",
    "confusion of square and triangle over any other",
    "confusion of sine and triangle over any other",
)
"""Published as the main confusions: more than twice as often as with any other icon."""


@dataclass(frozen=True, slots=True)
class FormScore:
    """One published row as one form of memory predicts it: value, 95 % of draws, and log score."""

    norm: Norm
    row: str
    published: str
    predicted: float
    low: float
    high: float
    log_score: float


def compare_forms(
    people: int = PEOPLE, draws: int = DRAWS, seed: int = 0, norms: Sequence[Norm] = NORMS
) -> tuple[FormScore, ...]:
    """Scores of forms of memory on every judged row of the six icons and the waveforms.

    Rows of one experiment share its people, so that scores of the two numbers of the six icons are not independent.
    """
    from thermicon.icons import load_library

    rig, library = Rig.load("thenar"), load_library(SIX)
    alike = likeness(skin_waves(rig))
    six = show(library, rig, people, seed)
    waves = show(with_others(load_library(LIBRARY), library), rig, people, seed)
    published = {row.quantity: row for target in load_targets() for row in target.rows if row.judged}
    scores = []
    for norm in norms:
        found = (
            *six_icons(six.identify("temperature", "adapting", draws, norm), TRIALS, seed),
            *wave_shapes(waves.identify("temperature", "adapting", draws, norm), alike),
        )
        predicted = {one.quantity: one for one in found}
        for quantity in NUMBERS:
            scores.append(_number(norm, predicted[quantity], published[quantity]))
        for quantity in MAIN_CONFUSIONS:
            scores.append(_event(norm, predicted[quantity], published[quantity]))
    return tuple(scores)


def _number(norm: Norm, predicted: Predicted, row: Row) -> FormScore:
    """The published number has a normal error; the draws are taken as normal too."""
    low, high = row.low or 0.0, row.high or 1.0
    middle, error = 0.5 * (low + high), (high - low) / (2.0 * 1.96)
    draws = np.array(predicted.draws)
    sd = math.hypot(float(draws.std(ddof=1)), error)
    score = math.log(NormalDist(float(draws.mean()), sd).pdf(middle))
    ends = np.percentile(draws, [2.5, 97.5]).tolist()
    said = f"{middle:.3g} [{low:.3g}, {high:.3g}]"
    return FormScore(norm, predicted.quantity, said, float(predicted.value or 0.0), *ends, score)


def _event(norm: Norm, predicted: Predicted, row: Row) -> FormScore:
    """Share of draws in which it happens, with half a draw for either side."""
    least = row.value or 1.0
    draws = np.array(predicted.draws)
    share = (float((draws >= least).sum()) + 0.5) / (draws.size + 1.0)
    ends = np.percentile(draws, [2.5, 97.5]).tolist()
    return FormScore(
        norm, predicted.quantity, f"at least {least:g}", float(predicted.value or 0.0), *ends, math.log(share)
    )


def totals(scores: Sequence[FormScore]) -> dict[Norm, float]:
    """Log score of each form over all rows."""
    return {norm: sum(one.log_score for one in scores if one.norm == norm) for norm in {one.norm: 0 for one in scores}}


def to_csv(scores: Sequence[FormScore]) -> str:
    """The table as text."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([field.name for field in fields(FormScore)])
    for one in scores:
        numbers = [f"{value:.4g}" for value in (one.predicted, one.low, one.high, one.log_score)]
        table.writerow([one.norm, one.row, one.published, *numbers])
    return text.getvalue()


def load_forms() -> tuple[FormScore, ...]:
    """The shipped table."""
    with (DATA / FORMS_TABLE).open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return tuple(
        FormScore(
            row["norm"],
            row["row"],
            row["published"],
            *(float(row[name]) for name in ("predicted", "low", "high", "log_score")),
        )
        for row in rows
    )


def main() -> None:
    """Write the shipped table."""
    head = f"# written by python -m thermicon.perception.validation.memory_forms, {PEOPLE} people, {DRAWS} draws\n"
    (DATA / FORMS_TABLE).write_text(head + to_csv(compare_forms()), encoding="utf-8")


if __name__ == "__main__":
    main()
