"""Designed against delivered icons as people feel them."""

from dataclasses import replace

import pytest

from thermicon.circuit import Drive, Rig, Trace, simulate_current
from thermicon.perception.identification.delivered import DeliveredChange, PerceivedChange, judge_delivered

RIG = Rig.load("thenar")
REST_A = 0.0824


def pulse(size_A: float) -> Trace:
    return simulate_current(Drive([0, 1, 3, 12], [REST_A, REST_A + size_A, REST_A, REST_A], held=True), RIG)


def test_what_is_delivered_as_designed_changes_nothing() -> None:
    names, traces = ["cool", "warm", "none"], [pulse(0.3), pulse(-0.2), pulse(0.0)]
    found = judge_delivered(names, traces, traces)
    assert [change.icon for change in found] == names
    for change in found:
        assert [other for other, _ in change.d_prime] == [name for name in names if name != change.icon]
        assert change.detection.drop == 0.0 and all(pair.drop == 0.0 for _, pair in change.d_prime)
        assert change.losses() == ()


def test_an_icon_that_fades_is_told_with_detection_and_pair() -> None:
    designed, delivered = [pulse(0.1), pulse(0.0)], [pulse(0.05), pulse(0.0)]
    faint, _ = judge_delivered(["faint", "none"], designed, delivered)
    assert faint.detection.designed > faint.detection.delivered + 0.05
    detection, pair = faint.losses()
    assert detection.startswith("detection by the nominal person falls from ")
    assert detection.endswith("by more than the stated 0.05")
    assert pair.startswith("d′ to none falls from ")
    assert pair.endswith("by more than the stated 10%")


@pytest.mark.parametrize(
    ("designed", "delivered", "lost"), [(2.0, 1.85, False), (2.0, 1.75, True), (0.05, 0.01, False), (1.0, 1.5, False)]
)
def test_a_drop_counts_from_a_tenth_on_unless_it_is_tiny(designed: float, delivered: float, lost: bool) -> None:
    change = PerceivedChange("a", DeliveredChange(1.0, 1.0), (("b", DeliveredChange(designed, delivered)),))
    assert bool(change.losses()) is lost


def test_it_becomes_a_dictionary() -> None:
    change = PerceivedChange(
        "a", DeliveredChange(1.0, 0.9), (("b", DeliveredChange(2.0, 1.9)), ("c", DeliveredChange(3.0, 2.0)))
    )
    told = change.to_dict()
    assert told["detected_probability"] == {"designed": 1.0, "delivered": 0.9}
    said = [replace(change, people=people).to_dict()["detected_by"] for people in (0, 1, 200)]
    assert said == ["the nominal person", "1 virtual person", "200 virtual people"]
    assert told["d_prime"] == {"b": {"designed": 2.0, "delivered": 1.9}, "c": {"designed": 3.0, "delivered": 2.0}}
    assert told["losses"] == list(change.losses())
