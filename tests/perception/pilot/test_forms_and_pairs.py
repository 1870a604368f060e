"""What answers say of the form of memory and of pairs, and that neither is in what they do not touch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.perception.pilot.madeup import synthetic_trials
from thermicon.circuit import Rig
from thermicon.icons import IconSet
from thermicon.perception import rank
from thermicon.perception.identification.pairs import pair_scores
from thermicon.perception.observer.channels import FORM, MemoryForm
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.pilot.conditioning import Namings
from thermicon.perception.pilot.evened import evened
from thermicon.perception.pilot.observed import Observed, observed
from thermicon.perception.pilot.pair_posterior import PairPosterior
from thermicon.perception.pilot.playing import Confusions, without_chance
from thermicon.perception.pilot.prediction import Fit
from thermicon.perception.pilot.states import Laboratories, LaboratoryPrior
from thermicon.perception.pilot.trials import Trials

DRAWS = 120


@pytest.fixture(scope="module")
def confused(icons: IconSet, rig: Rig) -> Observed[Namings, Fit]:
    """Four people who take the double dip for cold to warm, and the other way, in a third of trials; nothing else."""
    names = tuple(icon.name for icon in icons)
    counts = np.zeros((4, 6, 6))
    counts[:] = 9.0 * np.eye(6)
    a, b = names.index("double-dip"), names.index("cold-to-warm")
    counts[:, a, a] = counts[:, b, b] = 6.0
    counts[:, a, b] = counts[:, b, a] = 3.0
    other = IconSet.of([icons.icons[b], icons.icons[a]])
    answers = Trials(names, ("P1", "P2", "P3", "P4"), counts)
    return observed(answers, icons, rig, others=[other], draws=DRAWS, seed=1)


def test_a_pair_that_is_confused_moves_and_others_hardly(confused: Observed[Namings, Fit]) -> None:
    before, after = (each.pooled.mean(axis=0) for each in (confused.conditioned.simulated, confused.confusions_after))
    names = confused.played.icons
    a, b = names.index("double-dip"), names.index("cold-to-warm")
    both = 0.5 * (after[a, b] + after[b, a])
    assert 2.5 * (before[a, b] + before[b, a]) / 2.0 < both
    assert 0.15 < both < 0.4, "a third of the answers"
    off = after - before
    off[[a, b], [b, a]] = 0.0
    assert off[~np.eye(6, dtype=bool)].max() < 0.04
    scores = confused.conditioned.scores.mean(axis=0)
    assert scores[a, b] > 0.8 and scores[a, b] == scores.max()


def test_a_pair_of_the_same_names_is_confused_in_another_set_as_well(confused: Observed[Namings, Fit]) -> None:
    own = confused.predictions[1]
    assert own.after is not None
    assert own.after.proportion_correct[0] < own.before.proportion_correct[0] - 0.05


@pytest.mark.parametrize("memory", ["naming", "episodes"])
def test_answers_raise_the_share_of_the_form_that_they_were_given_with(
    icons: IconSet, rig: Rig, memory: MemoryForm
) -> None:
    answers = synthetic_trials(icons, rig, participants=8, trials=48, seed=1, memory=memory)
    found = observed(answers, icons, rig, draws=DRAWS, seed=2)
    before, after = found.forms[memory]
    assert before == 0.5 and after is not None and after > 0.6
    told = found.to_dict()["forms_of_memory"]
    assert told[memory] == {"before": 0.5, "after": after}
    assert sum(each["after"] for each in told.values()) == pytest.approx(1.0)


def test_a_form_that_is_named_is_obeyed(icons: IconSet, rig: Rig) -> None:
    answers = synthetic_trials(icons, rig, participants=2, trials=12, seed=3)
    found = observed(answers, icons, rig, draws=40, memory="naming")
    assert found.forms == {"naming": (1.0, 1.0)}
    assert found.conditioned.after.form.all()


def test_a_kept_laboratory_names_its_form_and_the_spread_of_pairs_and_is_ranked(
    confused: Observed[Namings, Fit], icons: IconSet, rig: Rig, tmp_path: Path
) -> None:
    path = tmp_path / "lab.csv"
    path.write_text(confused.files()[1], encoding="utf-8")
    draws = PosteriorDraws.load(path)
    assert {FORM, "spread of pairs between laboratories"} <= {*draws.memory_names}
    share = np.mean([form == "naming" for form in draws.forms or ()])
    assert share == confused.forms["naming"][1]
    found = rank(icons, rig, observer=path, people=8, parameters=20)
    assert found.new_laboratory is not None and found.new_laboratory.draws == 20
    assert "laboratory" not in found.new_laboratory.covers, "it is this one"
    each = found.by_form
    mean = share * each.get("naming", 0.0) + (1.0 - share) * each.get("episodes", 0.0)
    assert found.proportion_correct == pytest.approx(mean), "as often as its draws have it"


def laboratories(n: int, seed: int) -> Laboratories:
    rng = np.random.default_rng(seed)
    return Laboratories(rng.standard_normal((n, 4)), np.zeros(n, dtype=np.int64), np.arange(n) % 2)


@pytest.mark.parametrize("apart", [0.0, 0.5])
def test_people_scatter_goes_from_means_and_what_laboratories_are_stays(apart: float) -> None:
    """Two icons; laboratories differ by the first coordinate, by `apart` of their own, and by who 24 people are."""
    rng, some = np.random.default_rng(4), laboratories(400, 1)
    own = 1.0 + 0.4 * some.place[:, :1] + apart * rng.standard_normal((400, 1))
    truth, people = (1.0 / (1.0 + np.exp(-(own + rng.standard_normal((400, n))))) for n in (2000, 24))
    chance = np.stack([np.stack([people, 1 - people], -1), np.stack([1 - people, people], -1)], -2)
    played = Confusions(("a", "b"), chance, np.full((400, 24, 2), 0.9))
    found = evened(some, played).correct
    wrong = [float((each - truth.mean(axis=1)).std()) for each in (played.correct, found)]
    assert wrong[1] < (0.97 if apart else 0.6) * wrong[0]
    assert found.std() == pytest.approx(truth.mean(axis=1).std(), rel=0.06)


@pytest.mark.parametrize("spread", [0.0, 0.15])
def test_people_counted_in_few_trials_differ_as_much_as_they_do(spread: float) -> None:
    rng = np.random.default_rng(5)
    right = np.clip(0.7 + spread * rng.standard_normal((400, 1)), 0.05, 0.95)
    counts = rng.binomial(32, np.repeat(right, 6, axis=1)) / 32.0
    named = np.stack([np.stack([counts[:, k], 1.0 - counts[:, k]], -1) for k in range(2)], 1)
    found = without_chance(named, 32)
    assert found.sum(axis=-1) == pytest.approx(1.0)
    assert found[..., 0].mean() == pytest.approx(named[..., 0].mean())
    assert found[..., 0].std() == pytest.approx(right.std(), rel=0.15, abs=0.02)
    assert named[..., 0].std() > found[..., 0].std() + (0.05 if spread == 0.0 else 0.01)


@pytest.mark.parametrize("spread", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("wrong", [1.0, 3.0, 30.0])
def test_a_pair_agrees_with_integration_over_its_score(wrong: float, spread: float) -> None:
    """People who are all alike, whose answers are then binomial."""
    chance, shown, spreads = np.array([[0.9, 0.1], [0.1, 0.9]]), 100.0, np.full(1, spread)
    played = Confusions(("a", "b"), np.broadcast_to(chance, (1, 24, 2, 2)).copy(), np.ones((1, 24, 2)), spreads)
    counts = np.array([[[shown - wrong, wrong], [wrong, shown - wrong]]])
    found = PairPosterior.of(played, None, counts)
    z = np.linspace(-8.0, 8.0, 4001)
    odds = np.exp(spread * z - 0.5 * spread**2) / 9.0
    log = 2.0 * (wrong * np.log(odds / (1.0 + odds)) - (shown - wrong) * np.log1p(odds)) - 0.5 * z**2
    weight = np.exp(log - log.max())
    mean = (weight * z).sum() / weight.sum()
    sd = np.sqrt((weight * (z - mean) ** 2).sum() / weight.sum())
    assert float(found.mode[0, 0]) == pytest.approx(z[log.argmax()], abs=0.01)
    assert abs(float(found.mode[0, 0]) - mean) < 0.35 * sd
    assert float(found.root[0, 0, 0]) == pytest.approx(sd, rel=0.12)
    exact = log.max() + np.log(weight.sum() * (z[1] - z[0]) / np.sqrt(2.0 * np.pi))
    assert float(found.log_likelihood[0]) == pytest.approx(exact, abs=0.1)


def test_laboratories_whose_pairs_are_as_the_model_says_keep_them(icons: IconSet, rig: Rig) -> None:
    prior = LaboratoryPrior(PosteriorDraws.load(), "both")
    some = prior.first(10, 1)
    assert sorted(some.form.tolist()) == [0] * 5 + [1] * 5
    chance = np.full((10, 24, 2, 2), 0.5)
    played = Confusions(("a", "b"), chance, np.ones((10, 24, 2)))
    assert np.array_equal(played.with_scores(np.ones((10, 2, 2))).probability, chance)


def test_pairs_that_are_taken_out_leave_the_people_as_they_were() -> None:
    chance = np.random.default_rng(2).dirichlet(np.ones(3), size=(5, 4, 3))
    played = Confusions(("a", "b", "c"), chance, np.ones((5, 4, 3)), np.linspace(0.3, 3.0, 5))
    scores = pair_scores(3, 5, 8)
    apart = played.with_scores(scores)
    assert not np.allclose(apart.probability, chance, atol=0.05)
    assert apart.without_scores(scores).probability == pytest.approx(chance, abs=1e-12)
