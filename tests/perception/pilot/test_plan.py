"""Plans of experiments: the precision of each size."""

import json
import math

import numpy as np
import pytest

from tests.builders import messages
from tests.perception.pilot.madeup import synthetic_trials
from thermicon.circuit import Rig
from thermicon.icons import IconSet, read_cue
from thermicon.perception.pilot.observed import observed
from thermicon.perception.pilot.plan import _simulated, plan
from thermicon.perception.pilot.playing import Confusions
from thermicon.perception.pilot.states import LaboratoryPrior
from thermicon.perception.pilot.worth import worth_of


@pytest.mark.parametrize("trials", [5, 5000])
def test_a_width_is_that_of_students_interval(trials: int) -> None:
    right = np.clip(0.5 + 0.05 * np.random.default_rng(0).standard_normal((1, 4000)), 0.0, 1.0)
    chance = np.stack([np.stack([right, 1 - right], -1), np.stack([1 - right, right], -1)], -2)
    played = Confusions(("a", "b"), chance, np.ones(chance.shape[:3]))
    design = _simulated([played], 10, trials, np.random.SeedSequence(1))
    # 2 t(0.975, 9) c4(10) SD / sqrt(10), of people and of what so many trials leave.
    left = math.hypot(0.05, 0.5 / trials**0.5)
    assert design.width == pytest.approx(2 * 2.262 * 0.9727 * left / 10**0.5, rel=0.04)


@pytest.mark.parametrize(("people", "trials"), [(6, 12), (24, 96)])
def test_answers_narrow_by_what_laboratories_differ_in_beside_what_their_means_leave_open(
    people: int, trials: int
) -> None:
    """Laboratories differ by 0.03, people by 0.05, trials by chance: a product of two normal distributions."""
    rng = np.random.default_rng(2)
    right = 0.8 + 0.03 * rng.standard_normal((600, 1)) + 0.05 * rng.standard_normal((600, 200))
    right = np.clip(right, 0.01, 0.99)
    chance = np.stack([np.stack([right, 1 - right], -1), np.stack([1 - right, right], -1)], -2)
    played = Confusions(("a", "b"), chance, np.ones(chance.shape[:3]))
    left = (0.05**2 + 0.16 / trials) / people
    design = _simulated([played], people, trials, np.random.SeedSequence(1))
    assert design.narrower == pytest.approx(math.sqrt(1.0 + 0.03**2 / left), rel=0.06)


def test_measurements_are_worth_what_their_constants_explain_and_nothing_where_they_explain_nothing() -> None:
    prior = LaboratoryPrior.of(None, "episodes")
    laboratories = prior.first(300, 0)
    values, names = prior.values(laboratories), prior.names
    chance = np.random.default_rng(5).standard_normal(300)
    for known, data in (("decision time", "reaction times"), ("cold threshold drive", "thresholds of a dozen")):
        own = np.log(values[:, names.index(known)])
        half = (own - own.mean()) / own.std() + chance
        first, *others = worth_of(prior, laboratories, half)
        assert first.data.startswith(data)
        assert first.narrower == pytest.approx(math.sqrt(2.0), rel=0.08)
        assert max(each.narrower for each in others) < 1.2
    assert max(each.narrower for each in worth_of(prior, laboratories, chance)) < 1.05


@pytest.mark.slow
def test_a_pilot_narrows_about_as_much_as_was_planned(icons: IconSet, rig: Rig) -> None:
    """Pairs of these laboratories are as the model says, so that they narrow more than the mean over laboratories."""
    (design,) = plan(icons, rig, participants=[8], trials=[48], draws=200).designs
    ratios = []
    for seed in range(8):
        trials = synthetic_trials(icons, rig, participants=8, trials=48, seed=seed)
        (change,) = observed(trials, icons, rig, draws=400, seed=seed).predictions
        assert change.after is not None
        (_, *before), (_, *after) = (each.proportion_correct for each in (change.before, change.after))
        ratios.append((before[1] - before[0]) / (after[1] - after[0]))
    assert 0.75 * design.narrower < float(np.exp(np.mean(np.log(ratios)))) < 1.5 * design.narrower


@pytest.mark.slow
def test_a_plan_of_one_and_of_two_sets(icons: IconSet, rig: Rig) -> None:
    steps: list[tuple[int, int]] = []
    one = plan(
        icons, rig, participants=[4, 30], trials=[12, 48], draws=20, wanted=0.12,
        progress=lambda done, total: steps.append((done, total)),
    )  # fmt: skip
    widths = {(each.participants, each.trials): each.width for each in one.designs}
    assert widths[4, 12] > widths[4, 48] > widths[30, 48]
    best = one.cheapest
    assert best is not None and best.participants == 30 and best.width <= 0.12
    assert steps[-1][0] == steps[-1][1]
    assert one.to_dict()["wanted"] == {"interval_width": 0.12}
    two = plan(icons, rig, read_cue("pulse-sequences"), participants=[8], trials=[24], draws=20)
    design = two.designs[0]
    assert design.found is not None and design.wrong is not None
    assert design.found > 0.85 and design.wrong == 0.0  # six icons against twelve pulses
    assert two.difference is not None and two.difference[1] > 0.05  # with all doubt
    assert two.cheapest == design


@pytest.mark.parametrize(("options", "words"), messages(__file__)["plan"].items())
def test_sizes_that_cannot_be_are_refused(icons: IconSet, rig: Rig, options: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        plan(icons, rig, **json.loads(options))
