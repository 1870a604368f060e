"""What the constants were inferred from, as tables for a terminal of 80 columns."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from thermicon.perception.evidence.conditioning import Conditioning, experiment_title, suspected
from thermicon.perception.evidence.magnitudes import CHANGES_K, OnsetStages
from thermicon.perception.evidence.results import EDGE, UNMOVED_SD, AblatedRow, Constant, PredictedRow
from thermicon.perception.evidence.table_text import UNITS, number, signed, span
from thermicon.perception.observer.variants import VARIABLES

from .tables import show, table

if TYPE_CHECKING:
    from rich.table import Table

NAMES = VARIABLES
TITLE = "Experiments the constants were inferred from"
ROW_UNITS = {"1": "", "0-100": "of 100"}
FITTED = " temp.  flow"
HEADS = ("published", FITTED, "left out, 95 %")
KEY = (
    "± and 95 %: of what would be measured. temp., flow: fitted by receptors that respond to temperature and to "
    "heat flow. ✓ the published number is inside, ✗ it is not."
)
MARKS = "= not moved by the evidence, ↕ at an edge of the prior."
IN_LABEL = ("ln", "log10", "ln per decade")
"""Units that the name of a row says already."""


def show_conditioning(known: Conditioning) -> None:
    """Print rows, misses, constants, ablation, onsets and sizes."""
    show(TITLE, summary_text(known), KEY, "")
    for key in dict.fromkeys(each.experiment for each in known.rows):
        rows = table("", *HEADS, numbers=HEADS, names=HEADS)
        for each in known.rows:
            if each.experiment == key:
                rows.add_row(*_row(each))
        show(heading(key), rows, "")
    show("Left out, these rows are missed:", *(f"  - {missed_text(each)}" for each in known.missed), "")
    show("Constants", _constants(known), MARKS, unmoved_text(known), edge_text(known), "")
    show("What each mechanism is worth (differences of log evidence under 2 say nothing)", _ablation(known), "")
    show("Onsets of the six icons by stage, s", _stages(known), "")
    sizes = table("", *NAMES)
    for channel, cells in magnitude_cells(known).items():
        sizes.add_row(channel, *cells)
    show(f"Peak d′ of a change by {CHANGES_K[0]:g} K, and just noticeable steps to {CHANGES_K[1]:g} K", sizes, "")


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
        f"prediction ({0.95 * rows:.0f} expected). Median interval: a factor {number(factor)} either way for {logs} "
        f"rows on a log scale, ±{100 * share:.0f} % of the published number for the others. Fitted numbers say "
        "nothing of prediction. Intervals of published numbers contain their standard error and the discrepancy that "
        "the inference allows a model of this kind."
    )


def missed_text(row: PredictedRow) -> str:
    """State a missed row with its size and the mechanism suspected."""
    return (
        f"{row.label.removesuffix(', both')} ({row.experiment}): published {number(row.published)}, predicted "
        f"{number(row.left_out)} [{span(row.left_out_low, row.left_out_high)}], {signed(row.score, 1)} SD. Suspected: "
        f"{suspected(row)}."
    )


def unmoved_text(known: Conditioning) -> str:
    """Name the constants that the evidence did not move."""
    names = ", ".join(each.name for each in known.unmoved)
    return f"Not moved (SD left above {UNMOVED_SD:g}), as good as assumed: {names or 'none'}."


def edge_text(known: Conditioning) -> str:
    """Name the constants at an edge of their prior."""
    names = "; ".join(
        f"{each.name} ({'upper' if each.quantile > 0.5 else 'lower'} {100 * tail(each):.0f} %)"
        for each in known.at_edge
    )
    return f"At an edge of the prior (outer {100 * EDGE:.0f} % at either end): {names or 'none'}."


def tail(each: Constant) -> float:
    """Share of the prior beyond the value, at the nearer end."""
    return min(each.quantile, 1.0 - each.quantile)


def ablated_name(run: AblatedRow) -> str:
    """Name a run: the mechanism that was taken out, or the variant."""
    if run.without:
        return f"without {run.without}"
    return run.variable if run.difference else f"{run.variable} (the whole observer)"


def stage_numbers(stages: OnsetStages) -> tuple[str, ...]:
    """Format the stages of an onset, s, in the order of the table."""
    seconds = (stages.receptor_s, stages.nerve_s, stages.cord_s, stages.decision_s, stages.onset_s)
    return (stages.channel, *(f"{each:.2f}" for each in seconds))


def magnitude_cells(known: Conditioning) -> dict[str, tuple[str, ...]]:
    """Format peak d′ and just noticeable steps of every variant, by channel."""
    small, large = CHANGES_K
    cells: dict[str, tuple[str, ...]] = {}
    for each in known.magnitudes:
        text = f"{small:g} K: d′ {each.peaks[0]:.1f}; {large:g} K: {each.jnds} steps"
        cells[each.channel] = (*cells.get(each.channel, ()), text)
    return cells


def row_unit(unit: str) -> str:
    """Format the unit of a row of the evidence; empty for pure numbers."""
    return ROW_UNITS.get(unit, unit)


def _row(row: PredictedRow) -> tuple[str, ...]:
    unit = "" if row.unit in IN_LABEL else row_unit(row.unit)
    error = 0.5 * (row.published_high - row.published_low)
    label = row.label.removesuffix(", both")
    return (
        f"{label}{f', {unit}' if unit else ''}",
        f"{_short(row.published)} ±{_short(error)}",
        "".join(f"{_short(value):>6}" for value in (row.fitted, row.heat_flow)),
        f"{_short(row.left_out)}, {_both(row.left_out_low, row.left_out_high)} {'✓' if row.covered else '✗'}",
    )


def _short(value: float) -> str:
    """Two figures, as many as fit side by side.

    >>> _short(-0.0954), _short(1072.95), _short(1.0)
    ('−0.095', '1073', '1')
    """
    digits = 1 - math.floor(math.log10(abs(value))) if value else 0
    text = f"{value:.{max(digits, 0)}f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "−")


def _both(low: float, high: float) -> str:
    return f"{_short(low)}…{_short(high)}"


def _constants(known: Conditioning) -> Table:
    rows = table("", "value", "95 %", "prior 95 %", "SD left", numbers=("value", "95 %", "prior 95 %", "SD left"))
    for constant in known.constants:
        unit = UNITS.get(constant.unit, constant.unit)
        rows.add_row(
            f"{constant.name}{f', {unit}' if unit else ''}",
            number(constant.value),
            _both(constant.low, constant.high),
            _both(constant.prior_low, constant.prior_high),
            f"{constant.narrowed:.2f}{' =' if not constant.moved else ' ↕' if constant.at_edge else '  '}",
        )
    return rows


def _ablation(known: Conditioning) -> Table:
    rows = table("", "log evidence", "Σ(miss/SD)²", "worst row (SD)", numbers=("log evidence", "Σ(miss/SD)²"))
    for run in known.ablation:
        worst = f"{run.worst} ({signed(run.worst_sd, 1)})"
        rows.add_row(ablated_name(run), signed(run.difference, 1), f"{run.squares:.1f}", worst)
    return rows


def _stages(known: Conditioning) -> Table:
    heads = ("skin, receptor", "nerve", "cord", "decision", "onset")
    rows = table("", "", *heads, numbers=heads)
    for each in known.stages:
        rows.add_row(each.icon, *stage_numbers(each))
    return rows
