"""Components of a distance: each answers to what was changed, and their squares add up to d′²."""

import math
from collections.abc import Callable
from typing import Any

import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library, parse
from thermicon.perception import Observer, perceive
from thermicon.perception.identification.episodes import dprime_from_memory
from thermicon.perception.ranking.reasons import COMPONENTS, DistanceComponent, distance_components

Cue = Callable[..., Any]


def named(parts: tuple[DistanceComponent, ...]) -> dict[str, DistanceComponent]:
    assert tuple(part.name for part in parts) == COMPONENTS
    return {part.name: part for part in parts}


def largest(parts: tuple[DistanceComponent, ...]) -> str:
    return max(parts, key=lambda part: part.value).name


def test_icons_that_are_the_same_have_no_distance(cue: Cue, observer: Observer) -> None:
    parts = named(distance_components(cue(-4.0), cue(-4.0), observer))
    assert [part.value for part in parts.values()] == [0.0] * 5
    assert not any(part.above for part in parts.values())
    assert parts["intensity"].a == parts["intensity"].b


def test_each_part_answers_to_what_was_changed(cue: Cue, observer: Observer) -> None:
    def between(a: Any, b: Any) -> tuple[DistanceComponent, ...]:
        return distance_components(a, b, observer)

    other = between(cue(-4.0), cue(4.0))
    assert largest(other) == "direction"
    weaker = named(between(cue(-4.0), cue(-2.0)))
    assert weaker["direction"].value == 0.0
    assert weaker["intensity"].value == pytest.approx(math.log(2.0) / 0.42, rel=0.1)  # σ_I of this observer
    slower = between(cue(-4.0, rate=4.0), cue(-4.0, rate=2.0))
    assert largest(slower) == "rate"
    assert named(slower)["rate"].value >= math.log(2.0) / 0.31  # and its return, which is felt too
    assert slower[2].a == pytest.approx(2.0 * slower[2].b, rel=0.02)  # type: ignore[operator]
    longer = between(cue(-4.0, hold=2.0), cue(-4.0, hold=6.0))
    assert largest(longer) == "duration"
    later = between(cue(-4.0), cue(-4.0, lag_s=1.0))
    assert largest(later) == "pause"
    assert named(later)["duration"].value == pytest.approx(0.0, abs=0.05)


def test_a_second_dip_is_what_only_one_icon_has() -> None:
    rig, icons = Rig.load("thenar"), load_library("six-icons")
    step, dip, slow = (
        simulate(icons[name], rig, tail_s=10) for name in ("cooling-step", "double-dip", "linear-cooling")
    )
    assert largest(distance_components(step, dip)) == "direction"
    assert largest(distance_components(step, slow)) == "rate"


@pytest.mark.parametrize("pair", [("warming-step", "linear-warming"), ("double-dip", "cold-to-warm")])
def test_squares_add_up_to_the_distance_from_memory(pair: tuple[str, str]) -> None:
    rig, icons = Rig.load("thenar"), load_library("six-icons")
    a, b = (simulate(icons[name], rig, tail_s=10) for name in pair)
    felt = perceive(a), perceive(b)
    parts = distance_components(a, b, None, felt)
    assert parts == distance_components(a, b)
    assert math.hypot(*(part.value for part in parts)) == pytest.approx(dprime_from_memory(*felt), rel=1e-9)


def test_the_order_of_directions_counts() -> None:
    text = "cue 1\nset s { control display }\n"
    for name, first, second in (("a", "cool", "warm"), ("b", "warm", "cool")):
        text += f"icon {name} {{ {first} by 3 °C at 3 °C/s; {second} by 6 °C at 3 °C/s; return at 3 °C/s }}\n"
    icons, rig = parse(text), Rig.load("thenar")
    parts = named(distance_components(*(simulate(icon, rig, tail_s=10) for icon in icons)))
    assert parts["direction"].above


def test_of_what_is_not_felt_there_are_no_values(cue: Cue, observer: Observer) -> None:
    parts = named(distance_components(cue(-4.0), cue(0.0), observer))
    assert parts["direction"].above
    assert all(part.b is None for part in parts.values())
    assert parts["rate"].to_dict() == {
        "part": "rate", "value": 0.0, "unit": "d′", "noticeable": 1.0, "above": False, "a": parts["rate"].a, "b": None,
    }  # fmt: skip
    assert repr(DistanceComponent("rate", 2.0, 3.0, 1.0)) == "DistanceComponent(rate 2 d′)"


def test_pauses_that_differ_much_are_still_pauses() -> None:
    """A second dip after 6 s instead of 2 s: the alignment leaves it without a partner, the reason is its pause."""
    text = "cue 1\nset s { control display }\n"
    for name, rest_s in (("a", 2), ("b", 6)):
        dip = "cool by 3 °C at 2 °C/s; hold for 1 s; return at 2 °C/s"
        text += f"icon {name} {{ {dip}; rest for {rest_s} s; {dip} }}\n"
    icons, rig = parse(text), Rig.load("thenar")
    longest = max(icon.corners().duration_s for icon in icons)
    a, b = (simulate(icon, rig, tail_s=10 + longest - icon.corners().duration_s) for icon in icons)
    parts = distance_components(a, b)
    assert largest(parts) == "pause"
    pause = named(parts)["pause"]
    assert pause.a is not None and pause.b is not None and pause.b > pause.a + 2.0
    assert math.hypot(*(part.value for part in parts)) == pytest.approx(dprime_from_memory(perceive(a), perceive(b)))
