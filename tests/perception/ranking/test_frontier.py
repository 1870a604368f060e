import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import ChoiceError, Frontier, frontier, rank
from thermicon.perception.selection.request import Selection


@pytest.fixture(scope="module")
def found() -> Frontier:
    return frontier(load_library("six-icons"), Rig.load("thenar"), people=12, seed=3, objective="worst", most=5)


def test_every_size_has_its_best_choice(found: Frontier) -> None:
    assert [len(point.icons) for point in found.points] == [2, 3, 4, 5]
    correct = [point.proportion_correct for point in found.points]
    assert correct == sorted(correct, reverse=True)
    worst = [point.d_prime for point in found.points]
    assert worst == sorted(worst, reverse=True)
    for point in found.points:
        assert point.low <= point.proportion_correct <= 1.0
        assert 0.0 < point.information_bits <= np.log2(len(point.icons))
        assert point.total_s > 0.0


def test_a_choice_is_that_of_rank(found: Frontier) -> None:
    asked = Selection(3, "worst")
    whole = rank(load_library("six-icons"), Rig.load("thenar"), people=12, seed=3, parameters=0, choosing=asked)
    assert whole.chosen is not None
    point = found.points[1]
    assert set(point.icons) == set(whole.chosen.icons)
    assert point.d_prime == pytest.approx(whole.chosen.value, rel=1e-6)
    assert point.proportion_correct == pytest.approx(whole.chosen.at_own_range.proportion_correct, abs=0.01)
    assert point.total_s == pytest.approx(whole.chosen.total_s)


def test_as_a_table_and_a_picture(found: Frontier) -> None:
    frame = found.to_frame()
    assert list(frame["icons"]) == [2, 3, 4, 5]
    assert frame["names"][0].split() == list(found.points[0].icons)
    axes = found.plot()
    assert axes.get_ylabel() == "correct (%)"
    assert len(axes.lines) == 3
    assert repr(found).startswith("Frontier(2 to 5 of 6 icons by worst on thenar")


def test_total_time_ends_the_curve() -> None:
    steps: list[tuple[int, int]] = []
    short = frontier(
        load_library("six-icons"),
        Rig.load("thenar"),
        people=4,
        most_s=17.0,
        progress=lambda done, total: steps.append((done, total)),
    )
    assert [len(point.icons) for point in short.points] == [2]
    assert short.points[0].total_s <= 17.0
    assert steps[0][0] == 1
    with pytest.raises(ChoiceError, match="a choice of 1 has no pair"):
        frontier(load_library("six-icons"), Rig.load("thenar"), most=1)
