"""The validation report as a page: its text, tables and pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from thermicon.perception.observer.variants import VARIABLES
from thermicon.perception.validation.published_figure import CAPTION
from thermicon.perception.validation.published_figure import NAME as LEAD
from thermicon.perception.validation.tradeoffs import FEWEST, STRONG, TradeOff
from thermicon.perception.validation.validate import Judged, Line, Section, ValidationReport
from thermicon.perception.validation.validate_maps import FIGURES, TRADE_OFF
from thermicon.perception.validation.verdicts import criterion_of_row, plain, value_text

from .blocks import Bullets, Cell, Grid, Heading, MarkdownBlock, Picture, Text
from .conditioning_page import conditioning_blocks

TITLE = "Validation: predicted and published values"
NAMES = VARIABLES


def page(report: ValidationReport) -> list[MarkdownBlock]:
    """Return all blocks of the page, starting with the table of targets."""
    return [
        *_head(report),
        *_better(report),
        *conditioning_blocks(report.conditioning),
        *(b for s in report.sections for b in _section(s)),
        *_trades(report),
    ]


def number_text(line: Line, one: Judged, unit: str = "") -> str:
    """Format a prediction, with its unit if it has one."""
    if one.predicted.value is None:
        return "not felt"
    return value_text(line.row, one.predicted.value, line.published) + unit_text(unit)


def unit_text(unit: str) -> str:
    """Format the unit that follows a number; empty for pure numbers and proportions.

    >>> unit_text("s"), unit_text("proportion")
    (' s', '')
    """
    return "" if unit in ("", "1", "proportion") else f" {unit}"


def judged_text(line: Line, one: Judged) -> str:
    """Format the prediction, its interval, the verdict with its size, and the share of draws that hold."""
    predicted = one.predicted
    text = number_text(line, one, predicted.unit)
    if predicted.low is not None or predicted.high is not None:
        low, high = ("not felt" if end is None else plain(end) for end in (predicted.low, predicted.high))
        text += "" if low == high else f" [{low} to {high}]"
    if one.verdict.holds is None:
        return text
    size = one.verdict.text.split(";")[0].split(", ")[0] if not one.verdict.holds else ""
    text += f": {one.verdict.word}" + (f", {size}" if size else "")
    return text if one.share_holding is None else f"{text} ({100 * one.share_holding:.0f} % of draws hold)"


def target_rows(report: ValidationReport) -> list[tuple[Cell, ...]]:
    """Tabulate the targets: how many judged rows hold for each variant, and the misses of the temperature variant."""
    rows = []
    for section in report.sections:
        judged = [line for line in section.lines if line.row.judged]
        cells = [Cell(str(section.target.number)), Cell(section.target.title)]
        for k in range(len(VARIABLES)):
            held = sum(line.judged[k].verdict.holds is True for line in judged)
            kind = "shown" if not judged else "holds" if held == len(judged) else "misses"
            cells.append(Cell(f"{held} of {len(judged)} hold" if judged else "not judged", kind))
        cells.append(Cell(_misses(judged)))
        rows.append(tuple(cells))
    return rows


def _head(report: ValidationReport) -> Iterator[MarkdownBlock]:
    yield Heading(TITLE, 1)
    yield Picture(LEAD, CAPTION)
    yield Text(
        "Every number here is compared with a published result. The observer's constants were inferred from ten "
        "experiments, to which the rows marked fitted belong; each of these experiments is also predicted from the "
        "others. All other rows are predictions. No parameter is fitted here, and there is no target for the number of "
        "passes: each miss is shown with its size and its suspected mechanism."
    )
    yield Text(
        "Two variants are compared: receptors that respond to temperature and receptors that respond to heat flow. "
        f"Brackets enclose 95 % of {report.draws} observers drawn from the ranges that data and assumptions allow (not "
        "felt: at that end of the interval even the largest change was not felt). Holds and misses refer to the "
        "nominal observer."
    )
    yield Grid(("#", "target", *NAMES, "misses, from temperature"), tuple(target_rows(report)))
    yield Text(
        f"thermicon {report.version}; {report.people} virtual people, {report.draws} draws, seed {report.seed}, "
        f"{report.trials} trials in the identification experiment."
    )


def _better(report: ValidationReport) -> Iterator[MarkdownBlock]:
    yield Heading("Temperature or heat flow: which variable explains which result")
    named = [(f"{s.target.number} {line.row.label}", line) for s in report.sections for line in s.lines]
    better = {name: line.nearer for name, line in named if line.nearer}
    points = []
    for what, said in (
        ("temperature", "Only temperature holds"),
        ("heat flow", "Only heat flow holds"),
        ("both", "Both hold"),
    ):
        those = [name for name, nearer in better.items() if nearer == what]
        points.append(f"{said} ({len(those)}): {'; '.join(those) or 'nothing'}.")
    neither = [(name, near) for name, near in better.items() if near.startswith("neither")]
    details = "; ".join(f"{name} ({near.partition(', ')[2]})" if "," in near else name for name, near in neither)
    points.append(f"Neither holds ({len(neither)}): {details or 'nothing'}.")
    yield Bullets(tuple(points))
    yield Text(
        "At the nominal constants the first two lists exclude each other: with either variable, the results that only "
        "the other explains are lost."
    )
    rows = []
    for name, line in named:
        if line.nearer:
            cells = [Cell(number_text(line, o, line.row.unit), o.verdict.word) for o in line.judged[:2]]
            rows.append((Cell(name), Cell(line.published.text), *cells, Cell(line.nearer)))
    yield Grid(("number", "published", *NAMES[:2], "better"), tuple(rows))


def _section(section: Section) -> Iterator[MarkdownBlock]:
    target = section.target
    yield Heading(f"{target.number} {target.title}")
    yield Text(f"{target.asks} Published: {target.source}.")
    for name, caption, _ in FIGURES.get(target.number, ()):
        yield Picture(name, caption)
    rows = []
    for line in section.lines:
        cells = [Cell(judged_text(line, one), one.verdict.word) for one in line.judged]
        rows.append(
            (Cell(line.row.label), Cell(line.published.text), Cell(criterion_of_row(line.row, line.published)), *cells)
        )
    yield Grid(("number", "published", "criterion", *NAMES), tuple(rows))
    missed = [
        NAMES[k] for k in range(len(NAMES)) if any(line.judged[k].verdict.holds is False for line in section.lines)
    ]
    if missed:
        yield Text(f"Variants with misses: {_listed(missed)}. Suspected mechanism: {target.mechanism}")
    else:
        said = "No misses" if any(line.row.judged for line in section.lines) else "Not judged"
        yield Text(f"{said}. This result depends on: {target.mechanism}")
    yield Bullets(tuple(_conditions(section)))


def _trades(report: ValidationReport) -> Iterator[MarkdownBlock]:
    yield Heading("Trade-offs")
    if report.draws < FEWEST:
        yield Text(f"Too few draws for an analysis of trade-offs ({report.draws}; at least {FEWEST} are needed).")
        return
    yield Text(
        "All predictions of a variant come from the same plausible observers, so any two predictions can be compared: "
        "do the constants that improve one worsen the other? Shares are proportions of all draws; 'by chance' is the "
        "share in which both would hold if the two were independent."
    )
    yield Picture(TRADE_OFF[0], TRADE_OFF[1])
    for name, pairs in zip(NAMES, report.trade_offs, strict=True):
        opposed = [one for one in pairs if one.against]
        rarer = [one for one in pairs if one.rarer]
        mended = sum(one.against is False for one in pairs)
        yield Text(
            f"{name}: of the pairs in which both predictions miss, {len(opposed)} conflict and {mended} improve "
            f"together (correlation {STRONG:g} or stronger). Pairs that hold together less often than by chance: "
            f"{len(rarer)}."
        )
        shown = list(
            dict.fromkeys(
                [
                    *opposed,
                    *rarer,
                    *(p for p in pairs if p.both_miss and p.across and p.first_holds > 0.0 < p.second_holds),
                ]
            )
        )
        if shown:
            yield Grid(
                (
                    "first",
                    "second",
                    "first holds",
                    "second holds",
                    "both hold",
                    "by chance",
                    "correlation",
                    "trade-off",
                ),
                tuple(_trade(one) for one in shown),
            )


def _trade(one: TradeOff) -> tuple[Cell, ...]:
    shares = (one.first_holds, one.second_holds, one.both_hold, one.by_chance)
    verdict = (
        "less often than chance"
        if one.rarer
        else "conflict"
        if one.against
        else "improve together"
        if one.against is False
        else "none found"
    )
    rho = "–" if one.correlation is None else plain(round(one.correlation, 2))
    return (
        Cell(one.first),
        Cell(one.second),
        *(Cell(f"{100 * share:.0f} %") for share in shares),
        Cell(rho),
        Cell(verdict),
    )


def _misses(lines: Sequence[Line]) -> str:
    missed = [line for line in lines if line.judged[0].verdict.holds is False]
    misses = [f"{line.row.label}: {line.judged[0].verdict.text.split(';')[0].split(', ')[0]}" for line in missed]
    return "; ".join(misses) or "–"


def _conditions(section: Section) -> Iterator[str]:
    """Yield the sources of published numbers, predictions and criteria, without repetition."""
    yield from dict.fromkeys(
        f"Published: {line.published.source}" + (f" ({line.published.conditions})" if line.published.conditions else "")
        for line in section.lines
        if line.row.published
    )
    yield from dict.fromkeys(f"Simulated: {line.judged[0].predicted.conditions}" for line in section.lines)
    yield from dict.fromkeys(f"Criterion: {line.row.source}" for line in section.lines)


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
