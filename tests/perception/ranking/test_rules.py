from typing import Any

import pytest

from tests.builders import messages, steps
from thermicon.circuit import Rig, simulate
from thermicon.perception import Observer, perceive
from thermicon.perception.ranking.rules_of_thumb import (
    DISTINGUISHABLE,
    RuleResult,
    icon_rules,
    load_rules,
    pair_rules,
    rig_rules,
)
from thermicon.perception.ranking.scores import counted, icon_score, pair_margin

MESSAGES = messages(__file__)


def by_name(results: tuple[RuleResult, ...]) -> dict[str, RuleResult]:
    return {r.rule: r for r in results}


def scored(cue: Any, observer: Observer, **changes: Any) -> dict[str, RuleResult]:
    trace = cue(**changes)
    return by_name(icon_rules(trace, perceive(trace, observer)))


def pair(cue: Any, a: dict[str, Any], b: dict[str, Any]) -> dict[str, RuleResult]:
    one, two = cue(name="a", **a), cue(name="b", **b)
    return by_name(pair_rules(one, two))


def test_a_rule_says_value_limit_margin_and_source(cue: Any, observer: Observer) -> None:
    found = scored(cue, observer, change=-6.0)
    change, zone = found["change at the receptor (cold)"], found["neutral zone (cold)"]
    assert (change.passed, change.threshold, change.unit) == (True, 0.11, "K")
    assert change.threshold_low is change.to_dict()["threshold_low"] is None
    assert (change.value, change.margin) == (pytest.approx(6.0), pytest.approx(5.89))
    assert "Stevens & Choo 1998" in change.source
    assert "change at the receptor (warm)" not in found
    assert (zone.passed, zone.value, zone.margin, zone.threshold_low, zone.threshold) == (True, 32.0, 2.0, 30.0, 36.0)
    slow = scored(cue, observer, change=0.15, rate=0.05)
    assert slow["change at the receptor (warm)"].margin == pytest.approx(-0.05)


@pytest.mark.parametrize("case", MESSAGES["icon"])
def test_what_a_rule_says_of_an_icon(cue: Any, observer: Observer, case: str) -> None:
    changes, said = MESSAGES["icon"][case]
    assert said in [rule.text for rule in scored(cue, observer, **changes).values()]


def test_latency_is_held_against_its_window(cue: Any, observer: Observer) -> None:
    late = scored(cue, observer, change=6.0)["latency (warm)"]
    assert late.value is not None and late.value > 1.4 + 0.2
    assert (late.passed, late.threshold_low, late.threshold) == (False, 0.5, 0.9)
    assert late.margin == pytest.approx(0.9 - late.value)
    assert "against 0.5 to 0.9 s: fails" in late.text
    unfelt = scored(cue, observer, change=0.15)["latency (warm)"]
    assert (unfelt.passed, unfelt.value, unfelt.margin) == (False, None, None)
    for changes in ({"change": 0.15, "rate": 0.05}, {"change": 5.0, "rate": 0.09, "hold": 1.0, "end_s": 130.0}):
        assert not any(name.startswith("latency") for name in scored(cue, observer, **changes))  # rates over 0.1 K/s


@pytest.mark.parametrize("case", MESSAGES["rules"])
def test_what_rules_say_of_a_pair(cue: Any, case: str) -> None:
    one, two, said = MESSAGES["rules"][case]
    found = pair(cue, one, two)
    for text in said:
        assert any(rule.text.startswith(text) for rule in found.values()), text
    last = found[DISTINGUISHABLE]
    assert last.passed == (last.text != "distinguishable: no rule separates the two")
    assert any(name.startswith("amplitude") for name in found) == ("direction: a cools, b warms" not in said[0])
    assert all(rule.passed == rule.text.endswith("passes") for rule in found.values() if " against " in rule.text)


def test_rules_are_records_that_say_whose_they_are() -> None:
    ours = [r for r in load_rules() if r.source.startswith("this project")]
    assert {r.quantity for r in ours} == {"depth", "direction", "peak", "rate ratio", "onset", DISTINGUISHABLE}
    for name, limit in MESSAGES["limits"].items():
        quantity, _, channel = name.partition(", ")
        (found,) = (r for r in load_rules() if (r.quantity, r.channel) == (quantity, channel))
        values = [value for value in (found.low, found.value, found.high) if value is not None]
        assert (values if isinstance(limit, list) else found.value) == limit, name


