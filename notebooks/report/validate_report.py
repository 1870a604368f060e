"""The report of ``thermicon validate``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import signed
from thermicon.perception.evidence.results import (
    PredictedRow,
    judging_predictions,
    load_missed,
    load_predictions,
    median_half_width,
)
from thermicon.perception.evidence.targets import plain
from thermicon.perception.evidence.verdicts import value_text
from thermicon.perception.observer.channels import VARIABLES

from .blocks import Block, Bullets, Heading, Text, grid

if TYPE_CHECKING:
    from thermicon.perception.evidence.validate import JudgedRow, ReportRow, ValidationReport

TITLE = "Experiments the constants were inferred from"
TARGET_HEADS = ("temp.", "flow", "skin")
MARK = {"holds": "✓", "misses": "✗", "shown": " "}


def validate_report(report: ValidationReport) -> list[Block]:
    """Report every number, published and predicted, and how many agree."""
    made: list[Block] = [
        Heading(TITLE, 1),
        Text(f"{summary_text()}\nLeft out, these rows are missed:"),
        Bullets(tuple(map(missed_text, load_missed()))),
    ]
    for section in report.sections:
        made.append(Heading(f"{section.target.number} {section.target.title}"))
        made.append(grid(("", "published", *TARGET_HEADS, "nearer"), map(_line, section.lines), TARGET_HEADS))
    held = [report.counts(k) for k in range(len(VARIABLES))]
    nearer = report.nearer()
    counted = ", ".join(f"{name} {a} of {b}" for name, (a, b) in zip(VARIABLES, held, strict=True))
    return [
        *made,
        Text(
            f"✓ holds, ✗ misses, no mark: shown and not judged; with the share of draws in which the row holds where "
            f"more than a fifth of them say otherwise. Hold: {counted}.\n"
            f"nearer: to what was published. Of {sum(nearer.values())} results that were not fitted and that skin "
            f"temperature predicts too, the model (temp.) is nearer to {nearer['model']}, skin temperature to "
            f"{nearer['baseline']}; {nearer['both']} are equal.\n"
            "temp.: receptors respond to temperature; flow: to heat flow; skin: the baseline, who goes by the "
            "temperature of the skin alone. All are predictions, not measurements; rows marked fitted are among the "
            "experiments above. --json has every number, with sources and intervals."
        ),
    ]


def _line(line: ReportRow) -> Sequence[str]:
    """A row of a target: name with its unit, what was published, and each prediction with its verdict."""
    cells = [f"{_predicted(line, one)} {MARK[one.verdict.word]}{_share(one)}" for one in line.judged]
    unit = "" if line.row.unit in (line.published.unit, "", "1", "proportion") else f", {line.row.unit}"
    skin = "–" if line.baseline is None else plain(line.baseline)
    return line.row.label + unit, line.published.text, *cells, skin, line.nearer_to_published


def _predicted(line: ReportRow, one: JudgedRow) -> str:
    if one.predicted.value is None:
        return "not felt"
    return value_text(line.row, one.predicted.value, line.published)


def _share(one: JudgedRow) -> str:
    """Share of the draws in which a row on a knife edge holds."""
    return f" {100 * one.held:.0f} %" if one.held is not None and one.knife_edge else ""


def summary_text() -> str:
    """State how many left-out rows are covered, and how wide the intervals are."""
    known, spreads = judging_predictions(), [case for case in load_predictions() if case.row.kind == "spread"]
    inside, rows = sum(case.covered for case in known), len(known)
    logs = sum(case.log for case in known)
    factor, share = (median_half_width(log=log) for log in (True, False))
    return (
        f"Left out with its experiment, {inside} of {rows} published numbers lie inside the 95 % interval of their "
        f"prediction ({0.95 * rows:.0f} expected). Median interval: a factor {plain(factor)} either way for {logs} "
        f"rows on a log scale, ±{100 * share:.0f} % of the published number for the others. Fitted numbers do "
        "not test prediction. Intervals of published numbers contain their standard error and the discrepancy that "
        "the inference allows a model of this kind; that of spreads was chosen on such rows, so that they do not count "
        f"({sum(case.covered for case in spreads)} of {len(spreads)} inside)."
    )


def missed_text(row: PredictedRow) -> str:
    """State a missed row with its size and the mechanism suspected."""
    ends = f"{plain(row.left_out_low)} to {plain(row.left_out_high)}"
    return (
        f"{row.label.removesuffix(', both')} ({row.experiment}): published {plain(row.published)}, predicted "
        f"{plain(row.left_out)} [{ends}], {signed(row.score, '+.1f')} SD. Suspected: {row.suspected}."
    )
