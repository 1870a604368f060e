from dataclasses import replace

import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import frontier, rank
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.observer_model import ObserverModel


def few_draws(count: int) -> ObserverModel:
    model = ObserverModel.load()
    posterior = model.posterior
    assert posterior is not None
    cut = PosteriorDraws(posterior.header, posterior.names, posterior.draws[:count])
    return replace(model, name="lab.csv", digest=f"first {count}", posterior=cut)


def test_draws_are_counted_and_refused_in_the_same_words() -> None:
    rig, lab, six = Rig.load("thenar"), few_draws(6), load_library("six-icons")
    seen = frontier(six, rig, people=4, most=2, observer=lab)
    assert seen.draws == 6  # without a number all draws of a small observer are used
    assert seen.points[0].low_with_model is not None
    for judge in (rank, frontier):
        with pytest.raises(ValueError, match=r"^9 draws of the parameters were asked for; lab.csv has 6$"):
            judge(six, rig, people=4, parameters=9, observer=lab)  # type: ignore[operator]
        with pytest.raises(ValueError, match=r"needs at least two draws of the parameters, or 0 for none, not 1$"):
            judge(six, rig, people=4, parameters=1)  # type: ignore[operator]
    plain = replace(ObserverModel.load(), posterior=None)
    assert [plain.draw_count(asked, 128) for asked in (None, 0, 64)] == [0, 0, 0]
