import re
from dataclasses import replace
from typing import Any

import pytest

from thermicon.perception import Observer, perceive
from thermicon.perception.identification.episodes import PARTS
from thermicon.perception.ranking.reasons import pair_reasons
from thermicon.perception.ranking.rules import load_rules
from thermicon.perception.sensation.features import attack_K_per_s, delay_s, excursion_K, onset_s, peak_change_K


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
    carries, direction, peaks, rates, onsets = why(cue, observer, {"change": -4.0}, {"change": -3.0, "rate": 1.0})
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
    assert carries.text.startswith("mostly distinguished by how fast they start: a ")
    shares = [carries.values[part] ** 2 for part in PARTS]
    assert sum(shares) == pytest.approx(carries.values["d_prime"] ** 2)
    assert carries.text.endswith(
        f"d′ {carries.values['rate']:.1f} of {carries.values['d_prime']:.1f} for a nominal person"
    )


def test_what_fails_to_separate_is_said(cue: Any, observer: Observer) -> None:
    _, _, peaks, rates, onsets = why(cue, observer, {"change": 4.0}, {"change": 4.05})
    assert "both warm" in peaks.text
    assert peaks.text.endswith("differ by 0.05 K, within the just noticeable 0.09 K")
    assert rates.text.endswith("differ by a factor 1.00, within the just noticeable 1.43")
    assert onsets.text.endswith("within the 0.40 s of the response window")


def test_other_directions_give_no_peaks(cue: Any, observer: Observer) -> None:
    reasons = why(cue, observer, {"change": -4.0}, {"change": 3.0})
    assert [r.unit for r in reasons] == ["d′", "K", "s"]
    assert reasons[0].text.startswith("mostly distinguished by what is felt: a cold")
    assert reasons[1].text == (
        "directions differ: a cools (-4.00 K at the cold receptor); b warms (+3.00 K at the warm receptor)"
    )
    assert reasons[2].text.startswith("nominal person: felt at 0.")


def test_identical_icons_get_one_sentence(cue: Any, observer: Observer) -> None:
    (only,) = why(cue, observer, {"change": -4.0}, {"change": -4.0})
    assert only.text == "nothing differs: a and b move the receptors in the same way, so their names are guessed"
    (longer,) = why(cue, observer, {"change": -4.0}, {"change": -4.0, "end_s": 20.0})
    assert longer.text == only.text


def test_what_no_sensation_distinguishes_is_guessed(cue: Any, observer: Observer) -> None:
    one, two = cue(change=-0.001, name="a"), cue(change=-0.0012, name="b")
    felt = perceive(one, observer), perceive(two, observer)
    assert pair_reasons(one, two, *felt, observer)[0].text == "neither a nor b is felt, so their names are guessed"


@pytest.mark.parametrize("share", [0.9999, 0.99999, 1.00001, 1.0001])
def test_rounding_does_not_undo_a_verdict(cue: Any, observer: Observer, share: float) -> None:
    needed = load_rules().one("peak", channel="warm").central
    peaks = why(cue, observer, {"change": 4.0}, {"change": 4.0 + needed * share})[2].text
    found = re.search(r"differ by (\S+) K, (more than|within) the just noticeable (\S+) K$", peaks)
    assert found is not None
    gap, said, limit = found.groups()
    assert said == ("more than" if share > 1 else "within")
    assert (float(gap) > float(limit)) == (share > 1)
    assert float(gap) != float(limit)
    assert limit == "0.09"


def test_rounding_does_not_undo_the_verdict_on_rates_and_onsets(cue: Any, observer: Observer) -> None:
    ratio = load_rules().one("rate ratio").central
    rates = why(cue, observer, {"change": -4.0, "rate": 2.0}, {"change": -4.0, "rate": 2.0 * ratio * 0.999})[3].text
    assert rates.endswith("differ by a factor 1.429, within the just noticeable 1.43")
    one = cue(change=-4.0, name="a")
    felt = perceive(one, observer)
    late = replace(felt, onset_s=(felt.onset_s or 0.0) + 0.1999)
    onsets = pair_reasons(one, cue(change=-4.2, name="b"), felt, late, observer)[4].text
    assert onsets.endswith(": 0.1999 s apart, within the 0.20 s of the response window")


def test_as_much_as_is_said_of_what_is_equal(cue: Any, observer: Observer) -> None:
    one = cue(change=-4.0, name="a")
    felt = replace(perceive(one, observer), onset_s=0.0)
    later = replace(felt, onset_s=0.2)
    text = pair_reasons(one, cue(change=-4.2, name="b"), felt, later, observer)[4].text
    assert text.endswith("0.20 s apart, as much as the 0.20 s of the response window")


def test_unfelt_icons_are_named(cue: Any, observer: Observer) -> None:
    texts = [r.text for r in why(cue, observer, {"change": -0.05}, {"change": -4.0})]
    assert "not felt by the nominal person: a" in texts
