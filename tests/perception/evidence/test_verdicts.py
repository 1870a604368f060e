"""Every rule by which a prediction is judged, with the words it is judged in."""

import math

import pytest

from thermicon.circuit.records import RecordError
from thermicon.perception.evidence.targets import Published, Row, combined
from thermicon.perception.evidence.verdicts import criterion_of_row, judge_row, value_text

WAS = Published("2 s", "somebody", value=2.0, low=1.0, high=3.0, unit="s")


def row(rule: str, value: float | None = None, low: float | None = None, high: float | None = None) -> Row:
    return Row(1, "time", "cold", "s", "x", "y", rule, "ours", value=value, low=low, high=high, published="time")


@pytest.mark.parametrize(
    ("asked", "predicted", "holds", "way", "text"),
    [
        (row("factor", 1.5), 2.9, True, 0, "×1.45, at most ×1.5 either way"),
        (row("factor", 1.5), 3.2, False, 1, "×1.60, at most ×1.5 either way"),
        (row("factor", 1.5), 1.0, False, -1, "÷2.00, at most ×1.5 either way"),
        (row("factor", 1.5), -1.0, False, 0, "of the other sign; at most ×1.5 either way"),
        (row("share", 0.25), 2.4, True, 0, "+20 %, within ±25 %"),
        (row("share", 0.25), 1.4, False, -1, "−30 %, within ±25 %"),
        (row("range", None, 1.6, 2.7), 2.7, True, 0, "1.6 to 2.7 s"),
        (row("range", None, 1.6, 2.7), 3.0, False, 1, "0.3 s too high; 1.6 to 2.7 s"),
        (row("published range"), 0.5, False, -1, "0.5 s too low; 1 to 3 s"),
        (row("published range"), 1.5, True, 0, "1 to 3 s"),
        (row("above", 1.0), 1.2, True, 0, "above 1 s"),
        (row("above", 1.0), 1.0, False, -1, "0 s too low; above 1 s"),
        (row("below", 1.0), 1.0, False, 1, "0 s too high; below 1 s"),
        (row("below", 1.0), 0.9, True, 0, "below 1 s"),
        (row("at least", 2.0), 2.0, True, 0, "at least 2 s"),
        (row("at least", 2.0), 1.5, False, -1, "0.5 s too low; at least 2 s"),
        (row("sign"), 0.1, True, 0, "above 0 s"),
        (row("sign"), -0.1, False, -1, "0.1 s too low; above 0 s"),
        (row("close", 0.5), 2.4, True, 0, "within 0.5 s of 2"),
        (row("close", 0.5), 2.6, False, 1, "0.1 s too high; within 0.5 s of 2"),
    ],
)
def test_every_rule(asked: Row, predicted: float, holds: bool, way: int, text: str) -> None:
    found = judge_row(asked, predicted, WAS)
    assert (found.holds, found.way, found.text) == (holds, way, text)
    assert found.word == ("holds" if holds else "misses")
    assert (found.miss == 0.0) == (holds or text.startswith("0 s"))


def test_what_is_shown_is_not_judged() -> None:
    found = judge_row(row("shown"), 99.0, WAS)
    assert (found.holds, found.word, found.text) == (None, "shown", "shown, not judged")
    assert criterion_of_row(row("shown"), WAS) == "not judged"


@pytest.mark.parametrize("predicted", [None, math.inf, math.nan])
def test_nothing_felt_is_a_miss(predicted: float | None) -> None:
    found = judge_row(row("factor", 1.5), predicted, WAS)
    assert (found.holds, found.text) == (False, "nothing felt; at most ×1.5 either way")


def test_a_sign_below_zero() -> None:
    below = Published("sign −", "somebody", value=-1.0, unit="sign")
    assert judge_row(row("sign"), -0.2, below).text == "below 0 s"
    assert judge_row(row("sign"), 0.2, below).text == "0.2 s too high; below 0 s"


def test_a_value_reads_on_its_side_of_the_bound() -> None:
    assert value_text(row("at least", 2.0), 1.9953, WAS) == "1.995"
    assert value_text(row("at least", 2.0), 13.12, WAS) == "13.1"
    assert value_text(row("shown"), -1.9999, WAS) == "−2"


def test_numbers_of_both_channels() -> None:
    assert combined("cold over warm", 1.0, 2.0) == 0.5


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"time, cold: the published record has no value to compare with"):
        judge_row(row("close", 0.5), 1.0, Published("felt", "somebody"))
    with pytest.raises(ValueError, match=r"time, cold: the published record has no interval to be inside of"):
        judge_row(row("published range"), 1.0, Published("2 s", "somebody", value=2.0))
    with pytest.raises(RecordError, match=r"'time': rule = 'near' is not one of factor, share"):
        row("near")
    with pytest.raises(RecordError, match=r"'time': the rule 'factor' needs a value"):
        row("factor")
    with pytest.raises(RecordError, match=r"'time': the rule 'range' needs low and high"):
        row("range", None, 1.0)
    with pytest.raises(RecordError, match=r"'time': the rule 'sign' needs a published record"):
        Row(1, "time", "cold", "s", "x", "y", "sign", "ours")
    with pytest.raises(RecordError, match=r"'time': apply = 'twice' is not one of"):
        Row(1, "time", "cold", "s", "x", "y", "shown", "ours", apply="twice")
