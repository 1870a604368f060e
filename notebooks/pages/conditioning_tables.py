"""What the constants were inferred from, as tables for a terminal of 80 columns."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from thermicon.perception.inference.table_text import UNITS, number, signed
from thermicon.perception.validation.conditioning import ConditionedRow, Conditioning
from thermicon.perception.validation.magnitudes import CHANGES_K

from ..text.tables import show, table
from .conditioning_page import (
    NAMES,
    TITLE,
    ablated_name,
    edge_text,
    heading,
    magnitude_cells,
    missed_text,
    row_unit,
    stage_numbers,
    summary_text,
    unmoved_text,
)

if TYPE_CHECKING:
    from rich.table import Table

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
    for key in dict.fromkeys(each.row.experiment for each in known.rows):
        rows = table("", *HEADS, numbers=HEADS, names=HEADS)
        for each in known.rows:
            if each.row.experiment == key:
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


def _row(each: ConditionedRow) -> tuple[str, ...]:
    row = each.row
    unit = "" if row.unit in IN_LABEL else row_unit(row.unit)
    error = 0.5 * (row.published_high - row.published_low)
    label = row.label.removesuffix(", both")
    return (
        f"{label}{f', {unit}' if unit else ''}",
        f"{_short(row.published)} ±{_short(error)}",
        "".join(f"{_short(value):>6}" for value in (row.fitted, row.heat_flow)),
        f"{_short(row.left_out)}, {_both(row.left_out_low, row.left_out_high)} {'✓' if each.covered else '✗'}",
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
    for each in known.constants:
        constant = each.constant
        unit = UNITS.get(constant.unit, constant.unit)
        rows.add_row(
            f"{constant.name}{f', {unit}' if unit else ''}",
            number(constant.value),
            _both(constant.low, constant.high),
            _both(constant.prior_low, constant.prior_high),
            f"{constant.narrowed:.2f}{' =' if not each.moved else ' ↕' if each.at_edge else '  '}",
        )
    return rows


def _ablation(known: Conditioning) -> Table:
    rows = table("", "log evidence", "Σ(miss/SD)²", "worst row (SD)", numbers=("log evidence", "Σ(miss/SD)²"))
    for each in known.ablation:
        run = each.run
        worst = f"{run.worst} ({signed(run.worst_sd, 1)})"
        rows.add_row(ablated_name(each), signed(run.difference, 1), f"{run.squares:.1f}", worst)
    return rows


def _stages(known: Conditioning) -> Table:
    heads = ("skin, receptor", "nerve", "cord", "decision", "onset")
    rows = table("", "", *heads, numbers=heads)
    for each in known.stages:
        rows.add_row(each.icon, *stage_numbers(each))
    return rows
