"""The validation report: every target with its records.

Whether a target holds is not tested: misses are results.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

from thermicon.base.files.records import RecordTable
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import rank
from thermicon.perception.evidence.identified import GROUPS, SHAPES, WAVES, wave_name
from thermicon.perception.evidence.targets import load_targets, published_for
from thermicon.perception.evidence.validate import ValidationReport, assemble, judged, validate
from thermicon.perception.evidence.validate_file import report_file
from thermicon.perception.identification.measures import proportion_correct
from thermicon.perception.observer.channels import VARIABLES
from thermicon.perception.observer.observer import load_thresholds


@pytest.fixture
def report(validation_report: ValidationReport) -> ValidationReport:
    return validation_report


def test_every_target_and_row_is_there_for_every_variant(report: ValidationReport) -> None:
    assert [section.target for section in report.sections] == list(load_targets())
    for section in report.sections:
        assert [line.row for line in section.lines] == list(section.target.rows)
        for line in section.lines:
            assert [one.predicted.variable for one in line.judged] == list(VARIABLES)
            for one in line.judged:
                assert (one.verdict.holds is None) == (not line.row.judged)
                assert one.predicted.unit == line.row.unit
    assert report.counts(0)[1] == report.counts(1)[1] == sum(r.judged for t in load_targets() for r in t.rows)
    assert repr(report).startswith("ValidationReport(9 targets; hold: temperature ")


def test_six_icons_are_those_of_rank(report: ValidationReport) -> None:
    ranking = rank(load_library("six-icons"), Rig.load("thenar"), people=12, parameters=8)
    whole = {line.row.quantity: line.judged[0].predicted for line in report.sections[5].lines}
    found = {quantity: one.value for quantity, one in whole.items()}
    near = {"abs": 1e-3}  # the report asks for heat flow too, and so steps through what rank superposes
    assert found["proportion correct"] == pytest.approx(ranking.proportion_correct, **near)
    assert found["plug-in information"] == pytest.approx(ranking.felt.plugin.mean(), **near)
    assert found["information"] == pytest.approx(ranking.information_bits, **near)
    people = proportion_correct(report.evidence.six[0].probability)
    low, high = (found[f"proportion correct, {end} end of people"] for end in ("lower", "upper"))
    assert (low, high) == pytest.approx(tuple(np.percentile(people, [2.5, 97.5])))
    intervals, laboratory = {name: (one.low, one.high) for name, one in whole.items()}, ranking.new_laboratory
    assert laboratory is not None
    assert intervals["proportion correct"] == pytest.approx(laboratory.proportion_correct, **near)
    assert intervals["information"] == pytest.approx(laboratory.information_bits, **near)


def test_what_is_made_of_both_channels(report: ValidationReport) -> None:
    lines = {line.row.label: line.judged[0].predicted for line in report.sections[1].lines}
    cold, warm = (lines[f"back of the hand, women 20–30 y, {c}"] for c in ("cold", "warm"))
    ratio = lines["hand, cold over warm"]
    assert ratio.value == pytest.approx((cold.value or 0.0) / (warm.value or 1.0))
    assert ratio.draws == pytest.approx(np.divide(cold.draws, warm.draws))
    assert (cold.baseline, warm.baseline, ratio.baseline) == (0.11, 0.20, pytest.approx(0.55))
    assert report.sections[1].lines[0].nearer_to_published == "model"
    assert sum(report.nearer().values()) == 23
    events = report.sections[7].lines[0].judged[0].predicted
    raw = report.evidence.find(VARIABLES[0], "step and return near threshold", "report of the return", "cold")
    assert events.value == pytest.approx(1.0 + (raw.value or 0.0))
    touch = report.sections[4].lines[-1].judged[0].predicted
    assert (touch.value or 0.0) < 0.0
    assert touch.low is not None
    assert touch.high is not None
    assert touch.low <= touch.high


def test_published_numbers_come_from_the_records(report: ValidationReport) -> None:
    known = load_thresholds()
    moved = RecordTable(
        known.name,
        tuple(replace(r, value=9.0, low=None, high=None) if r.quantity == "choice reaction time" else r for r in known),
    )
    other = assemble(report.evidence, moved, 12, 8, 0, 48)
    before, after = (r.sections[2].lines[0] for r in (report, other))
    assert (before.published.text, after.published.text) == ("0.77 [0.63 to 0.94] s, fitted", "9 s, fitted")
    assert before.judged[0].predicted == after.judged[0].predicted
    assert after.judged[0].verdict.text.startswith("−")


@pytest.mark.slow
def test_the_same_seed_gives_the_same_bytes(report: ValidationReport) -> None:
    first, second = (json.dumps(report_file(r), allow_nan=False) for r in (report, validate(people=12, draws=8)))
    assert first == second


def test_the_waves_of_a_group_differ_in_shape_alone() -> None:
    waves = load_library(WAVES)
    assert len(waves) == len(GROUPS) * len(SHAPES)
    for group in GROUPS:
        lowered = [waves[wave_name(shape, *group)].corners() for shape in SHAPES]
        assert len({(c.duration_s, c.lowest, c.highest) for c in lowered}) == 1


def test_messages(report: ValidationReport) -> None:
    with pytest.raises(ValueError, match=r"a spread between persons needs at least two of them, not 1"):
        validate(people=1)
    with pytest.raises(ValueError, match=r"an interval needs at least two draws, or 0 for none, not 1"):
        validate(draws=1)
    row, known = replace(load_targets()[0].rows[0], experiment="nothing"), load_thresholds()
    with pytest.raises(ValueError, match=r"no experiment 'nothing' predicts 'largest change"):
        judged(row, published_for(row, known), known, report.evidence, "temperature")