def test_felt_peaks_are_held_against_the_published_signs(cue: Any, observer: Observer) -> None:
    warm = scored(cue, observer, change=4.0, rate=1.0, hold=0.0)["felt peak (warm)"]
    assert warm.passed and warm.value is not None and warm.value > 0
    assert f" {warm.value:.2f} s after that of the skin, published after it: passes" in warm.text
    cold = scored(cue, observer, change=-4.0, rate=1.0, hold=0.0)["felt peak (cold)"]
    assert cold.value is not None
    assert (cold.passed, cold.margin) == (cold.value < 0, -cold.value)


def test_depths_are_a_rule_on_the_rig() -> None:
    cold, warm = rig_rules(Rig.load("thenar"))
    assert (cold.passed, warm.passed) == (True, True)
    assert cold.text.endswith(
        "0.1 mm against 0.046 to 0.21 mm: passes; on this rig that is inside the viable epidermis"
    )
    from_base = {"skin.depth_from": "stratum corneum", "skin.warm_receptor_mm": 0.5}
    deep = rig_rules(Rig.load("thenar").with_(**from_base))[1]
    assert (deep.passed, deep.margin) == (False, pytest.approx(-0.08))
    assert deep.text.endswith("0.5 mm against 0.11 to 0.42 mm: fails; on this rig that is inside the dermis")
    surface = Rig.load("thenar").with_(**{"skin.depth_from": "surface", "skin.cold_receptor_mm": 0.15})
    assert rig_rules(surface)[0].text.startswith("depth (cold): -0.02 mm against 0.046 to 0.21 mm: fails")


def test_margins_are_compared_in_shares_of_their_threshold(cue: Any, observer: Observer) -> None:
    found = scored(cue, observer, change=-0.22)
    assert found["change at the receptor (cold)"].normalised_margin == pytest.approx(1.0)
    assert found["neutral zone (cold)"].normalised_margin == pytest.approx(2.0 / 3.0)
    assert scored(cue, observer, change=-0.05)["latency (cold)"].normalised_margin is None


def test_a_score_is_the_share_passed_without_those_of_the_model(cue: Any, observer: Observer) -> None:
    trace = cue(change=-0.05)
    rules = icon_rules(trace, perceive(trace, observer))
    own = counted(rules)
    assert {r.quantity for r in rules} - {r.quantity for r in own} == {"latency", "felt peak"}
    assert [r.to_dict()["from_model"] for r in rules] == [r not in own for r in rules]
    assert [r.passed for r in own] == [False, True, True]
    share, margin = icon_score(rules, [(True, 0.3), (False, -0.2)])
    assert (share, margin) == (pytest.approx(3 / 5), pytest.approx(0.05 / 0.11 - 1.0))
    assert icon_score(rules, [(True, None)])[0] == pytest.approx(3 / 4)


def test_the_margin_of_a_pair_is_that_of_its_safest_rule(cue: Any) -> None:
    alike, apart = (pair_rules(cue(change=4.0), cue(change=other)) for other in (4.045, 4.18))
    assert pair_margin(alike) == pytest.approx(-0.3, abs=0.001)  # the rates, a factor 1 against 1.43
    assert pair_margin(apart) == pytest.approx(1.0)
    assert pair_margin(pair_rules(cue(change=4.0), cue(change=-4.0))) is None
    assert pair_margin(pair_rules(cue(change=4.0), cue(change=0.15))) is None  # only one passes a threshold
    assert pair_margin([]) == -1.0


def test_directions_that_nobody_feels_tell_nothing_apart() -> None:
    up, down, strong = (
        simulate(icon, Rig.load("thenar"), tail_s=5.0) for icon in steps(up=0.02, down=-0.02, strong=-2)
    )
    assert not pair_rules(up, down)[-1].passed
    assert "directions differ below the threshold alone" in pair_rules(up, down)[0].text
    assert pair_rules(up, strong)[-1].passed
