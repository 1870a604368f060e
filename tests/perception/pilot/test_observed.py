"""The whole of `observed` on a made-up laboratory."""

from pathlib import Path

import numpy as np
import pytest

from tests.perception.pilot.madeup import synthetic_trials
from thermicon.base.files.records import RecordError
from thermicon.circuit import Rig
from thermicon.icons import IconSet
from thermicon.perception import rank
from thermicon.perception.identification.new_laboratory import DRAWS
from thermicon.perception.observer.channels import FORM
from thermicon.perception.observer.constants import BETWEEN_LABORATORIES
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.observer import Observer
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.pilot.conditioning import Namings
from thermicon.perception.pilot.laboratory_file import middle_of
from thermicon.perception.pilot.observed import Observed, observed
from thermicon.perception.pilot.prediction import Fit
from thermicon.perception.pilot.states import LaboratoryPrior
from thermicon.perception.pilot.trials import Trials
from thermicon.perception.ranking.sensitivity import sensitivity

MEMORY = {
    "rated_share": "share of the scatter of ratings",
    "episode_bar": "bar of an episode",
    "timing_noise": "memory noise (episodes)",
    "pair_spread": "spread of pairs between laboratories",
}


@pytest.fixture(scope="module")
def answers(icons: IconSet, rig: Rig) -> Trials:
    return synthetic_trials(icons, rig, participants=3, trials=18, seed=16)


@pytest.fixture(scope="module")
def found(icons: IconSet, rig: Rig, answers: Trials) -> Observed[Namings, Fit]:
    return observed(answers, icons, rig, others=[icons], draws=40, seed=1)


