"""Targets of the validation as data."""

import math
from dataclasses import replace

import pytest

from tests.builders import messages
from thermicon.base.files.records import RecordError
from thermicon.perception.evidence import targets
from thermicon.perception.evidence.targets import Published, TargetRow, combined, load_targets, published_for
from thermicon.perception.evidence.verdicts import criterion_of_row, judge_row, value_text
from thermicon.perception.observer.observer import load_thresholds

ROWS = [(target, row) for target in load_targets() for row in target.rows]
WAS = Published("2 s", "somebody", value=2.0, low=1.0, high=3.0, unit="s")


def test_targets_with_rows_and_a_mechanism_each() -> None:
    assert [target.number for target in load_targets()] == list(range(1, 10))
    for target in load_targets():
        assert target.asks
        assert target.mechanism
        assert any(row.judged for row in target.rows) is (target.number < 9)  # pulse cues are invented
    labels = [(target.number, row.label) for target, row in ROWS]
    assert len(labels) == len(set(labels))


def test_published_numbers_are_predicted_or_said_to_be_fitted() -> None:
    known, fitted = load_thresholds(), 0
    for _, row in ROWS:
        if not row.published:
            assert published_for(row, known).value is None
            continue
        published = published_for(row, known)
        assert published.source
        uses = {r.use for r in known.select(row.published) if r.source == published.source}
        fitted += published.text.endswith(", fitted")
        assert published.text.endswith(", fitted") == ("calibrate" in uses)
        assert uses & {"predict", "calibrate"}
    assert 0 < fitted < len(ROWS) / 2


def test_texts_of_published_numbers() -> None:
    known = load_thresholds()
    texts = {row.label: published_for(row, known).text for _, row in ROWS}
    assert texts["reaction time at 10 cm², cold"] == "0.77 [0.63 to 0.94] s, fitted"
    assert texts["back of the hand, men 20–30 y, warm"] == "1.62 [1.01 to 2.61] K"
    assert texts["felt peak minus the skin's, cold"] == "sign −"
    assert texts["exponent of area, cold"] == "−0.23 [−0.27 to −0.19], fitted"
    assert texts["rise from cold to warm"] == "0.64 proportion, the worst, fitted"
    assert texts["reaction time, warm over cold"] == "2.16, fitted"


def row(rule: str, value: float | None = None, low: float | None = None, high: float | None = None) -> TargetRow:
    return TargetRow("time", "cold", "s", "x", "y", rule, "ours", value=value, low=low, high=high, published="time")


@pytest.mark.parametrize(("case", "said"), messages(__file__)["rules"].items())
def test_every_rule(case: str, said: str) -> None:
    """Of 2 s published, with the interval 1 to 3 s; before what is said stands whether the row holds."""
    rule, *words = case.split(", ")
    *numbers, predicted = map(float, words)
    value, low, high = {0: (None, None, None), 1: (*numbers, None, None), 2: (None, *numbers)}[len(numbers)]
    found = judge_row(row(rule, value, low, high), predicted, WAS)
    way, text = said.split(" ", 1)
    holds = way == "✓"
    assert (found.holds, found.text) == (holds, text)
    assert found.word == ("holds" if holds else "misses")
    assert (found.miss == 0.0) == (holds or text.startswith("0 s"))


def test_what_has_no_number_is_a_miss_and_what_is_shown_is_not_judged() -> None:
    for nothing in (None, math.inf, math.nan):
        found = judge_row(row("factor", 1.5), nothing, WAS)
        assert (found.holds, found.text) == (False, "nothing felt; at most ×1.5 either way")
    found = judge_row(row("shown"), 99.0, WAS)
    assert (found.holds, found.word, found.text) == (None, "shown", "shown, not judged")
    assert criterion_of_row(row("shown"), WAS) == "not judged"
    below = Published("sign −", "somebody", value=-1.0, unit="sign")
    assert judge_row(row("sign"), -0.2, below).text == "below 0 s"
    assert judge_row(row("sign"), 0.2, below).text == "0.2 s too high; below 0 s"


def test_a_value_reads_on_its_side_of_the_bound() -> None:
    assert value_text(row("at least", 2.0), 1.9953, WAS) == "1.995"
    assert value_text(row("at least", 2.0), 13.12, WAS) == "13.1"
    assert value_text(row("shown"), -1.9999, WAS) == "−2"
    assert combined("cold over warm", 1.0, 2.0) == 0.5


TARGET = '[[target]]\nnumber = 1\ntitle = "t"\nsource = "a"\nasks = "b"\nmechanism = "c"\n'
ROW = '[[target.rows]]\nname = "n"\nexperiment = "x"\nquantity = "q"\nchannel = "cold"\nunit = "s"\nsource = "a"\n'


@pytest.mark.parametrize(("added", "message"), messages(__file__)["targets"].items())
def test_a_wrong_target_is_named(added: str, message: str) -> None:
    assert targets.read_targets(TARGET + ROW + 'rule = "shown"')[0].rows[0].name == "n"
    with pytest.raises(RecordError, match=message):
        targets.read_targets(TARGET + added.replace("ROW ", ROW))


def test_a_published_number_that_is_not_there_is_named() -> None:
    many = TargetRow("limits", "cold", "K", "x", "y", "shown", "ours", published="limits threshold")
    with pytest.raises(RecordError, match=r"6 records of 'limits threshold' for 'limits, cold': one is needed"):
        published_for(many, load_thresholds())
    with pytest.raises(RecordError, match=r"0 records .* whose conditions begin with 'girls' for 'limits, cold'"):
        published_for(replace(many, published_where="girls"), load_thresholds())
    with pytest.raises(ValueError, match=r"time, cold: the published record has no value to compare with"):
        judge_row(row("close", 0.5), 1.0, Published("felt", "somebody"))
    with pytest.raises(ValueError, match=r"time, cold: the published record has no interval to be inside of"):
        judge_row(row("published range"), 1.0, Published("2 s", "somebody", value=2.0))
