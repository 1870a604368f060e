"""What ``thermicon validate`` says: rows that the constants were inferred from, and targets that they were not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from thermicon.icons.number_text import signed
from thermicon.perception.evidence.conditioning import Conditioning, experiment_title, suspected
from thermicon.perception.evidence.results import EDGE, UNMOVED_SD, PredictedRow
from thermicon.perception.evidence.targets import plain
from thermicon.perception.evidence.verdicts import value_text
from thermicon.perception.observer.channels import VARIABLES

from .blocks import Block, Bullets, Heading, Text, grid

if TYPE_CHECKING:
    from thermicon.perception.evidence.validate import Judged, Line, ValidationReport

TITLE = "Experiments the constants were inferred from"
ROW_UNITS = {"1": "", "0-100": "of 100"}
TARGET_HEADS = ("temp.", "flow")
HEADS = ("published", " temp.  flow", "left out, 95 %")
MARK = {"holds": "✓", "misses": "✗", "shown": " "}
KEY = (
    "± and 95 %: of what would be measured. temp., flow: fitted by receptors that respond to temperature and to "
    "heat flow. ✓ the published number is inside, ✗ it is not."
)
IN_LABEL = ("ln", "log10", "ln per decade")
"""Units that the name of a row says already."""


def validate_report(report: ValidationReport) -> list[Block]:
    """Report every number, published and predicted, and how many agree."""
    known = report.conditioning
    made: list[Block] = [Heading(TITLE, 1), Text(f"{summary_text(known)}\n{KEY}")]
    for key in dict.fromkeys(each.experiment for each in known.rows):
        rows = [_row(each) for each in known.rows if each.experiment == key]
        made += [Heading(heading(key)), grid(("", *HEADS), rows, HEADS, HEADS)]
    made += [
        Text("Left out, these rows are missed:"),
        Bullets(tuple(map(missed_text, known.missed))),
        Text(f"{unmoved_text(known)}\n{edge_text(known)}"),
    ]
    for section in report.sections:
        made.append(Heading(f"{section.target.number} {section.target.title}"))
        made.append(grid(("", "published", *TARGET_HEADS), map(_line, section.lines), TARGET_HEADS))
    held = [report.counts(k) for k in range(len(VARIABLES))]
    counted = ", ".join(f"{name} {a} of {b}" for name, (a, b) in zip(VARIABLES, held, strict=True))
    return [
        *made,
        Text(
            f"✓ holds, ✗ misses, no mark: shown and not judged. Hold: {counted}.\n"
            "temp.: receptors respond to temperature; flow: to heat flow. All are predictions, not measurements; rows "
            "marked fitted are among the experiments above. -o DIR writes constants, sources, intervals, sizes of the "
            "misses, what each mechanism is worth, suspected mechanisms and figures."
        ),
    ]


def _line(line: Line) -> Sequence[str]:
    """A row of a target: name with its unit, what was published, and each prediction with its verdict."""
    cells = [f"{_predicted(line, one)} {MARK[one.verdict.word]}" for one in line.judged]
    unit = "" if line.row.unit == line.published.unit else unit_text(line.row.unit)
    return (f"{line.row.label}{',' if unit else ''}{unit}", line.published.text, *cells)


def _predicted(line: Line, one: Judged) -> str:
    if one.predicted.value is None:
        return "not felt"
    return value_text(line.row, one.predicted.value, line.published)


def unit_text(unit: str) -> str:
    """Format the unit that follows a number; empty for pure numbers and proportions.

    >>> unit_text("s"), unit_text("proportion")
    (' s', '')
    """
    return "" if unit in ("", "1", "proportion") else f" {unit}"


def heading(key: str) -> str:
    """Name an experiment, with its key where there is open data under it.

    >>> heading("E3"), heading("wrist")
    ('E3: Method of limits on the forearm', 'Forced choice at the wrist')
    """
    title = experiment_title(key)
    return f"{key}: {title}" if key[1:].isdigit() else title


def summary_text(known: Conditioning) -> str:
    """State how many left-out rows are covered, and how wide the intervals are."""
    inside, rows = len(known.rows) - len(known.missed), len(known.rows)
    logs = sum(each.log for each in known.rows)
    factor, share = (known.median_half_width(log=log) for log in (True, False))
    return (
        f"Left out with its experiment, {inside} of {rows} published numbers lie inside the 95 % interval of their "
        f"prediction ({0.95 * rows:.0f} expected). Median interval: a factor {plain(factor)} either way for {logs} "
        f"rows on a log scale, ±{100 * share:.0f} % of the published number for the others. Fitted numbers say "
        "nothing of prediction. Intervals of published numbers contain their standard error and the discrepancy that "
        "the inference allows a model of this kind."
    )


def missed_text(row: PredictedRow) -> str:
    """State a missed row with its size and the mechanism suspected."""
    ends = f"{plain(row.left_out_low)} to {plain(row.left_out_high)}"
    return (
        f"{row.label.removesuffix(', both')} ({row.experiment}): published {plain(row.published)}, predicted "
        f"{plain(row.left_out)} [{ends}], {signed(row.score, '+.1f')} SD. Suspected: {suspected(row)}."
    )


def unmoved_text(known: Conditioning) -> str:
    """Name the constants that the evidence did not move."""
    names = ", ".join(each.name for each in known.unmoved)
    return f"Not moved (SD left above {UNMOVED_SD:g}), as good as assumed: {names or 'none'}."


def edge_text(known: Conditioning) -> str:
    """Name the constants at an edge of their prior."""
    names = "; ".join(
        f"{each.name} (upper {100 * (1.0 - each.quantile):.0f} %)"
        if each.quantile > 0.5
        else f"{each.name} (lower {100 * each.quantile:.0f} %)"
        for each in known.at_edge
    )
    return f"At an edge of the prior (outer {100 * EDGE:.0f} % at either end): {names or 'none'}."


def _row(row: PredictedRow) -> tuple[str, ...]:
    unit = "" if row.unit in IN_LABEL else ROW_UNITS.get(row.unit, row.unit)
    error = 0.5 * (row.published_high - row.published_low)
    label = row.label.removesuffix(", both")
    ends = f"{_short(row.left_out_low)}…{_short(row.left_out_high)}"
    return (
        f"{label}{f', {unit}' if unit else ''}",
        f"{_short(row.published)} ±{_short(error)}",
        "".join(f"{_short(value):>6}" for value in (row.fitted, row.heat_flow)),
        f"{_short(row.left_out)}, {ends} {'✓' if row.covered else '✗'}",
    )


def _short(value: float) -> str:
    """Two figures, as many as fit side by side.

    >>> _short(-0.0954), _short(1072.95), _short(1.0)
    ('−0.095', '1073', '1')
    """
    digits = 1 - math.floor(math.log10(abs(value))) if value else 0
    text = f"{value:.{max(digits, 0)}f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "−")
