import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library, parse
from thermicon.perception import Sensitivity, sensitivity
from thermicon.perception.sensitivity.simulation_grid import NODES, SimulationGrid, _parabola, simulate_grid

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
    return sensitivity(parse(TWO), rig, people=6, samples=8)


@pytest.fixture(scope="module")
def stage(rig: Rig) -> SimulationGrid:
    return simulate_grid(tuple(parse(TWO)), rig, 3, 0, "max")


def test_effects_are_ordered_and_say_what_to_measure_first(found: Sensitivity) -> None:
    names = [e.parameter.name for e in found.effects]
    assert len(names) == len(set(names))
    assert {"contact resistance", "lapse rate", "memory noise (episodes)"} <= set(names)
    sizes = [e.proportion_correct for e in found.effects]
    assert sizes == sorted(sizes, reverse=True)
    assert min(sizes) >= 0.0
    assert found.first
    assert found.first[0] == names[0]
    assert found.runs == 1 + 2 * len(names) + 8 * (len(names) + 2)
    assert repr(found).startswith(f"Sensitivity({len(names)} parameters on thenar, {found.runs} runs of 6 people, ")
    assert f"measure first {names[0]}" in repr(found)


def test_more_memory_noise_is_fewer_correct(found: Sensitivity) -> None:
    (memory,) = (e for e in found.effects if e.parameter.name == "memory noise (episodes)")
    low, high = memory.proportion_correct_ends
    assert low > found.proportion_correct > high
    assert memory.information_bits_ends[0] > found.information_bits > memory.information_bits_ends[1]


def test_as_a_table_and_a_picture(found: Sensitivity) -> None:
    frame = found.to_frame()
    assert len(frame) == len(found.effects)
    assert {"parameter", "unit", "low", "high", "proportion_correct_total_index", "source"} <= set(frame.columns)
    axes = found.plot()
    assert [t.get_text() for t in axes.get_yticklabels()] == list(frame["parameter"])
    assert axes.yaxis_inverted()
    colours = {bar.get_facecolor()[:3] for bar in axes.patches}
    assert len(colours) == 2
    assert "total Sobol index" in axes.get_xlabel()
    assert found._repr_html_().startswith("<svg")


def test_the_same_arguments_give_the_same_numbers(found: Sensitivity, rig: Rig) -> None:
    steps: list[tuple[int, int]] = []
    again = sensitivity(parse(TWO), rig, people=6, samples=8, progress=lambda done, total: steps.append((done, total)))
    assert again == found
    assert steps == [(k, found.runs) for k in range(1, found.runs + 1)]


def test_total_indices_are_those_of_a_known_function() -> None:
    from thermicon.perception.sensation.parameters import latin
    from thermicon.perception.sensitivity.sensitivity import total_indices

    base = 2048
    both = latin(4, base, seed=1)
    a, b = both[:, :2], both[:, 2:]
    mixed = [np.stack([b[:, 0], a[:, 1]], -1), np.stack([a[:, 0], b[:, 1]], -1)]
    rows = np.concatenate([a, b, *mixed])
    values = np.stack([2.0 * rows[:, 0] + rows[:, 1], np.full(len(rows), 3.0)], -1)
    sizes = total_indices(values, base)
    assert sizes[:, 0] == pytest.approx([0.8, 0.2], abs=0.03)  # variances 4 : 1
    assert sizes[:, 1] == pytest.approx([0.0, 0.0])


def test_temperatures_between_the_nodes_are_those_of_a_run(stage: SimulationGrid, rig: Rig) -> None:
    from thermicon.circuit import simulate_many

    shares = stage.centre.copy()
    place = [p.name for p in stage.parameters].index("contact resistance")
    shares[place] = 0.7
    resistance = stage.parameters[place].at(0.7)
    moved = rig.with_(**{"contact.resistance_m2K_per_W": resistance})
    end = float(stage.time_s[-1])
    batch = simulate_many(tuple(parse(TWO)), stage.crowd.rigs(moved), nominal=rig, end_s=end, rate_Hz=25.0)
    played = stage.played(shares)
    assert played.cold_C == pytest.approx(batch.cold_C, abs=5e-3)
    assert played.warm_C == pytest.approx(batch.warm_C, abs=5e-3)
    for k, node in enumerate(NODES):
        assert _parabola(node) == pytest.approx(np.eye(3)[k])


def test_people_are_spread_and_lapse_as_asked(stage: SimulationGrid) -> None:
    shares = stage.centre.copy()
    assert stage.crowd_at(shares).threshold_cold == pytest.approx(stage.crowd.threshold_cold)
    shares[[p.name for p in stage.parameters].index("lapse rate")] = 1.0
    shares[[p.name for p in stage.parameters].index("spread of thresholds between people")] = 1.0
    moved = stage.crowd_at(shares)
    assert moved.lapse == pytest.approx(1.5 * stage.crowd.lapse)
    assert np.log(moved.threshold_warm) == pytest.approx(0.27 / 0.23 * np.log(stage.crowd.threshold_warm))


def test_messages(rig: Rig) -> None:
    icons = load_library("six-icons")
    with pytest.raises(ValueError, match=r"at least 2 samples, not 1"):
        sensitivity(icons, rig, samples=1)
    with pytest.raises(ValueError, match=r"sobol needs a power of 2 of samples, such as 16, not 10"):
        sensitivity(icons, rig, samples=10)
    with pytest.raises(ValueError, match=r"there is no norm 'mean'"):
        sensitivity(icons, rig, norm="mean")
    one = parse("cue 1\nset s { control skin }\nicon a { cool by 2 °C at 1 °C/s }")
    with pytest.raises(ValueError, match=r"needs at least two icons"):
        sensitivity(one, rig)
