import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer
from thermicon.perception.observer.observer import observer_records
from thermicon.perception.observer.variants import VARIANTS, Model, Variable, source_of
from thermicon.perception.procedures.classical import forced_choice
from thermicon.perception.sensation.bench import Bench
from thermicon.perception.validation.plausible import plausible_observers, uncertain_records


@pytest.mark.parametrize(("variable", "model"), VARIANTS)
def test_draws_stay_in_their_intervals_and_fill_them(variable: Variable, model: Model) -> None:
    drawn = plausible_observers(16, variable=variable, model=model)
    assert {(o.variable, o.model) for o in drawn} == {(variable, model)}
    ending = source_of(variable, model)
    record = observer_records().one(f"noise correlation time{ending}")
    noise = np.array([o.noise_correlation_s for o in drawn])
    assert noise.min() >= record.interval[0]
    assert noise.max() <= record.interval[1]
    assert (noise < record.central).sum() == 8
    known = {r.quantity for r in uncertain_records(variable, model)}
    assert ("limit" in known) == ((variable, model) == ("temperature", "adapting"))
    assert not [name for name in known if name.startswith("threshold drive")]


def test_every_draw_keeps_the_thresholds_near_the_shipped_ones() -> None:
    bench = Bench(Rig.load("thenar"))
    shipped = forced_choice(Observer.load(), bench, "cold").value or 0.0
    found = [forced_choice(person, bench, "cold").value or 0.0 for person in plausible_observers(8)]
    # What is left is the area that the published thresholds were measured on, 3 to 15 cm², and not stated.
    assert 0.35 * shipped < min(found) < max(found) < 2.5 * shipped


def test_the_seed_decides() -> None:
    assert plausible_observers(4, seed=1) == plausible_observers(4, seed=1)
    assert plausible_observers(4, seed=1) != plausible_observers(4, seed=2)


def test_nothing_predicted_is_drawn_from() -> None:
    assert {record.use for record in uncertain_records()} <= {"calibrate", "assumed"}


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"at least two observers are needed to show an interval, not 1"):
        plausible_observers(1)
