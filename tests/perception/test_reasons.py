from typing import Any

import pytest

from thermicon.perception import (
    Observer,
    Percept,
    attack_K_per_s,
    delay_s,
    excursion_K,
    largest_difference,
    onset_s,
    pair_reasons,
    peak_change_K,
    perceive,
)


def why(cue: Any, observer: Observer, a: dict[str, Any], b: dict[str, Any]) -> list[Any]:
    one, two = cue(name="a", **a), cue(name="b", **b)
    return list(pair_reasons(one, two, perceive(one, observer), perceive(two, observer), observer))


def test_features_of_a_trapezoid(cue: Any, observer: Observer) -> None:
    trace = cue(change=-6.0, rate=3.0, lag_s=0.25)
    assert peak_change_K(trace, "cold") == pytest.approx(-6.0)
    assert attack_K_per_s(trace, "warm") == pytest.approx(-3.0)
    assert delay_s(trace, "cold") == pytest.approx(0.25, abs=1e-9)
    assert excursion_K(trace, "warm") == pytest.approx(0.0)
    assert onset_s(trace, observer) == perceive(trace, observer).onset_s
    still = cue(change=1e-9)
    assert attack_K_per_s(still, "cold") == 0.0
    assert delay_s(still, "cold") is None
    assert onset_s(still, observer) is None


def test_same_direction_gives_peaks_rates_and_onsets(cue: Any, observer: Observer) -> None:
    direction, peaks, rates, onsets, largest = why(cue, observer, {"change": -4.0}, {"change": -3.0, "rate": 1.0})
    assert direction.text == (
        "same direction: a cools (-4.00 K at the cold receptor); b cools (-3.00 K at the cold receptor)"
    )
    assert peaks.text == (
        "both cool: peaks -4.00 and -3.00 K at the cold receptor differ by 1.00 K, more than the just noticeable 0.07 K"
    )
    assert rates.text == (
        "rates -3.00 and -1.00 K/s at the cold receptor differ by a factor 3.00, more than the just noticeable 1.43"
    )
    assert rates.values["ratio"] == pytest.approx(3.0)
    assert onsets.values["difference"] == pytest.approx(abs(onsets.values["a"] - onsets.values["b"]))
    assert f"{onsets.values['difference']:.2f} s apart, within the 0.20 s of the response window" in onsets.text
    assert "in the cold channel" in largest.text


def test_what_fails_to_separate_is_said(cue: Any, observer: Observer) -> None:
    _, peaks, rates, onsets, _ = why(cue, observer, {"change": 4.0}, {"change": 4.05})
    assert "both warm" in peaks.text
    assert peaks.text.endswith("differ by 0.05 K, within the just noticeable 0.09 K")
    assert rates.text.endswith("differ by a factor 1.00, within the just noticeable 1.43")
    assert onsets.text.endswith("within the 0.40 s of the response window")


def test_other_directions_give_no_peaks(cue: Any, observer: Observer) -> None:
    reasons = why(cue, observer, {"change": -4.0}, {"change": 3.0})
    assert [r.unit for r in reasons] == ["K", "s", "d′"]
    assert reasons[0].text == (
        "directions differ: a cools (-4.00 K at the cold receptor); b warms (+3.00 K at the warm receptor)"
    )
    assert reasons[1].text.startswith("felt at 0.")


def test_unfelt_icons_are_named(cue: Any, observer: Observer) -> None:
    texts = [r.text for r in why(cue, observer, {"change": -0.05}, {"change": -4.0})]
    assert "not felt: a" in texts


def test_largest_difference_names_time_and_channel(cue: Any, observer: Observer) -> None:
    one, two = cue(change=-4.0), cue(change=3.0)
    felt: tuple[Percept, Percept] = (perceive(one, observer), perceive(two, observer))
    size, time, channel = largest_difference(*felt, observer)
    assert channel == "cold"
    assert 0.5 < time < 6.0
    assert size < max(p.psi_cold.max() + p.psi_warm.max() for p in felt) * 2
