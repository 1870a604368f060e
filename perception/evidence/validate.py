"""The validation report: every published target beside its prediction.

No count of passes is aimed at: a miss with its size and the mechanism suspected is a result.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from thermicon.base.checks.arguments import checked
from thermicon.base.files.records import RecordTable
from thermicon.base.results.drawn import Tabled

from ..identification.new_laboratory import DRAWS
from ..observer.channels import VARIABLES, Variable
from ..observer.observer import load_thresholds
from .baseline import nearer_of
from .predicted import Predicted, interval_of
from .targets import PAIRED, Published, Target, TargetRow, combined, load_targets, published_for
from .verdicts import Verdict, judge_row

if TYPE_CHECKING:
    from ..kernels.parallel import Progress
    from .shown import ShownEvidence

PEOPLE, TRIALS = 200, 48
SURE = 0.8
"""Share of the draws that must agree with a verdict; below it the row stands on a knife edge."""


@dataclass(frozen=True, slots=True)
class JudgedRow:
    """A row as one variant predicts it, the verdict, and the share of draws in which it holds (None: not judged)."""

    predicted: Predicted
    verdict: Verdict
    held: float | None

    @property
    def knife_edge(self) -> bool:
        """Whether many of the draws disagree with the verdict."""
        return self.held is not None and abs(self.held - float(self.verdict.holds is False)) < SURE


@dataclass(frozen=True, slots=True)
class ReportRow:
    """A row of the report: what was published, and the judgement of every variant in the order of VARIABLES."""

    row: TargetRow
    published: Published
    judged: tuple[JudgedRow, ...]

    @property
    def baseline(self) -> float | None:
        """The prediction from skin temperature alone; None where there is none."""
        return self.judged[0].predicted.baseline

    @property
    def nearer_to_published(self) -> str:
        """Which of model (the default variant) and baseline is nearer, as `nearer_of` says."""
        return nearer_of(self.row, self.judged[0].predicted.value, self.baseline, self.published)


@dataclass(frozen=True, slots=True)
class Section:
    """One target with its lines."""

    target: Target
    lines: tuple[ReportRow, ...]


@dataclass(frozen=True, slots=True)
class ValidationReport(Tabled):
    """Everything that the validation report shows.

    Attributes
    ----------
    version
        Version of the program.
    people, draws, seed, trials
        Arguments of the run.
    sections
        Targets with their verdicts.
    evidence
        Curves and answers behind the figures.

    See Also
    --------
    validate : Returns the report.
    """

    version: str
    people: int
    draws: int
    seed: int
    trials: int
    sections: tuple[Section, ...]
    evidence: ShownEvidence

    def counts(self, variant: int) -> tuple[int, int]:
        """The number of judged rows that hold for a variant, and of all."""
        held = [line.judged[variant].verdict.holds for s in self.sections for line in s.lines if line.row.judged]
        return sum(one is True for one in held), len(held)

    def nearer(self) -> dict[str, int]:
        """How often model, baseline and both are nearest to a published result that was not fitted."""
        lines = [line for s in self.sections for line in s.lines if not line.published.fitted]
        return {who: sum(line.nearer_to_published == who for line in lines) for who in ("model", "baseline", "both")}

    def rows(self) -> list[dict[str, Any]]:
        """Return one row per published result and variable that receptors may respond to.

        `published` is the number in `unit`, where it is of the same quantity; `low` to `high` is the 95 % interval.
        """
        return [
            {"target": f"{section.target.number} {section.target.title}", "row": line.row.label,
             "variable": one.predicted.variable, "unit": line.row.unit, "fitted": line.published.fitted,
             "published": line.published.value if line.published.unit == line.row.unit else None,
             **{name: getattr(one.predicted, name) for name in ("value", "low", "high", "baseline")},
             "nearer": line.nearer_to_published, "verdict": one.verdict.word, "held_in_draws": one.held,
             "said": one.verdict.text, "suspected": section.target.mechanism}
            for section in self.sections for line in section.lines for one in line.judged
        ]  # fmt: skip

    def to_dict(self) -> dict[str, Any]:
        """Return every number, as `thermicon validate --json` writes it."""
        from .validate_file import report_file

        return report_file(self)

    def __repr__(self) -> str:
        said = ", ".join("{} {} of {}".format(variant, *self.counts(k)) for k, variant in enumerate(VARIABLES))
        return f"ValidationReport({len(self.sections)} targets; hold: {said}; {self.draws} draws, {self.people} people)"


@checked
def validate(
    *, people: int = PEOPLE, draws: int = DRAWS, seed: int = 0, trials: int = TRIALS, progress: Progress | None = None
) -> ValidationReport:
    """Predict every published target and judge it; the same arguments give the same report.

    Parameters
    ----------
    people
        Number of virtual people behind spreads between persons.
    draws
        Number of plausible observers behind intervals; 0: none.
    seed
        Seed of people and observers.
    trials
        Length of the identification experiment.
    progress
        Called with (steps done, steps in all).

    Returns
    -------
    ValidationReport
        Every target, predicted beside published.

    Raises
    ------
    ValueError
        For no people, and a single draw.

    Examples
    --------
    >>> validate(people=0)
    Traceback (most recent call last):
    ...
    thermicon.base.checks.arguments.InputError: ...
    """
    from .shown import collect_evidence

    if people < 2:
        raise ValueError(f"a spread between persons needs at least two of them, not {people}")
    if draws < 0 or draws == 1:
        raise ValueError(f"an interval needs at least two draws, or 0 for none, not {draws}")
    evidence = collect_evidence(people, draws, seed, trials, progress)
    return assemble(evidence, load_thresholds(), people, draws, seed, trials)


def assemble(
    evidence: ShownEvidence, table: RecordTable, people: int, draws: int, seed: int, trials: int
) -> ValidationReport:
    """Judge evidence that is there already by a table of published numbers."""
    from thermicon.base.numbers.program import own_version

    sections = []
    for target in load_targets():
        lines = []
        for row in target.rows:
            was = published_for(row, table)
            lines.append(ReportRow(row, was, tuple(judged(row, was, table, evidence, each) for each in VARIABLES)))
        sections.append(Section(target, tuple(lines)))
    return ValidationReport(own_version(), people, draws, seed, trials, tuple(sections), evidence)


def judged(row: TargetRow, was: Published, table: RecordTable, shown: ShownEvidence, by: Variable) -> JudgedRow:
    """A row as one variant predicts it; a ValueError where nothing predicts it."""

    def found(channel: str) -> Predicted:
        return shown.find(by, row.experiment, row.quantity, channel, row.predicted_where)

    if row.apply in PAIRED:
        prediction = _both(row, found("cold"), found("warm"))
    else:
        prediction = found(row.channel)
        if row.apply:
            factor = table.one(row.times).central if row.apply == "times" else -1.0 if row.apply == "negative" else 1.0
            prediction = _linear(prediction, factor, 1.0 if row.apply == "one plus" else 0.0)
    prediction = replace(prediction, unit=row.unit)
    held = [judge_row(row, each, was).holds is True for each in prediction.draws] if row.judged else []
    return JudgedRow(prediction, judge_row(row, prediction.value, was), sum(held) / len(held) if held else None)


def _both(row: TargetRow, cold: Predicted, warm: Predicted) -> Predicted:
    """One prediction of two channels; None or inf where one of them was not felt."""
    value = None if cold.value is None or warm.value is None else combined(row.apply, cold.value, warm.value)
    each = tuple(
        combined(row.apply, one, other) if math.isfinite(one) and math.isfinite(other) else math.inf
        for one, other in zip(cold.draws, warm.draws, strict=True)
    )
    low, high = interval_of(each)
    skin = None if cold.baseline is None or warm.baseline is None else combined(row.apply, cold.baseline, warm.baseline)
    return replace(cold, channel="both", value=value, low=low, high=high, draws=each, baseline=skin)


def _linear(one: Predicted, times: float, plus: float) -> Predicted:
    """A prediction times a number, and more."""

    def moved(value: float | None) -> float | None:
        return None if value is None else times * value + plus if math.isfinite(value) else math.inf

    low, high = (moved(one.low), moved(one.high)) if times > 0.0 else (moved(one.high), moved(one.low))
    draws = tuple(times * each + plus if math.isfinite(each) else math.inf for each in one.draws)
    return replace(one, value=moved(one.value), low=low, high=high, draws=draws, baseline=moved(one.baseline))
