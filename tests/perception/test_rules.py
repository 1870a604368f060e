from typing import Any

import pytest

from thermicon.perception import Observer, RuleResult, icon_rules, load_rules, pair_rules, perceive
from thermicon.perception.rules import TOLD_APART


def by_name(results: tuple[RuleResult, ...]) -> dict[str, RuleResult]:
    return {r.rule: r for r in results}


def scored(cue: Any, observer: Observer, **changes: Any) -> dict[str, RuleResult]:
    trace = cue(**changes)
    return by_name(icon_rules(trace, perceive(trace, observer)))


def pair(cue: Any, observer: Observer, a: dict[str, Any], b: dict[str, Any]) -> dict[str, RuleResult]:
    one, two = cue(name="a", **a), cue(name="b", **b)
    return by_name(pair_rules(one, two, perceive(one, observer), perceive(two, observer)))


def test_a_clear_cooling_passes(cue: Any, observer: Observer) -> None:
    found = scored(cue, observer, change=-6.0)
    change = found["change at the receptor (cold)"]
    assert (change.passed, change.threshold, change.unit) == (True, 0.11, "K")
    assert change.value == pytest.approx(6.0)
    assert change.margin == pytest.approx(5.89)
    assert change.text == "change at the receptor (cold): 6 K against at least 0.11 K: passes"
    assert "Stevens & Choo 1998" in change.source
    assert "change at the receptor (warm)" not in found


def test_a_small_slow_warming_fails(cue: Any, observer: Observer) -> None:
    found = scored(cue, observer, change=0.15, rate=0.05)
    assert found["change at the receptor (warm)"].margin == pytest.approx(-0.05)
    text = "rate at the receptor (warm): 0.05 K/s against at least 0.1 K/s: fails"
    assert found["rate at the receptor (warm)"].text == text
    latency = found["latency (warm)"]
    assert (latency.passed, latency.value, latency.margin) == (False, None, None)
    assert latency.text == "latency: the icon is not felt, so it has no onset to hold against 0.5 to 0.9 s"


def test_latency_is_held_against_its_window(cue: Any, observer: Observer) -> None:
    latency = scored(cue, observer, change=6.0)["latency (warm)"]
    assert latency.value is not None
    assert latency.value > 1.4 + 0.2
    assert (latency.passed, latency.threshold_low, latency.threshold) == (False, 0.5, 0.9)
    assert (latency.to_dict()["threshold_low"], latency.to_dict()["threshold"]) == (0.5, 0.9)
    assert latency.margin == pytest.approx(0.9 - latency.value)
    assert "against 0.5 to 0.9 s: fails" in latency.text


def test_neutral_zone(cue: Any, observer: Observer) -> None:
    zone = scored(cue, observer, change=-6.0)["neutral zone (cold)"]
    assert (zone.passed, zone.value, zone.margin) == (True, 32.0, 2.0)
    assert (zone.threshold_low, zone.threshold) == (30.0, 36.0)


def test_a_rule_with_one_end_has_no_lower_threshold(cue: Any, observer: Observer) -> None:
    change = scored(cue, observer, change=-6.0)["change at the receptor (cold)"]
    assert change.threshold_low is None
    assert change.to_dict()["threshold_low"] is None


def test_an_icon_that_is_not_felt_keeps_both_ends_of_the_window(cue: Any, observer: Observer) -> None:
    latency = scored(cue, observer, change=0.15, rate=0.05)["latency (warm)"]
    assert (latency.threshold_low, latency.threshold) == (0.5, 0.9)


@pytest.mark.parametrize(("change", "said"), [(-0.10999, "fails"), (-0.11001, "passes")])
def test_rounding_does_not_undo_a_verdict(cue: Any, observer: Observer, change: float, said: str) -> None:
    text = scored(cue, observer, change=change)["change at the receptor (cold)"].text
    assert text == f"change at the receptor (cold): {-change:g} K against at least 0.11 K: {said}"


def test_directions_tell_apart(cue: Any, observer: Observer) -> None:
    found = pair(cue, observer, {"change": -4.0}, {"change": 4.0})
    assert found["direction"].text == "direction: a cools, b warms: directions differ"
    assert found[TOLD_APART].passed
    assert not any(name.startswith("amplitude") for name in found)


def test_equal_cues_are_not_told_apart(cue: Any, observer: Observer) -> None:
    found = pair(cue, observer, {"change": -4.0}, {"change": -4.05})
    assert found["direction"].text == "direction: a cools, b cools: directions are the same"
    assert found["peak (cold)"].text == "peak (cold): 0.05 K against at least 0.07 K: fails"
    assert found["rate ratio (cold)"].value == pytest.approx(1.0)
    assert found["rate ratio (cold)"].text == "rate ratio (cold): 1 against at least 1.43: fails"
    assert found["onset (cold)"].text.endswith("s against at least 0.2 s: fails")
    assert found[TOLD_APART].text == "told apart: no rule separates the two"
    assert not found[TOLD_APART].passed


def test_each_of_ours_alone_tells_apart(cue: Any, observer: Observer) -> None:
    peak = pair(cue, observer, {"change": 4.0}, {"change": 4.1})
    assert peak[TOLD_APART].text == "told apart: by peak (warm)"
    assert peak["amplitude difference (warm)"].margin == pytest.approx(0.01)
    rate = pair(cue, observer, {"change": -4.0, "rate": 3.0}, {"change": -4.0, "rate": 4.5})
    assert rate[TOLD_APART].text == "told apart: by rate ratio (cold)"
    late = pair(cue, observer, {"change": -4.0}, {"change": -4.0, "lag_s": 0.3})
    assert late[TOLD_APART].text == "told apart: by onset (cold)"


def test_unfelt_icons_have_no_onset(cue: Any, observer: Observer) -> None:
    one = pair(cue, observer, {"change": -4.0}, {"change": -0.05})
    assert one["onset (cold)"].text == "onset: only one of the two is felt"
    none = pair(cue, observer, {"change": -0.05}, {"change": -0.04})
    assert none["onset (cold)"].text == "onset: neither is felt"
    assert none["onset (cold)"].value is None
    assert not none["onset (cold)"].passed


def test_rules_are_records_that_say_whose_they_are() -> None:
    for record in load_rules():
        assert record.get("scope") in ("icon", "pair")
        assert str(record.get("statement"))
    ours = [r for r in load_rules() if r.source.startswith("this project")]
    assert {r.quantity for r in ours} == {"direction", "peak", "rate ratio", "onset", TOLD_APART}
