import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer
from thermicon.perception.evidence.predicted import plausible_observers
from thermicon.perception.experiments.on_bench import forced_choice
from thermicon.perception.observer.channels import VARIABLES, Variable
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.sensation.bench import Bench


@pytest.mark.parametrize("variable", VARIABLES)
def test_draws_are_those_of_the_posterior_and_fill_it(variable: Variable) -> None:
    drawn = plausible_observers(16, variable=variable)
    assert {o.variable for o in drawn} == {variable}
    known = PosteriorDraws.load(variable=variable).values("noise correlation time")
    noise = np.array([o.noise_correlation_s for o in drawn])
    assert set(noise.tolist()) <= set(known.tolist())
    assert 3 <= (noise < np.median(known)).sum() <= 13
    memory = {o.memory.timing for o in drawn}
    assert len(memory) == 16


def test_every_draw_keeps_the_thresholds_near_the_shipped_ones() -> None:
    bench = Bench(Rig.load("thenar"))
    shipped = forced_choice(Observer.load(), bench, "cold")
    found = [forced_choice(person, bench, "cold") for person in plausible_observers(8)]
    assert 0.35 * shipped < min(found) < max(found) < 2.5 * shipped


def test_the_seed_decides() -> None:
    assert plausible_observers(4, seed=1) == plausible_observers(4, seed=1)
    assert plausible_observers(4, seed=1) != plausible_observers(4, seed=2)


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"at least two observers are needed to show an interval, not 1"):
        plausible_observers(1)
