"""Events for markers, and the differences by which an export is judged."""

import pytest

from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.delivery.delivered_drive import (
    DeliveryDeviation,
    Deviation,
    delivery_deviation,
    loss_limit,
    loss_table,
)
from thermicon.circuit.delivery.formats.form import events_of
from thermicon.circuit.delivery.prepare import lost_text
from thermicon.icons import load_library
from thermicon.icons.model.corners import Corners


def test_ramps_levels_and_returns_on_the_clock_of_the_file() -> None:
    corners = load_library("six-icons")["cold-to-warm"].corners()
    found = [(event.name, round(event.time_s, 3), event.level) for event in events_of(corners, 0.01)]
    assert found == [
        ("ramp start", 0.01, 32.0),
        ("target reached", 1.51, 27.5),
        ("ramp start", 1.51, 27.5),
        ("target reached", 6.51, 36.0),
        ("return start", 6.51, 36.0),
        ("baseline reached", 8.01, 32.0),
        ("end", 8.01, 32.0),
    ]


def test_a_wave_is_one_event_a_half_swing_and_a_hold_none() -> None:
    up_in_pieces = Corners((0, 1, 2, 3, 5), (30, 31, 31.5, 31.5, 30), "temperature_C")
    assert [event.name for event in events_of(up_in_pieces)] == [
        "ramp start", "target reached", "return start", "baseline reached", "end",
    ]  # fmt: skip
    still = Corners((0, 4), (30, 30), "temperature_C")
    assert [event.name for event in events_of(still)] == ["end"]


def test_losses_are_records_with_a_source() -> None:
    assert len(loss_table()) == 4
    assert (loss_limit("receptor difference"), loss_limit("relative d′ drop")) == (0.05, 0.10)


def test_a_loss_is_told_with_its_limit() -> None:
    apart = DeliveryDeviation((Deviation("skin", 0.3, 1.0, 0.2), Deviation("cold receptor", 0.1, 1.0, 0.0612)))
    assert lost_text(apart) == "the cold receptor differs by 0.061 K (rms) from the design, over the stated 0.05 K"
    assert repr(apart) == "DeliveryDeviation(skin +300 mK (rms 200), cold receptor +100 mK (rms 61.2))"


def test_traces_of_different_length_are_not_compared() -> None:
    rig = Rig.load("thenar")
    one, other = (simulate_current(Drive([0, end], [0.1, 0.1]), rig) for end in (1, 2))
    with pytest.raises(ValueError, match="traces of 101 and 201 rows cannot be compared"):
        delivery_deviation(one, other)
