"""Reasons for a pair's distance in sentences."""

import math
import re
from dataclasses import replace
from typing import Any

import pytest

from tests.builders import dprime_from_memory, messages
from thermicon.circuit import Rig, Trace
from thermicon.circuit.solver.simulate import simulate_all
from thermicon.icons import parse
from thermicon.perception import Observer, Percept, perceive
from thermicon.perception.identification.episodes import PARTS, remembered
from thermicon.perception.ranking.reasons import DistanceComponent, components_of, pair_reasons
from thermicon.perception.ranking.rules_of_thumb import load_rules
from thermicon.perception.sensation.features import attack_K_per_s, delay_s, excursion_K, peak_change_K

MESSAGES = messages(__file__)["reasons"]


def why(one: Trace, two: Trace, observer: Observer, felt: tuple[Percept, Percept] | None = None) -> tuple[str, ...]:
    both = (perceive(one, observer), perceive(two, observer)) if felt is None else felt
    return pair_reasons(one, two, both, observer, "episodes", remembered(both, observer), (0, 1))


def pair(cue: Any, observer: Observer, a: dict[str, Any], b: dict[str, Any]) -> tuple[str, ...]:
    return why(cue(name="a", **a), cue(name="b", **b), observer)


def parts_of(a: Trace, b: Trace, observer: Observer | None = None) -> dict[str, DistanceComponent]:
    person = Observer.load() if observer is None else observer
    felt = perceive(a, person), perceive(b, person)
    parts = components_of(remembered(felt, person), 0, 1, person)
    assert tuple(part.name for part in parts) == PARTS
    assert math.hypot(*(part.value for part in parts)) == pytest.approx(dprime_from_memory(felt, person), rel=1e-9)
    return {part.name: part for part in parts}


def largest(parts: dict[str, DistanceComponent]) -> str:
    return max(parts.values(), key=lambda part: part.value).name


def test_features_of_a_trapezoid(cue: Any) -> None:
    trace, still = cue(change=-6.0, rate=3.0, lag_s=0.25), cue(change=1e-9)
    assert peak_change_K(trace, "cold") == pytest.approx(-6.0)
    assert attack_K_per_s(trace, "warm") == pytest.approx(-3.0)
    assert delay_s(trace, "cold") == pytest.approx(0.25, abs=1e-9)
    assert excursion_K(trace, "warm") == pytest.approx(0.0)
    assert attack_K_per_s(still, "cold") == 0.0
    assert delay_s(still, "cold") is None


def test_each_component_answers_to_what_was_changed(cue: Any, observer: Observer) -> None:
    same = parts_of(cue(-4.0), cue(-4.0), observer)
    assert [part.value for part in same.values()] == [0.0] * 5
    assert not any(part.above for part in same.values())
    assert same["intensity"].a == same["intensity"].b
    assert largest(parts_of(cue(-4.0), cue(4.0), observer)) == "direction"
    weaker = parts_of(cue(-4.0), cue(-2.0), observer)
    assert weaker["direction"].value == 0.0
    assert weaker["intensity"].value == pytest.approx(math.log(2.0) / 0.42, rel=0.1)  # σ_I of this observer
    slower = parts_of(cue(-4.0, rate=4.0), cue(-4.0, rate=2.0), observer)
    assert largest(slower) == "rate"
    assert slower["rate"].value >= math.log(2.0) / 0.31  # and its return, which is felt too
    assert slower["rate"].a == pytest.approx(2.0 * slower["rate"].b, rel=0.02)  # type: ignore[operator]
    assert largest(parts_of(cue(-4.0, hold=2.0), cue(-4.0, hold=6.0), observer)) == "duration"
    later = parts_of(cue(-4.0), cue(-4.0, lag_s=1.0), observer)
    assert largest(later) == "pause"
    assert later["duration"].value == pytest.approx(0.0, abs=0.05)


