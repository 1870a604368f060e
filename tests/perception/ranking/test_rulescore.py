from typing import Any

import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import parse
from thermicon.perception import Observer, perceive
from thermicon.perception.ranking.rules import icon_rules, pair_rules
from thermicon.perception.ranking.scores import counted, icon_score, pair_margin


def test_a_score_is_the_share_passed_without_those_of_the_model(cue: Any, observer: Observer) -> None:
    trace = cue(change=-0.05)
    rules = icon_rules(trace, perceive(trace, observer))
    own = counted(rules)
    assert {r.quantity for r in rules} - {r.quantity for r in own} == {"latency", "felt peak"}
    assert [r.passed for r in own] == [False, True, True]
    share, margin = icon_score(rules, [(True, 0.3), (False, -0.2)])
    assert share == pytest.approx(3 / 5)
    assert margin == pytest.approx(0.05 / 0.11 - 1.0)
    assert icon_score(rules, [(True, None)])[0] == pytest.approx(3 / 4)


def test_the_margin_of_a_pair_is_that_of_its_safest_rule(cue: Any) -> None:
    alike = pair_rules(cue(change=4.0), cue(change=4.045))
    assert pair_margin(alike) == pytest.approx(-0.3, abs=0.001)  # the rates, a factor 1 against 1.43
    apart = pair_rules(cue(change=4.0), cue(change=4.18))
    assert pair_margin(apart) == pytest.approx(1.0)
    assert pair_margin(pair_rules(cue(change=4.0), cue(change=-4.0))) is None
    assert pair_margin(pair_rules(cue(change=4.0), cue(change=0.15))) is None  # only one passes a threshold
    assert pair_margin([]) == -1.0


def test_nothing_of_the_model_is_in_a_pair(cue: Any) -> None:
    early = pair_rules(cue(change=4.0), cue(change=4.0, lag_s=0.5))
    (onset,) = (r for r in early if r.quantity == "onset")
    assert onset.value == pytest.approx(0.5)
    assert onset.text == "onset (warm): 0.5 s against at least 0.4 s: passes"


def test_directions_that_nobody_feels_tell_nothing_apart() -> None:
    rig = Rig.load("thenar")
    text = "cue 1\nset s { control display; baseline 32 °C }\n" + "".join(
        f"icon {name} {{ {way} by {size} °C at 3 °C/s; hold for 2 s; return at 3 °C/s }}\n"
        for name, way, size in (("up", "warm", 0.02), ("down", "cool", 0.02), ("strong", "cool", 2))
    )
    up, down, strong = (simulate(icon, rig, tail_s=5.0) for icon in parse(text))
    assert not pair_rules(up, down)[-1].passed
    assert "directions differ below the threshold alone" in pair_rules(up, down)[0].text
    assert pair_rules(up, strong)[-1].passed
