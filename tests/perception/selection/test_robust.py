import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet
from thermicon.perception import draw_people
from thermicon.perception.selection.appraise import compare_sets, drawn_rigs, population_dprime
from thermicon.perception.selection.request import ChoiceError


def test_the_probability_is_recomputed(six: IconSet, rig: Rig) -> None:
    crowd = draw_people(16, 2)
    d = population_dprime(list(six)[:5], rig, crowd, rigs=drawn_rigs(crowd.rigs(rig), 2), end_s=None)[0]
    first, second = np.triu_indices(3, 1)
    mine = d[:, :3, :3][:, first, second].min(axis=1)
    other = d[:, 2:5, 2:5][:, first, second].min(axis=1)
    duel = compare_sets(list(six)[:3], list(six)[2:5], rig, draws=16, seed=2)
    assert duel.probability == pytest.approx(np.mean(mine > other))
    assert duel.gain == pytest.approx(np.median(mine - other))


def test_a_set_beats_itself_half_of_the_time(six: IconSet, rig: Rig) -> None:
    duel = compare_sets(list(six)[:3], list(six)[:3], rig, draws=6)
    assert (duel.probability, duel.gain) == (0.5, 0.0)


def test_fewer_of_the_same_are_never_worse_in_the_worst_pair(six: IconSet, rig: Rig) -> None:
    duel = compare_sets(list(six)[:4], six, rig, draws=8)
    assert duel.probability >= 0.5
    assert duel.gain >= 0.0


def test_rigs_are_drawn_about_their_own_values(rig: Rig) -> None:
    rigs = drawn_rigs([rig] * 50, 0)
    ambient = np.array([each.ambient.temperature_C for each in rigs])
    sink = np.array([each.heat_sink.resistance_K_per_W for each in rigs])
    assert abs(ambient.mean() - rig.ambient.temperature_C) < 1.0
    assert np.all(np.abs(ambient - rig.ambient.temperature_C) <= 4.0)
    assert 0.8 < np.median(sink) / rig.heat_sink.resistance_K_per_W < 1.25
    assert [r.ambient for r in drawn_rigs([rig] * 3, 0)] == [r.ambient for r in rigs[:3]]


def test_bad_questions(six: IconSet, rig: Rig) -> None:
    with pytest.raises(ChoiceError, match=r"^B has only 1 icon: at least two"):
        compare_sets(six, list(six)[:1], rig)
    with pytest.raises(ChoiceError, match=r"^at least one draw is needed, not 0$"):
        compare_sets(six, six, rig, draws=0)
