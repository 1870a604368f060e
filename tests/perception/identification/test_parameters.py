import numpy as np
import pytest

from thermicon.perception.identification.laboratory_draws import Uncertain, latin, memory_parameters


def test_what_of_memory_is_uncertain_depends_on_the_norm() -> None:
    common = {"share of the scatter of ratings", "bar of an episode", "memory noise (episodes)"}
    assert {each.name for each in memory_parameters("episodes")} == common
    assert {each.name for each in memory_parameters("naming")} == common | {"cost of a missing episode"}


def test_wide_intervals_are_drawn_in_logarithms() -> None:
    for low, high, middle in ((1.0, 100.0, 10.0), (1.0, 1.4, 1.2), (-1.0, 3.0, 1.0)):
        between = Uncertain("t", low, high)
        assert between.at(0.5) == pytest.approx(middle)
        assert between.share(middle) == pytest.approx(0.5)
    with pytest.raises(ValueError, match=r"t: 1 to 1 is not an interval"):
        Uncertain("t", 1.0, 1.0)


def test_a_latin_hypercube_has_one_draw_a_stratum() -> None:
    shares = latin(3, 8, seed=4)
    assert shares.shape == (8, 3)
    assert (np.sort((shares * 8).astype(int), axis=0) == np.arange(8)[:, None]).all()
    assert (shares == latin(3, 8, seed=4)).all()
    assert (shares != latin(3, 8, seed=5)).any()
