from dataclasses import replace

import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, load_library
from thermicon.perception import frontier, rank
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.observer_model import ObserverModel


@pytest.fixture(scope="module")
def six() -> IconSet:
    return load_library("six-icons")


def few_draws(count: int) -> ObserverModel:
    model = ObserverModel.load()
    posterior = model.posterior
    assert posterior is not None
    cut = PosteriorDraws(posterior.header, posterior.names, posterior.draws[:count])
    return replace(model, name="lab.csv", digest=f"first {count}", posterior=cut)


def test_without_a_number_all_draws_of_a_small_observer_are_used(six: IconSet) -> None:
    lab = few_draws(6)
    seen = frontier(six, Rig.load("thenar"), people=4, most=2, observer=lab)
    assert seen.draws == 6
    assert seen.points[0].low_with_model is not None


def test_more_draws_than_there_are_and_a_single_one_are_refused_in_the_same_words(six: IconSet) -> None:
    rig, lab = Rig.load("thenar"), few_draws(6)
    for judge in (rank, frontier):
        with pytest.raises(ValueError, match=r"^9 draws of the parameters were asked for; lab.csv has 6$"):
            judge(six, rig, people=4, parameters=9, observer=lab)  # type: ignore[operator]
        with pytest.raises(ValueError, match=r"needs at least two draws of the parameters, or 0 for none, not 1$"):
            judge(six, rig, people=4, parameters=1)  # type: ignore[operator]


def test_an_observer_without_draws_has_none_to_count() -> None:
    plain = replace(ObserverModel.load(), posterior=None)
    assert [plain.draw_count(asked, 128) for asked in (None, 0, 64)] == [0, 0, 0]
