"""Tables of the inference as Markdown.

Every number comes from the shipped data files, so that a page cannot say anything else.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from table_text import UNITS, markdown, number, signed, span

from thermicon.base.files.records import Record
from thermicon.perception.evidence.results import (
    UNMOVED_SD,
    judging_predictions,
    load_ablation,
    load_constants,
    load_predictions,
    read_rows,
)
from thermicon.perception.evidence.rows import load_evidence, load_rows
from thermicon.perception.observer.constants import names_of
from thermicon.perception.observer.observer import MECHANISMS, load_thresholds
from thermicon.perception.observer.people import people_records
from thermicon.perception.sensation.coverage import load_spans

GROUPS = {
    "receptors": ("depth", "skin", "quality", "adaptation"),
    "sensation": ("sensitivity", "summation", "transducer", "compression"),
    "detection": ("gain noise", "noise", "criterion", "delays"),
    "people": ("people", "age"),
}
"""Mechanisms of the tables of single sections, by section."""


def experiments_table() -> str:
    """What was conditioned on: one row per experiment."""
    counts, known = Counter(row.experiment for row in load_rows()), load_evidence().experiments
    lines = [
        (key, known[key].title, known[key].citation, known[key].licence, known[key].method, count)
        for key, count in counts.items()
    ]
    return markdown(("key", "experiment", "citation", "licence of code and data", "what was asked", "rows"), lines)


def spans_table() -> str:
    """What the experiments varied, with those at the ends."""
    lines = [
        (
            each.respect,
            f"{number(each.low)} {each.unit} ({each.low_of})",
            f"{number(each.high)} {each.unit} ({each.high_of})",
        )
        for each in load_spans().values()
    ]
    return markdown(("condition", "from", "to"), lines)


def constants_table(mechanisms: Sequence[str] = ()) -> str:
    """Constants of the default observer by mechanism; all but offsets of laboratories unless mechanisms are named."""
    rows = [each for each in load_constants() if each.unit != "SD" and (not mechanisms or each.mechanism in mechanisms)]
    head = ("mechanism", "constant", "value", "95 %", "prior 95 %", "SD left", "prior from")
    lines, last, order = [], "", [row.mechanism for row in rows]
    for each in sorted(rows, key=lambda each: order.index(each.mechanism)):
        mechanism, last = ("" if each.mechanism == last else f"**{each.mechanism}**"), each.mechanism
        unit = UNITS.get(each.unit, each.unit)
        cells = (mechanism, each.name, f"{number(each.value)} {unit}".strip(), span(each.low, each.high))
        lines.append((*cells, span(each.prior_low, each.prior_high), f"{each.narrowed:.2f}", each.source))
    return markdown(head, lines)


def offsets_table() -> str:
    """Offsets of laboratories, in SDs of the spread between them."""
    rows = [each for each in load_constants() if each.unit == "SD"]
    return markdown(
        ("laboratory", "offset (SD)", "95 %"), [(r.name, number(r.value), span(r.low, r.high)) for r in rows]
    )


def unmoved_sentence() -> str:
    """Constants of which the evidence says next to nothing."""
    rows = sorted(load_constants(), key=lambda each: each.name)
    names = [each.name for each in rows if each.narrowed > UNMOVED_SD and each.unit != "SD"]
    return f"{len(names)} constants keep more than {100 * UNMOVED_SD:.0f} % of their prior's SD: {', '.join(names)}."


def ablation_table() -> str:
    """Every run of the ablation, most lost first."""
    lines = []
    for row in sorted(load_ablation(), key=lambda row: row.difference):
        whole = "" if row.difference else " (the whole observer)"
        ran = f"without {row.without}" if row.without else f"**{row.variable}**{whole}"
        worst = f"{row.worst} ({signed(row.worst_sd, 1)})"
        lines.append((ran, row.replaced_by, signed(row.difference, 1), f"{row.squares:.1f}", worst))
    return markdown(("observer", "what stands in its place", "log evidence", "Σ(miss/SD)²", "worst row (SD)"), lines)


@dataclass(frozen=True, slots=True)
class Influence:
    """Maximum of the posterior without some experiments, with 95 % intervals.

    `log_score` is the log density of their own rows under all others (0: nothing was left out). `corneum` is the share
    of the stratum corneum that counts, `cold` and `warm` are exponents of area, `over_back` and `over_finger` cold
    limits of the palm over those of the back of the hand and the fingers. `moving` is the log evidence of bounds that
    move with the resting skin, over that of bounds that stay.
    """

    left_out: str
    log_score: float
    corneum: float
    corneum_low: float
    corneum_high: float
    cold: float
    cold_low: float
    cold_high: float
    warm: float
    warm_low: float
    warm_high: float
    over_back: float
    over_finger: float
    moving: float


INFLUENCE = "influence.csv"


def load_influence() -> tuple[Influence, ...]:
    """What single experiments do, all of them first."""
    return tuple(read_rows(INFLUENCE, Influence))


def influence_table() -> str:
    """Constants that single experiments move, with and without each."""
    lines = []
    for each in load_influence():
        said = signed(each.log_score, 1) if each.left_out else ""
        corneum = f"{number(each.corneum)} ({span(each.corneum_low, each.corneum_high)})"
        cold = f"{number(each.cold)} ({span(each.cold_low, each.cold_high)})"
        warm = f"{number(each.warm)} ({span(each.warm_low, each.warm_high)})"
        palms = number(each.over_back), number(each.over_finger)
        lines.append((each.left_out or "nothing", said, corneum, *palms, cold, warm, signed(each.moving, 1)))
    head = ("left out", "log score of its rows", "share of the stratum corneum", "palm over back of the hand, cold")
    more = "palm over fingers, cold", "cold exponent of area", "warm exponent of area", "bounds that move, log evidence"
    return markdown((*head, *more), lines)


def left_out_table() -> str:
    """Every row: published, fitted, and predicted by a fit without its experiment; misses are bold."""
    lines = []
    for row in load_predictions():
        mark = "" if row.covered else "**"
        unit = {"1": "", "0-100": "of 100"}.get(row.unit, row.unit)
        numbers = (number(row.published), number(row.fitted), number(row.left_out))
        interval = span(row.left_out_low, row.left_out_high)
        lines.append((row.experiment, f"{mark}{row.label}{mark}", unit, *numbers, interval, signed(row.score, 1)))
    return markdown(("key", "row", "unit", "published", "fitted", "left out", "95 %", "miss (SD)"), lines)


def coverage_sentence() -> str:
    """How many rows, of those that coverage is judged by, lie in the 95 % of a fit without their experiment."""
    rows = judging_predictions()
    missed = [f"{row.label} ({row.experiment}, {signed(row.score, 1)} SD)" for row in rows if not row.covered]
    inside = f"{len(rows) - len(missed)} of {len(rows)} rows lie inside the 95 % interval"
    if not missed:
        return f"{inside}."
    return f"{inside}; {0.95 * len(rows):.0f} are expected. The others: {'; '.join(missed)}."


def mechanisms_table() -> str:
    """Every mechanism of the observer: what it does, its equation, its constants by the names of priors, its source."""
    lines = []
    for kind in MECHANISMS:
        own = [name.removeprefix("cold ") for name in names_of(kind, *kind.__annotations__) if name[:5] != "warm "]
        does = (kind.__doc__ or "").split("\n\n")[0]
        lines.append((f"**{kind.__name__.lower()}**", does, kind.equation, ", ".join(own), kind.source))
    return markdown(("mechanism", "what it does", "equation", "constants", "source"), lines)


def predicted_table() -> str:
    """Published results that are never conditioned on: what `validate` compares with predictions."""
    records = Counter((each.quantity, each.source) for each in load_thresholds() if each.use == "predict")
    return markdown(("quantity", "source", "records"), [(*key, count) for key, count in sorted(records.items())])


def people_table() -> str:
    """How virtual people differ: one row per column of `People`."""
    rows = []
    for name, record in people_records().items():
        basis = f"assumed: {record.source}" if record.use == "assumed" else record.source
        rows.append((f"`{name}`", _spread(record), basis))
    return markdown(("column", "spread", "basis"), rows)


def _spread(record: Record) -> str:
    unit = UNITS.get(record.unit, record.unit)
    low, high = record.interval
    if record.quantity.endswith("between people") and record.value is not None and unit == "ln":
        return f"SD {number(record.value)} ln ({span(low, high)})"
    if record.value is not None and low == high:
        return f"{number(record.value)} {unit}".strip()
    middle = "" if record.value is None else f"{number(record.value)}, "
    return f"{middle}{span(low, high)} {unit}".strip()


TABLES: Mapping[str, Callable[[], str]] = {
    "experiments": experiments_table,
    "spans": spans_table,
    "constants": constants_table,
    "offsets": offsets_table,
    "unmoved": unmoved_sentence,
    "ablation": ablation_table,
    "influence": influence_table,
    "left out": left_out_table,
    "coverage": coverage_sentence,
    "predicted": predicted_table,
    "people": people_table,
    "mechanisms": mechanisms_table,
    **{f"constants of {section}": partial(constants_table, own) for section, own in GROUPS.items()},
}
"""Every table by the name that a page's mark gives."""
