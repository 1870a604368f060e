import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception.observer.variants import VARIANTS, Model, Variable
from thermicon.perception.sensation.bench import Bench
from thermicon.perception.sensation.detection import false_alarms
from thermicon.perception.validation.plausible import plausible_observers, uncertain_records
from thermicon.perception.validation.procedures import forced_choice


@pytest.mark.parametrize(("variable", "model"), VARIANTS)
def test_draws_stay_in_their_intervals_and_fill_them(variable: Variable, model: Model) -> None:
    drawn = plausible_observers(16, variable=variable, model=model)
    assert {(o.variable, o.model) for o in drawn} == {(variable, model)}
    noise = np.array([o.noise_correlation_s for o in drawn])
    assert noise.min() >= 0.1
    assert noise.max() <= 1.0
    assert (noise < 0.3).sum() == 8
    strength = {o.cold.gain_strength for o in drawn}
    known = {r.quantity for r in uncertain_records(variable, model)}
    assert (len(strength) > 8) == any(name.startswith("gain control strength") for name in known)


def test_every_draw_keeps_its_false_alarms() -> None:
    for person in plausible_observers(8):
        assert 0.01 <= false_alarms(person.criterion, person.noise_correlation_s, 5.0) <= 0.0501


def test_every_draw_keeps_the_thresholds_within_what_their_step_leaves_open() -> None:
    """Rate and hold of the threshold step are not known, nor the area it was applied on: a factor of about two."""
    bench = Bench(Rig.load("thenar"))
    found = [forced_choice(person, bench, "cold").value or 0.0 for person in plausible_observers(8)]
    assert 0.05 < min(found) < 0.11 < max(found) < 0.2


def test_the_seed_decides() -> None:
    assert plausible_observers(4, seed=1) == plausible_observers(4, seed=1)
    assert plausible_observers(4, seed=1) != plausible_observers(4, seed=2)


def test_nothing_predicted_is_drawn_from() -> None:
    assert {record.use for record in uncertain_records()} <= {"calibrate", "assumed"}


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"at least two observers are needed to show an interval, not 1"):
        plausible_observers(1)
