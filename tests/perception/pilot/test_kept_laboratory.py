"""A laboratory that `observed` keeps predicts, when it is ranked, what `observed` said of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.perception.pilot.madeup import synthetic_trials
from thermicon.circuit import Rig
from thermicon.icons import IconSet
from thermicon.perception import rank
from thermicon.perception.identification.laboratory import DRAWS
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.pilot.conditioning import Answered
from thermicon.perception.pilot.laboratory_file import middle_of, off_middle
from thermicon.perception.pilot.observed import Observed, observed
from thermicon.perception.pilot.prediction import Fit
from thermicon.perception.ranking.sensitivity import sensitivity


def pilot(icons: IconSet, rig: Rig, participants: int, trials: int, draws: int, seed: int) -> Observed[Answered, Fit]:
    answers = synthetic_trials(icons, rig, participants=participants, trials=trials, seed=seed)
    return observed(answers, icons, rig, draws=draws)


def kept(found: Observed[Answered, Fit], folder: Path) -> ObserverModel:
    (folder / "lab.csv").write_text(found.files()[1], encoding="utf-8")
    return ObserverModel.load(folder / "lab.csv")


def compared(found: Observed[Answered, Fit], icons: IconSet, rig: Rig, folder: Path) -> tuple[float, float]:
    """By how much `rank` differs from `observed` (0–1), and the shared part of the shorter of their intervals."""
    model = kept(found, folder)
    assert model.posterior is not None
    ranking = rank(icons, rig, observer=model, parameters=min(DRAWS, len(model.posterior)))
    assert ranking.new_laboratory is not None
    middle, low, high = found.predictions[0].after.proportion_correct
    least, most = ranking.new_laboratory.proportion_correct
    shared = min(high, most) - max(low, least)
    return ranking.proportion_correct - middle, shared / min(high - low, most - least)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("participants", "trials", "draws", "seed"), [(4, 24, 120, 8), (12, 48, 300, 2), (12, 48, 300, 5), (3, 60, 300, 1)]
)
def test_rank_says_of_a_kept_laboratory_what_observed_said(
    icons: IconSet, rig: Rig, tmp_path: Path, participants: int, trials: int, draws: int, seed: int
) -> None:
    off, shared = compared(pilot(icons, rig, participants, trials, draws, seed), icons, rig, tmp_path)
    assert abs(off) < (0.03 if participants == 4 else 0.04)
    assert shared > 0.75


@pytest.mark.slow
def test_draws_judge_with_their_own_memory(icons: IconSet, rig: Rig, tmp_path: Path) -> None:
    model = kept(pilot(icons, rig, 2, 12, 130, 4), tmp_path)
    assert model.posterior is not None
    found = sensitivity(icons, rig, people=2, draws=64, observer=model)
    for name, column in zip(model.posterior.memory_names, model.posterior.memory.T, strict=True):
        (effect,) = (each for each in found.effects if each.constant == name)
        assert column.min() <= effect.low < effect.high <= column.max()
    chosen = np.linspace(0, len(model.posterior) - 1, 64).round().astype(int)
    own = model.posterior.memory[chosen, 0]
    assert found.effects and any(
        np.allclose([each.low, each.high], np.percentile(own, [2.5, 97.5])) for each in found.effects
    )


@pytest.mark.slow
def test_the_laboratory_in_the_middle_predicts_the_mean(icons: IconSet, rig: Rig) -> None:
    found = pilot(icons, rig, 2, 12, 60, 4)
    some, played = found.conditioned.after, found.confusions_after
    number = middle_of(some, found.prior.values(some), played.correct[:, None], found.played)
    assert number == middle_of(some, found.prior.values(some), played.correct[:, None], found.played)
    assert abs(played.correct[number] - played.correct.mean()) < 1.2 * played.correct.std()
    assert off_middle(np.array([[1.0, -1.0], [2.0, 0.0], [900.0, 1.0]])).argmin() == 1
