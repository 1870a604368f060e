from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library, parse
from thermicon.perception import Observer, perceive
from thermicon.perception.comparison.distance_components import COMPONENTS, DistanceComponent, distance_components
from thermicon.perception.identification.distance import smooth
from thermicon.perception.sensation.features import excursion_rate_K_per_s

Cue = Callable[..., Any]


def named(parts: tuple[DistanceComponent, ...]) -> dict[str, DistanceComponent]:
    assert tuple(part.name for part in parts) == COMPONENTS
    return {part.name: part for part in parts}


def test_icons_that_are_the_same_have_no_distance(cue: Cue, observer: Observer) -> None:
    parts = named(distance_components(cue(-4.0), cue(-4.0), observer))
    assert parts.pop("rate").value == 1.0
    assert [part.value for part in parts.values()] == pytest.approx([0.0] * 5)
    assert not any(part.above for part in parts.values())


def test_each_part_answers_to_what_was_changed(cue: Cue, observer: Observer) -> None:
    def between(a: Any, b: Any) -> dict[str, DistanceComponent]:
        return named(distance_components(a, b, observer))

    direction = between(cue(-4.0), cue(4.0))["direction"]
    assert direction.above
    assert between(cue(-4.0), cue(-2.0))["direction"].value == 0.0
    weaker = between(cue(-4.0), cue(-2.0))
    assert weaker["intensity"].above
    assert weaker["rate"].above is False
    slower = between(cue(-4.0, rate=4.0), cue(-4.0, rate=2.0))["rate"]
    assert (slower.value, slower.a, slower.b) == pytest.approx((2.0, 4.0, 2.0), rel=1e-6)
    longer = between(cue(-4.0, hold=2.0), cue(-4.0, hold=6.0))
    assert longer["duration"].value == pytest.approx(4.0, abs=0.5)
    assert longer["pattern"].value < longer["intensity"].noticeable * 20
    later = between(cue(-4.0), cue(-4.0, lag_s=1.0))
    assert later["onset"].value == pytest.approx(1.0, abs=0.011)
    assert later["pattern"].value == pytest.approx(0.0, abs=0.05)  # aligned in time, nothing is left
    assert later["duration"].value == pytest.approx(0.0, abs=0.02)


def test_a_double_dip_has_a_pattern_of_its_own() -> None:
    rig, icons = Rig.load("thenar"), load_library("six-icons")
    step, dip, slow = (
        simulate(icons[name], rig, tail_s=10) for name in ("cooling-step", "double-dip", "linear-cooling")
    )
    person = Observer.load()
    double, single = (named(distance_components(step, other, person)) for other in (dip, slow))
    assert double["direction"].value == 0.0
    assert double["pattern"].value > 1.5 * single["pattern"].value
    assert double["pattern"].above


def test_every_number_can_be_computed_from_the_traces_again() -> None:
    rig, icons = Rig.load("thenar"), load_library("six-icons")
    a, b = (simulate(icons[name], rig, tail_s=10) for name in ("warming-step", "linear-warming"))
    person = Observer.load()
    felt = perceive(a, person), perceive(b, person)
    parts = named(distance_components(a, b, person, felt))
    assert parts == named(distance_components(a, b, person))
    totals = []
    for percept in felt:
        both = [smooth(psi, percept.dt_s, person.onset_uncertainty_s) for psi in (percept.psi_cold, percept.psi_warm)]
        totals.append(np.hypot(*both))
    peaks = [float(total.max()) for total in totals]
    assert (parts["intensity"].a, parts["intensity"].b) == pytest.approx(peaks)
    assert parts["intensity"].value == pytest.approx(abs(peaks[0] - peaks[1]))
    for key, total, percept in zip("ab", totals, felt, strict=True):
        over = np.flatnonzero(total >= total.max() / 2)
        assert getattr(parts["duration"], key) == pytest.approx(
            (over[-1] - over[0]) * percept.dt_s, abs=2 * percept.dt_s
        )
        assert getattr(parts["onset"], key) == percept.onset_s
    rates = [excursion_rate_K_per_s(trace, "warm") for trace in (a, b)]
    assert parts["rate"].value == pytest.approx(max(rates) / min(rates))
    assert parts["duration"].noticeable == pytest.approx(2**0.5 * person.onset_uncertainty_s)
    assert parts["direction"].noticeable == person.criterion


def test_the_order_of_directions_counts() -> None:
    text = "cue 1\nset s { control display }\n"
    for name, first, second in (("a", "cool", "warm"), ("b", "warm", "cool")):
        text += f"icon {name} {{ {first} by 3 °C at 3 °C/s; {second} by 6 °C at 3 °C/s; return at 3 °C/s }}\n"
    icons, rig = parse(text), Rig.load("thenar")
    parts = named(distance_components(*(simulate(icon, rig, tail_s=10) for icon in icons)))
    assert parts["direction"].above


def test_of_what_is_not_felt_there_is_nothing_to_compare(cue: Cue, observer: Observer) -> None:
    parts = named(distance_components(cue(-4.0), cue(0.0), observer))
    for name in ("rate", "duration", "pattern", "onset"):
        assert parts[name].value is None
        assert (parts[name].above, parts[name].times) == (None, None)
        assert repr(parts[name]) == f"DistanceComponent({name}: nothing to compare)"
    assert parts["direction"].above
    assert parts["onset"].to_dict()["b"] is None


def test_a_part_says_what_it_is() -> None:
    assert repr(DistanceComponent("onset", 0.5, "s", 0.2)) == "DistanceComponent(onset 0.5 s, just noticeable 0.2 s)"
    assert repr(DistanceComponent("rate", 2.0, "1", 1.43)) == "DistanceComponent(rate 2, just noticeable 1.43)"
    assert list(DistanceComponent("rate", 2.0, "1", 1.43).to_dict()) == [
        "part",
        "value",
        "unit",
        "noticeable",
        "above",
        "a",
        "b",
    ]
