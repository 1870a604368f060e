from dataclasses import replace

import numpy as np
import pytest

from tests.builders import without_pairs
from thermicon.circuit import Rig
from thermicon.icons import load_library, parse
from thermicon.perception import Observer, draw_people
from thermicon.perception.identification.laboratory_draws import memory_parameters
from thermicon.perception.observer.channels import FORM
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.ranking.sensitivity import (
    NODES,
    Sensitivity,
    UncertainRig,
    _parabola,
    base_name,
    load_measurements,
    sensitivity,
)

TWO = """cue 1
set s { control skin; baseline 32 °C }
icon a { cool by 3 °C at 2 °C/s; hold for 1 s; return at 2 °C/s }
icon b { cool by 4 °C at 1 °C/s; hold for 1 s; return at 2 °C/s }
"""


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig.load("thenar")


@pytest.fixture(scope="module")
def found(rig: Rig) -> Sensitivity:
    return sensitivity(parse(TWO), rig, people=6, draws=96)


def test_effects_are_ordered_and_measurements_too(found: Sensitivity) -> None:
    names = [each.constant for each in found.effects]
    assert len(names) == len(set(names))
    assert {"contact resistance", "laboratory, cold", "memory noise (episodes)"} <= set(names)
    sizes = [each.proportion_correct for each in found.effects]
    assert sizes == sorted(sizes, reverse=True)
    assert all(0.0 <= size <= 1.0 for size in sizes)
    # A measurement tells several constants at once: no less than the one that counts most.
    first = found.first[0]
    alone = max(each.proportion_correct for each in found.effects if each.constant in first.constants)
    assert first.proportion_correct > 0.8 * alone
    assert [each.proportion_correct for each in found.reductions] == sorted(
        (each.proportion_correct for each in found.reductions), reverse=True
    )
    assert f"measure first: {first.measurement}" in repr(found)
    low, high = found.proportion_correct_interval
    assert low < found.proportion_correct < high
    (memory,) = (each for each in found.effects if each.constant == "memory noise (episodes)")
    assert memory.low < memory.high and memory.at_low > memory.at_high
    assert not {each.constant for each in found.effects} & set(PosteriorDraws.load().header.offsets)


def test_every_constant_has_its_measurement() -> None:
    draws = PosteriorDraws.load()
    names = [name for name in draws.names if name not in draws.header.offsets]
    names += [*(parameter.name for parameter in memory_parameters("both")), FORM]
    names += ["laboratory, cold", "laboratory, warm", "contact resistance", "thickness of the outermost layer"]
    assert {base_name(name) for name in names} == set().union(*load_measurements().values())


def test_as_a_picture(found: Sensitivity) -> None:
    axes = found.plot()
    assert [t.get_text() for t in axes.get_yticklabels()] == [each.constant for each in found.effects][:16]
    assert axes.yaxis_inverted()
    assert len({bar.get_facecolor()[:3] for bar in axes.patches}) == 2


def test_the_same_arguments_give_the_same_numbers(found: Sensitivity, rig: Rig) -> None:
    steps: list[tuple[int, int]] = []
    again = sensitivity(parse(TWO), rig, people=6, draws=96, progress=lambda done, total: steps.append((done, total)))
    assert again == found
    assert steps == [(k, 96) for k in range(1, 97)]


@pytest.mark.slow
def test_a_rig_whose_contact_is_known_leaves_less_doubt_about_it(rig: Rig) -> None:
    known = rig.with_(**{"uncertainty.contact_resistance_relative": 0.31})
    wide = rig.with_(**{"uncertainty.contact_resistance_relative": 0.9})
    low, high = (
        next(e for e in found.effects if e.constant == "contact resistance")
        for each in (known, wide)
        for found in (sensitivity(parse(TWO), each, people=6, draws=96, memory="episodes", observer=without_pairs()),)
    )
    assert high.high > 1.3 * low.high
    assert high.proportion_correct > low.proportion_correct


def test_temperatures_between_the_nodes_are_those_of_a_run(rig: Rig) -> None:
    from thermicon.circuit import simulate_many

    people, icons = draw_people(3, 0), tuple(parse(TWO))
    person = Observer.load()
    others = [person, replace(person, depth_m=Both(0.05e-3, 0.15e-3)), replace(person, depth_m=Both(0.2e-3, 0.4e-3))]
    uncertain = UncertainRig.simulate(icons, rig, people, 8.0, others)
    moved = rig.with_(**{"contact.resistance_m2K_per_W": uncertain.parameters[0].at(0.7)})
    for one in others:
        rigs = people.rigs(moved, [one.depths_m(each) for each in people.corneum_m(rig).tolist()])
        batch = simulate_many(icons, rigs, nominal=rig, end_s=8.0, rate_Hz=12.5)
        cold, warm = uncertain.played(0.7, 0.5).felt_by(one)
        assert cold == pytest.approx(batch.cold_C, abs=0.05)
        assert warm == pytest.approx(batch["warm_receptor_C"], abs=0.05)
    for k, node in enumerate(NODES):
        assert _parabola(node) == pytest.approx(np.eye(3)[k])


def test_messages(rig: Rig) -> None:
    one = parse("cue 1\nset s { control skin }\nicon a { cool by 2 °C at 1 °C/s }")
    for icons, told, said in (
        (load_library("six-icons"), {"draws": 1001}, r"needs 64 to 1000 draws of the posterior, not 1001"),
        (load_library("six-icons"), {"draws": 63}, r"needs 64 to 1000 draws of the posterior, not 63"),
        (load_library("six-icons"), {"memory": "mean"}, r"memory takes 'both', 'episodes' or 'naming', not 'mean'"),
        (one, {}, r"needs at least two icons"),
    ):
        with pytest.raises(ValueError, match=said):
            sensitivity(icons, rig, **told)  # type: ignore[arg-type]
