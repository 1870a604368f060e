"""Every published number beside its prediction as a ratio: the points of the report's first figure.

Rows that the constants were inferred from come with their left-out prediction, whose interval contains the published
error; other targets come with their prediction from temperature and the interval that the constants leave.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..inference.evidence import load_evidence
from .conditioning import ConditionedRow, Conditioning

if TYPE_CHECKING:
    from .validate import Line, Section

TITLES = {
    "thenar": "Forced choice at the thenar",
    "wrist": "Forced choice at the wrist",
    "amplitudes": "Amplitude differences",
    "steps": "Steps from threshold to pain",
}
"""Titles of experiments that are printed in papers and have no table of open data."""
NUMBERS_WITHOUT_CRITERION = ("linear cooling", "rise from cold to warm", "back of the hand, women over 60 y")
"""Beginnings of the names of rows that are shown and not judged, and have a published number of their own."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """One published number and its prediction, over the published number.

    Attributes
    ----------
    group, name, channel
        Experiment or target, row, and channel (`cold`, `warm` or `both`).
    left_out
        Whether the row was conditioned on, and is predicted from the other experiments.
    agrees
        Left-out rows: whether the interval contains the published number. Others: whether the criterion of the target
        holds; None where there is none.
    ratio, low, high
        Prediction and ends of its 95 % interval over the published number; None where a direction or a word was
        published, or where the prediction has the other sign. Ends may be 0 or less.
    published_low, published_high
        Ends of the published interval, or of the criterion where that is all there is (0 and infinity: no end).
    note
        What is printed where there is no ratio.

    """

    group: str
    name: str
    channel: str
    left_out: bool
    agrees: bool | None
    ratio: float | None
    low: float | None = None
    high: float | None = None
    published_low: float | None = None
    published_high: float | None = None
    note: str = ""


def comparisons(conditioning: Conditioning, sections: tuple[Section, ...]) -> tuple[Comparison, ...]:
    """All comparisons: rows of the evidence by experiment, then those of the targets that were not conditioned on."""
    targets = (
        _of_target(section, line)
        for section in sections
        for line in section.lines
        if not line.published.fitted and (line.row.judged or line.row.name.startswith(NUMBERS_WITHOUT_CRITERION))
    )
    return (*(_of_evidence(each) for each in conditioning.rows), *targets)


def experiment_title(key: str) -> str:
    """Title of an experiment of the evidence by its key.

    >>> experiment_title("wrist"), experiment_title("E3")
    ('Forced choice at the wrist', 'Method of limits on the forearm')
    """
    return TITLES[key] if key in TITLES else load_evidence().experiment(key).title


def _of_evidence(each: ConditionedRow) -> Comparison:
    row = each.row
    ends = _sorted(row.left_out_low / row.published, row.left_out_high / row.published)
    published = _sorted(row.published_low / row.published, row.published_high / row.published)
    key = "" if row.experiment in TITLES else f"{row.experiment}  "
    name = row.label.removesuffix(", both").replace(" at the wrist", "")
    ratio = row.left_out / row.published
    group = f"{key}{experiment_title(row.experiment)}"
    return Comparison(group, name, row.channel, True, each.covered, ratio, *ends, *published)


def _of_target(section: Section, line: Line) -> Comparison:
    row, judged = line.row, line.judged[0]
    title = f"{section.target.number}  {section.target.title}"
    name = f"{_short(row.name)}, {row.channel}" if row.channel in ("cold", "warm") else _short(row.name)
    start = (title, name, row.channel, False, judged.verdict.holds)
    known = _reference(line)
    value = judged.predicted.value
    if known is None or value is None or value / known[0] <= 0.0:
        note = "direction as published" if judged.verdict.holds else "the other way round than published"
        return Comparison(*start, None, note=note)
    reference, published = known[0], _sorted(*(end / known[0] for end in known[1:]))
    low, high = judged.predicted.low, judged.predicted.high
    ends = None if low is None or high is None else _sorted(low / reference, high / reference)
    return Comparison(
        *start,
        value / reference,
        low=None if ends is None else ends[0],
        high=None if ends is None else ends[1],
        published_low=published[0],
        published_high=published[1],
    )


def _reference(line: Line) -> tuple[float, float, float] | None:
    """What a prediction is divided by, and the ends of what was published or, failing that, of the criterion."""
    row, was = line.row, line.published
    if was.value is not None and was.unit == row.unit:
        low = was.value if was.low is None else was.low
        return was.value, low, was.value if was.high is None else was.high
    if row.rule == "published range" and was.high:
        return was.high, was.low or 0.0, was.high
    if row.rule in ("above", "at least") and row.value:
        return row.value, row.value, math.inf
    return None


def _short(name: str) -> str:
    """A row's name without what the figure has no space for."""
    for long, short in (
        (" over that with any other icon, least of four groups", " over any other"),
        (" (asked at 65 y)", ""),
        (" (negative: heat leads)", ""),
        (", summed over the whole body", ""),
        ("touch that seems simultaneous with", "touch simultaneous with"),
        (" over that at 0.1", " over 0.1 K/s"),
        ("information that the experiment would report", "information, as reported"),
    ):
        name = name.replace(long, short)
    return name


def _sorted(first: float, second: float) -> tuple[float, float]:
    return (first, second) if first <= second else (second, first)