@pytest.fixture(scope="module")
def lab(found: Observed[Namings, Fit], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Records of what was kept, with the table of draws beside them."""
    path = tmp_path_factory.mktemp("kept") / "lab.toml"
    for name, text in zip((path, path.with_suffix(".csv")), found.files(), strict=True):
        name.write_text(text, encoding="utf-8")
    return path


def test_first_laboratories_are_the_draws_and_coordinates_lead_back() -> None:
    draws = PosteriorDraws.load()
    prior = LaboratoryPrior(draws, "episodes")
    some = prior.first(len(draws), 3)
    values = prior.values(some)
    assert np.allclose(values[:, : len(draws.names)], draws.draws, rtol=1e-9)
    assert np.abs(np.cov(some.place.T) - np.eye(len(prior.names))).max() < 0.2
    share = values[:, prior.names.index("share of the scatter of ratings")]
    assert 0.0 <= share.min() < 0.01 and 0.99 < share.max() <= 1.0
    spread = values[:, prior.names.index(BETWEEN_LABORATORIES)]
    offset = values[:, prior.names.index("sensitivity of the laboratory, cold")] / spread
    assert abs(offset.std() - 1.0) < 0.1


def test_the_result_holds_what_was_asked(found: Observed[Namings, Fit], answers: Trials) -> None:
    own = found.to_dict()
    assert own["trials"] == answers.total == 54
    assert own["counts"] == answers.pooled.astype(int).tolist()
    assert [each["who"] for each in own["each"]] == ["P1", "P2", "P3"]
    assert 1.0 <= own["effective_sample_size"] <= 40.0
    same, other = (each["before"]["proportion_correct"] for each in own["predictions"])
    assert same == other
    for each in (found.confusions_after, found.conditioned.simulated):
        assert (each.felt_and_named < each.correct).all(), "what is felt and named is named"
    assert own["predictions"][0]["after"]["people"] == 24
    widths = [np.ptp(own["predictions"][0][when]["proportion_correct"][1:]) for when in ("before", "after")]
    assert widths[0] == pytest.approx(own["predictions"][0]["narrower"] * widths[1])
    for each in (found.fit, found.fit_after):
        assert 0.0 < each.p <= 1.0
        assert len(each.pairs) == 15


def test_files_are_read_by_observer_and_draws(found: Observed[Namings, Fit], lab: Path) -> None:
    table, draws = found.files()[1], PosteriorDraws.load(lab.with_suffix(".csv"))
    assert len(draws) == 20
    assert draws.values(BETWEEN_LABORATORIES).max() < 1e-5  # these draws are of this laboratory
    assert "participants: 3; trials: 54" in draws.header.sampler
    assert draws.header.ess <= found.conditioned.effective + 0.01
    assert table.startswith("# written by thermicon observed from inputs ")
    rows = len(np.unique(np.hstack([draws.draws, draws.memory]), axis=0))
    assert 1 < rows < 20
    assert f"# resampled: by weights from 40 laboratories, effective sample size {draws.header.ess:.0f}, " in table
    assert f", {rows} distinct rows of 20\n" in table
    assert draws.header.status.startswith("resampled by weights from 40 laboratories")
    assert draws.header.rig == "thenar" and draws.one_laboratory and not PosteriorDraws.load().one_laboratory
    assert "# effective draws: " in table and "# participants: 3\n" in table
    model, whole = ObserverModel.load(lab.with_suffix(".csv")), ObserverModel.load(lab)
    assert model.nominal == whole.nominal == draws.observer(0) == Observer.load(lab)
    for field in ("threshold_cold", "threshold_warm", "criterion_cold", "decision_s", "memory"):
        assert np.array_equal(getattr(model.people(9, 4), field), getattr(whole.people(9, 4), field)), field


def test_memory_stands_beside_the_constants_of_each_draw(found: Observed[Namings, Fit], lab: Path) -> None:
    draws = PosteriorDraws.load(lab.with_suffix(".csv"))
    assert np.array_equal(draws.draws, found.draws().draws) and np.array_equal(draws.memory, found.draws().memory)
    after = found.conditioned.after
    values = found.prior.values(after)
    for k, name in enumerate(draws.memory_names):
        column = after.form if name == FORM else values[:, found.prior.names.index(name)]
        assert np.allclose(np.sort(draws.memory[:, k]), np.sort(column), rtol=1e-5)
    person, own = draws.observer(3), draws.draw(3)
    for field, name in MEMORY.items():
        assert getattr(person, field) == own[name]
    assert draws.table(3).one("memory noise", method="episodes").central == own["memory noise (episodes)"]
    assert draws.table(3).one("bar of an episode").central == own["bar of an episode"]


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("share of the scatter of ratings", "1.5", r"share of the scatter of ratings: 1\.5 must lie in 0 to 1"),
        ("memory noise (episodes)", "-0.3", r"memory noise \(episodes\): -0\.3 must be above 0"),
        ("bar of an episode", "0", r"bar of an episode: 0 must be above 0"),
        ("spread of pairs between laboratories", "-1", r"spread of pairs between laboratories: -1 must be 0 or more"),
        (FORM, "2", r"form of memory: 2 is none of 0 \(episodes\) and 1 \(naming\)"),
        (FORM, "0.5", r"form of memory: 0\.5 is none of 0 \(episodes\) and 1 \(naming\)"),
    ],
)
def test_memory_that_cannot_be_is_refused(
    found: Observed[Namings, Fit], tmp_path: Path, name: str, value: str, said: str
) -> None:
    path = tmp_path / "lab.csv"
    lines = [line for line in found.files()[1].splitlines() if not line.startswith("# sha256")]
    head = next(k for k, line in enumerate(lines) if not line.startswith("#"))
    row = lines[head + 1].split(",")
    row[lines[head].split(",").index(name)] = value
    lines[head + 1] = ",".join(row)
    path.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(RecordError, match=said):
        PosteriorDraws.load(path)


def test_a_kept_laboratory_is_the_prior_of_the_next_prediction_and_has_its_memory(lab: Path) -> None:
    draws = PosteriorDraws.load(lab.with_suffix(".csv"))
    prior = LaboratoryPrior.of(lab.with_suffix(".csv"), "both")
    first = prior.first(len(draws), 3)
    values = prior.values(first)
    assert np.abs(values[:, prior.names.index("sensitivity of the laboratory, cold")]).max() < 1e-4
    assert prior.names.count("memory noise (episodes)") == 1
    for k, name in enumerate(draws.memory_names):
        column = first.form if name == FORM else values[:, prior.names.index(name)]
        assert np.allclose(column, draws.memory[:, k], rtol=1e-4, atol=1e-5)
    with pytest.raises(ValueError, match=r"lab.toml has no posterior draws, .*give a table of draws \(.csv\)"):
        LaboratoryPrior.of(lab, "both")


def test_a_laboratory_that_was_kept_before_it_had_a_form_remembers_episodes(
    found: Observed[Namings, Fit], tmp_path: Path
) -> None:
    path = tmp_path / "older.csv"
    lines = [line for line in found.files()[1].splitlines() if not line.startswith("# sha256")]
    head = next(k for k, line in enumerate(lines) if not line.startswith("#"))
    assert lines[head].endswith(f",{FORM}")
    lines[head:] = [line.rsplit(",", 1)[0] for line in lines[head:]]
    path.write_text("\n".join(lines), encoding="utf-8")
    some = LaboratoryPrior.of(path, "both").first(20, 3)
    assert not some.form.any()
    assert LaboratoryPrior.of(path, "naming").first(20, 3).form.all(), "a form that is named is obeyed"
    assert set(rank("six-icons", observer=path, people=4, parameters=0).by_form) == {"episodes"}


def test_thresholds_carry_the_offset_of_the_laboratory(found: Observed[Namings, Fit]) -> None:
    values, draws = found.prior.values(found.conditioned.after), found.draws()
    names = found.prior.names
    drive = values[:, names.index("warm threshold drive")]
    offset = values[:, names.index("sensitivity of the laboratory, warm")]
    assert np.allclose(sorted(draws.values("warm threshold drive")), sorted(drive * np.exp(-offset)))


def test_answers_without_a_likelihood_stand_alone(
    icons: IconSet, rig: Rig, answers: Trials, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        Namings, "weighed", lambda _, simulated, rng: (np.full((len(simulated.probability), 1), np.nan), 0.0)
    )
    found = observed(answers, icons, rig, others=[icons], draws=20, seed=1)
    low, high = found.data.pooled.named_interval or (0.0, 0.0)
    assert f"{100 * low:.0f}–{100 * high:.0f} %" in found.unusable and found.unusable in repr(found)
    own = found.to_dict()
    assert (own["unusable"], own["fit_after"], own["constants"]) == (found.unusable, None, [])
    assert [(each["after"], each["narrower"]) for each in own["predictions"]] == [(None, None)] * 2
    assert own["fit_before"]["p"] > 0.0 and own["observed"]["named_interval"] == (low, high)
    assert "NaN" not in found.to_json()
    assert [row["data"] for row in found.rows()] == ["before", "before"]
    assert len(found.plot().containers) == 1
    with pytest.raises(ValueError, match=r"there are no draws of this laboratory\. The likelihood of the answers"):
        found.files()


def test_answers_to_another_set_and_too_few_draws_are_refused(icons: IconSet, rig: Rig, answers: Trials) -> None:
    other = Trials(("a", "b"), ("P1",), np.ones((1, 2, 2)))
    with pytest.raises(ValueError, match="the answers are to other icons than those of the set"):
        observed(other, icons, rig)
    with pytest.raises(ValueError, match="at least 20 draws, not 5"):
        observed(answers, icons, rig, draws=5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("participants", "trials", "draws", "seed"), [(4, 24, 120, 8), (12, 48, 300, 2), (12, 48, 300, 5), (3, 60, 300, 1)]
)
def test_rank_says_of_a_kept_laboratory_what_observed_said(
    icons: IconSet, rig: Rig, tmp_path: Path, participants: int, trials: int, draws: int, seed: int
) -> None:
    answers = synthetic_trials(icons, rig, participants=participants, trials=trials, seed=seed)
    found, path = observed(answers, icons, rig, draws=draws), tmp_path / "lab.csv"
    path.write_text(found.files()[1], encoding="utf-8")
    ranking = rank(icons, rig, observer=path, parameters=min(DRAWS, len(PosteriorDraws.load(path))))
    assert ranking.new_laboratory is not None
    for name, off in (("felt_and_named", 0.03 if participants == 4 else 0.04), ("proportion_correct", 0.04)):
        middle, low, high = getattr(found.predictions[0].after, name)
        least, most = getattr(ranking.new_laboratory, name)
        assert abs(getattr(ranking, name) - middle) < off, name
        assert min(high, most) - max(low, least) > 0.75 * min(high - low, most - least), name


@pytest.mark.slow
def test_draws_judge_with_their_own_memory(icons: IconSet, rig: Rig, tmp_path: Path) -> None:
    answers, path = synthetic_trials(icons, rig, participants=2, trials=12, seed=4), tmp_path / "lab.csv"
    path.write_text(observed(answers, icons, rig, draws=130).files()[1], encoding="utf-8")
    model = ObserverModel.load(path)
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


def test_the_laboratory_in_the_middle_predicts_the_mean(found: Observed[Namings, Fit]) -> None:
    some, played = found.conditioned.after, found.confusions_after
    number = middle_of(some, found.prior.values(some), played.correct[:, None], found.played)
    assert abs(played.correct[number] - played.correct.mean()) < 1.2 * played.correct.std()
