"""The part of the validation page that shows what the constants were inferred from."""

from __future__ import annotations

from collections.abc import Iterator

from thermicon.perception.inference.onset_stages import OnsetStages
from thermicon.perception.inference.results import UNMOVED_SD
from thermicon.perception.inference.table_text import UNITS, number, signed, span
from thermicon.perception.observer.variants import VARIABLES
from thermicon.perception.validation.comparisons import experiment_title
from thermicon.perception.validation.conditioning import (
    EDGE,
    AblatedMechanism,
    ConditionedRow,
    Conditioning,
    InferredConstant,
)
from thermicon.perception.validation.magnitudes import CHANGES_K

from .blocks import Bullets, Cell, Grid, Heading, MarkdownBlock, Text, grid

NAMES = VARIABLES
TITLE = "Experiments the constants were inferred from"
ROW_UNITS = {"1": "", "0-100": "of 100"}


def conditioning_blocks(known: Conditioning) -> Iterator[MarkdownBlock]:
    """Yield the section: rows, misses, constants, ablation, onsets and sizes."""
    yield Heading(TITLE)
    yield Text(summary_text(known))
    head = ("row", "published [95 %]", *(f"fitted, {name}" for name in NAMES), "left out [95 %]", "miss (SD)")
    for key in dict.fromkeys(each.row.experiment for each in known.rows):
        yield Heading(heading(key), 3)
        yield Grid(head, tuple(_row(each) for each in known.rows if each.row.experiment == key))
    yield Heading("Rows that are missed, and the mechanism suspected", 3)
    yield Bullets(tuple(missed_text(each) for each in known.missed))
    yield Heading("Constants", 3)
    yield Text(unmoved_text(known))
    yield Text(edge_text(known))
    yield grid(
        ("constant", "value", "95 %", "prior 95 %", "SD left", "place in prior", ""),
        [_constant(each) for each in known.constants],
    )
    yield Heading("What each mechanism is worth", 3)
    yield Text(
        "Log evidence against the whole observer when a mechanism is replaced and the constants are inferred again; "
        "differences under 2 say nothing."
    )
    yield grid(
        ("observer", "in its place", "log evidence", "Σ(miss/SD)²", "worst row (SD)", "sources"),
        [_ablated(each) for each in known.ablation],
    )
    yield Heading("Onsets of the six icons by stage, and sizes of sensations", 3)
    yield grid(("icon", *STAGES), [(s.icon, *stage_numbers(s)) for s in known.stages])
    yield grid(("channel", *NAMES), [(channel, *cells) for channel, cells in magnitude_cells(known).items()])


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


def missed_text(each: ConditionedRow) -> str:
    """State a missed row with its size and the mechanism suspected."""
    row = each.row
    return (
        f"{row.label.removesuffix(', both')} ({row.experiment}): published {number(row.published)}, predicted "
        f"{number(row.left_out)} [{span(row.left_out_low, row.left_out_high)}], {signed(row.score, 1)} SD. Suspected: "
        f"{each.suspected}."
    )


def unmoved_text(known: Conditioning) -> str:
    """Name the constants that the evidence did not move."""
    names = ", ".join(each.constant.name for each in known.unmoved)
    return f"Not moved (SD left above {UNMOVED_SD:g}), as good as assumed: {names or 'none'}."


def edge_text(known: Conditioning) -> str:
    """Name the constants at an edge of their prior."""
    names = "; ".join(
        f"{each.constant.name} ({'upper' if each.quantile > 0.5 else 'lower'} {100 * tail(each):.0f} %)"
        for each in known.at_edge
    )
    return f"At an edge of the prior (outer {100 * EDGE:.0f} % at either end): {names or 'none'}."


def tail(each: InferredConstant) -> float:
    """Share of the prior beyond the value, at the nearer end."""
    return min(each.quantile, 1.0 - each.quantile)


def ablated_name(each: AblatedMechanism) -> str:
    """Name a run: the mechanism that was taken out, or the variant."""
    run = each.run
    if run.without:
        return f"without {run.without}"
    return run.variable if run.difference else f"{run.variable} (the whole observer)"


STAGES = ("channel", "skin, receptor", "nerve", "cord", "decision", "onset (s)")


def stage_numbers(stages: OnsetStages) -> tuple[str, ...]:
    """Format the stages of an onset, s, in the order of `STAGES`."""
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


def _row(each: ConditionedRow) -> tuple[Cell, ...]:
    row = each.row
    unit = row_unit(row.unit)
    published = f"{number(row.published)} [{span(row.published_low, row.published_high)}]"
    kind = "holds" if each.covered else "misses"
    return (
        Cell(f"{row.label.removesuffix(', both')}{f' ({unit})' if unit else ''}"),
        Cell(published),
        *(Cell(number(value)) for value in (row.fitted, row.heat_flow)),
        Cell(f"{number(row.left_out)} [{span(row.left_out_low, row.left_out_high)}]", kind),
        Cell(signed(row.score, 1)),
    )


def _constant(each: InferredConstant) -> tuple[str, ...]:
    constant = each.constant
    unit = UNITS.get(constant.unit, constant.unit)
    marks = [word for word, said in (("not moved", not each.moved), ("at an edge", each.at_edge)) if said]
    return (
        constant.name,
        f"{number(constant.value)} {unit}".strip(),
        span(constant.low, constant.high),
        span(constant.prior_low, constant.prior_high),
        f"{constant.narrowed:.2f}",
        f"{100 * each.quantile:.0f} %",
        ", ".join(marks),
    )


def _ablated(each: AblatedMechanism) -> tuple[str, ...]:
    run = each.run
    return (
        ablated_name(each),
        each.replaced_by,
        signed(run.difference, 1),
        f"{run.squares:.1f}",
        f"{run.worst} ({signed(run.worst_sd, 1)})",
        "; ".join(each.sources),
    )