def test_of_what_is_not_felt_there_are_no_values(cue: Any, observer: Observer) -> None:
    parts = parts_of(cue(-4.0), cue(0.0), observer)
    assert parts["direction"].above
    assert all(part.b is None for part in parts.values())
    assert parts["rate"].to_dict() == {
        "part": "rate", "value": 0.0, "unit": "d′", "noticeable": 1.0, "above": False, "a": parts["rate"].a, "b": None,
    }  # fmt: skip


DIP = "cool by 3 °C at 2 °C/s; hold for 1 s; return at 2 °C/s"


@pytest.mark.parametrize(
    ("one", "other", "most"),
    [
        ("cool by 3 K at 3 K/s; warm by 6 K at 3 K/s", "warm by 3 K at 3 K/s; cool by 6 K at 3 K/s", "direction"),
        (f"{DIP}; rest for 2 s; {DIP}", f"{DIP}; rest for 6 s; {DIP}", "pause"),
    ],
)  # fmt: skip
def test_components_of_sequences(one: str, other: str, most: str) -> None:
    """The order of directions counts. Of two dips farther apart, which have no partner, the reason is the pause."""
    icons = parse(f"cue 1; set {{ control display }}; icon a {{ {one} }}; icon b {{ {other} }}")
    parts = parts_of(*simulate_all(list(icons), Rig.load("thenar"), end_s=25.0))
    assert largest(parts) == most
    a, b = parts["pause"].a, parts["pause"].b
    assert most != "pause" or (a is not None and b is not None and b - a > 2.0)


@pytest.mark.parametrize("case", MESSAGES)
def test_what_is_said_of_a_pair(cue: Any, observer: Observer, case: str) -> None:
    one, other, said = MESSAGES[case]
    found = pair(cue, observer, one, other)
    for text in said:
        assert any(each.startswith(text) or each.endswith(text) for each in found), text
    assert (len(found) == 1) == case.startswith("alike")


def test_numbers_of_a_reason_can_be_recomputed(cue: Any, observer: Observer) -> None:
    one, two = cue(name="a", change=-4.0), cue(name="b", change=-3.0, rate=1.0)
    carries, *_, onsets = why(one, two, observer)
    first, second = (perceive(each, observer).onset_s or 0.0 for each in (one, two))
    assert f": {abs(first - second):.2f} s apart" in onsets
    parts = parts_of(one, two, observer)
    whole = math.hypot(*(part.value for part in parts.values()))
    assert carries.endswith(f"d′ {parts['rate'].value:.1f} of {whole:.1f} for a nominal person")


@pytest.mark.parametrize("share", [0.9999, 0.99999, 1.00001, 1.0001])
def test_rounding_does_not_undo_a_verdict(cue: Any, observer: Observer, share: float) -> None:
    needed = load_rules().one("peak", channel="warm").central
    peaks = pair(cue, observer, {"change": 4.0}, {"change": 4.0 + needed * share})[2]
    said = "more than" if share > 1 else "within"
    found = re.search(rf"differ by (\S+) K, {said} the just noticeable 0.09 K$", peaks)
    assert found is not None
    assert float(found[1]) != 0.09 and (float(found[1]) > 0.09) == (share > 1)


def test_rounding_does_not_undo_the_verdict_on_rates_and_onsets(cue: Any, observer: Observer) -> None:
    ratio = load_rules().one("rate ratio").central
    rates = pair(cue, observer, {"change": -4.0, "rate": 2.0}, {"change": -4.0, "rate": 2.0 * ratio * 0.999})[3]
    assert rates.endswith("differ by a factor 1.429, within the just noticeable 1.43")
    one, two = cue(change=-4.0, name="a"), cue(change=-4.2, name="b")
    felt = replace(perceive(one, observer), onset_s=0.0)
    for late, said in ((0.1999, "0.1999 s apart, within the 0.20 s"), (0.2, "0.20 s apart, as much as the 0.20 s")):
        onsets = why(one, two, observer, (felt, replace(felt, onset_s=late)))[4]
        assert onsets.endswith(f"{said} of the response window")
