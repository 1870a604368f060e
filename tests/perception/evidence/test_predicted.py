"""Predictions of observers from the posterior or from skin temperature alone."""

import math

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer, confuse
from thermicon.perception.evidence.baseline import nearer_of
from thermicon.perception.evidence.predicted import Query, laboratory_of, plausible_observers, predict
from thermicon.perception.evidence.targets import Published, TargetRow
from thermicon.perception.experiments.measure import Condition, Setting, logs_of
from thermicon.perception.identification.skin_alone import SAMPLES, named_by_skin, noise_K, noticed_K
from thermicon.perception.observer.channels import VARIABLES, Variable
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.people import People


@pytest.mark.parametrize("variable", VARIABLES)
def test_draws_are_those_of_the_posterior_and_fill_it(variable: Variable) -> None:
    drawn = plausible_observers(16, 0, variable)
    assert {o.variable for o in drawn} == {variable}
    known = PosteriorDraws.load(variable=variable).values("noise correlation time")
    noise = np.array([o.noise_correlation_s for o in drawn])
    assert set(noise.tolist()) <= set(known.tolist())
    assert 3 <= (noise < np.median(known)).sum() <= 13
    assert len({o.timing_noise for o in drawn}) == 16


def test_the_seed_decides() -> None:
    one, again, other = (plausible_observers(4, seed=seed) for seed in (1, 1, 2))
    assert one == again != other


def test_what_is_not_felt_is_none() -> None:
    found = predict("x", [Query("y", "cold", "K", "z", lambda _: float(np.inf))], "temperature", draws=2)
    assert (found[0].value, found[0].low, found[0].high) == (None, None, None)


def test_one_person_has_own_receptors_in_the_rig_no_offset_and_no_scatter_of_people_but_that_of_age() -> None:
    setting, limits = Setting.of(Rig.load("thenar")), Condition("threshold", "limits", "warm", 32.0, 12.0, 1.0, 0.0)
    choice = Condition("threshold", "forced_choice", "warm", 32.0, None, 1.0, 3.0)
    person = Observer.load()
    alone, old = (laboratory_of(person, setting, age_years=years) for years in (25.0, 65.0))
    assert alone.constants.depth_m == person.depth_m
    assert alone.constants.effusivity == 1.0
    young_logs, old_logs = (logs_of(each, setting, choice)[0] for each in (alone, old))
    assert np.ptp(young_logs) == 0.0
    assert old_logs[0] - young_logs[0] == pytest.approx(4.0 * person.lost_per_decade.warm, rel=0.05)
    many = logs_of(laboratory_of(person, setting, people=40), setting, limits)[0]
    assert (many.size, many.std() > 0.2) == (40, True)


def test_the_baseline_does_the_rate_task_as_people_do() -> None:
    """By courses that are written out; people say which of two ramps is 43 % faster in 75 to 84 % of trials."""
    square = []
    for span, wanted in ((span, wanted) for span in (2.0, 4.0) for wanted in (0.6744898, 0.9944579)):
        time = np.linspace(0.0, span / 0.5, 100_001)
        rms = math.sqrt(np.square(np.minimum(0.5 * 1.43 * time, span) - 0.5 * time).mean())
        square.append((rms / (math.sqrt(2.0) * wanted)) ** 2)
    assert noise_K() == pytest.approx(math.sqrt(np.mean(square)), rel=1e-4)
    assert (noticed_K("cold"), noticed_K("warm")) == (0.11, 0.20)


def test_the_baseline_names_icons_by_the_mean_square_until_the_longer_has_ended() -> None:
    skin = np.zeros((2, 3, 1000))
    skin[:, 1, :100], skin[:, 2, :400], skin[:, 1, 600:] = 1.0, -2.0, 50.0
    apart = np.array([[0.0, 1.0, 2.0], [1.0, 0.0, math.sqrt((9.0 * 100 + 4.0 * 300) / 400)], [2.0, 0.0, 0.0]])
    apart[2, 1] = apart[1, 2]
    found = named_by_skin(skin, [100, 100, 400], People.nominal(2), seed=0)
    again = confuse(np.stack([apart / noise_K()] * 2), lapse=People.nominal(2).lapse, samples=SAMPLES)
    assert found == pytest.approx(again.probability)


NUMBER, SPAN = Published("0.91", "us", unit="1", value=0.91), Published("0 to 0.12", "us", unit="1", low=0.0, high=0.12)


@pytest.mark.parametrize(
    ("rule", "published", "model", "baseline", "nearer"),
    [
        ("shown", NUMBER, 0.93, 0.87, "model"),
        ("shown", NUMBER, None, 0.87, "baseline"),
        ("shown", NUMBER, 0.93, None, ""),
        ("published range", SPAN, 0.2, 0.13, "baseline"),
        ("published range", SPAN, 0.03, 0.0, "both"),
        ("at least", Published("hard", "us"), 1.3, 4.7, "baseline"),
        ("above", Published("raised", "us"), 1.04, 1.0, "model"),
        ("shown", Published("hard", "us"), 1.0, 4.7, ""),
    ],
)
def test_which_is_nearer(rule: str, published: Published, model: float, baseline: float, nearer: str) -> None:
    row = TargetRow("x", "both", "1", "x", "y", rule, "us", value=1.0 if rule == "above" else 2.0, published="x")
    assert nearer_of(row, model, baseline, published) == nearer
