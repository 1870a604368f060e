"""The whole of `observed` on a made-up laboratory: answers, predictions, files that other commands read."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.perception.pilot.madeup import synthetic_trials
from thermicon.circuit import Rig
from thermicon.circuit.records import RecordError
from thermicon.icons import IconSet
from thermicon.perception.observer.draws import BETWEEN_LABORATORIES, PosteriorDraws
from thermicon.perception.observer.observer import Observer
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.pilot.conditioning import Answered
from thermicon.perception.pilot.observed import Observed, observed
from thermicon.perception.pilot.prediction import Fit
from thermicon.perception.pilot.states import LaboratoryPrior
from thermicon.perception.pilot.trials import Trials


@pytest.fixture(scope="module")
def answers(icons: IconSet, rig: Rig) -> Trials:
    return synthetic_trials(icons, rig, participants=3, trials=18, seed=16)


@pytest.fixture(scope="module")
def found(icons: IconSet, rig: Rig, answers: Trials) -> Observed[Answered, Fit]:
    return observed(answers, icons, rig, others=[icons], draws=40, seed=1)


def test_first_laboratories_are_the_draws_and_coordinates_lead_back() -> None:
    draws = PosteriorDraws.load()
    prior = LaboratoryPrior(draws, "episodes")
    some = prior.first(len(draws), 3)
    assert np.allclose(prior.constants(some), draws.draws, rtol=1e-9)
    assert np.abs(np.cov(some.place.T) - np.eye(len(prior.names))).max() < 0.2
    values = prior.values(some)
    share = values[:, prior.names.index("share of the scatter of ratings")]
    assert 0.0 <= share.min() < 0.01 and 0.99 < share.max() <= 1.0
    spread = values[:, prior.names.index(BETWEEN_LABORATORIES)]
    offset = values[:, prior.names.index("sensitivity of the laboratory, cold")] / spread
    assert abs(offset.std() - 1.0) < 0.1


@pytest.mark.slow
def test_the_result_holds_what_was_asked(found: Observed[Answered, Fit], answers: Trials) -> None:
    own = found.to_dict()
    assert json.loads(found.to_json()) == json.loads(json.dumps(own))
    assert own["trials"] == answers.total == 54
    assert own["counts"] == answers.pooled.astype(int).tolist()
    assert [each["who"] for each in own["each"]] == ["P1", "P2", "P3"]
    assert 1.0 <= own["effective_sample_size"] <= 40.0
    same = own["predictions"][0]["before"], own["predictions"][1]["before"]
    assert same[0]["proportion_correct"] == same[1]["proportion_correct"]
    assert own["predictions"][0]["after"]["people"] == 24
    for each in (found.fit, found.fit_after):
        assert 0.0 < each.p <= 1.0
        assert len(each.pairs) == 15


def test_files_are_read_by_observer_and_draws(found: Observed[Answered, Fit], tmp_path: Path) -> None:
    observer, table = found.files()
    (tmp_path / "lab.toml").write_text(observer, encoding="utf-8")
    (tmp_path / "lab.csv").write_text(table, encoding="utf-8")
    draws = PosteriorDraws.load(tmp_path / "lab.csv")
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
    person = Observer.load(tmp_path / "lab.toml")
    assert PosteriorDraws.load(tmp_path / "lab.csv").nominal() == draws.nominal() == person
    model = ObserverModel.load(tmp_path / "lab.csv")
    whole = ObserverModel.load(tmp_path / "lab.toml")
    assert model.nominal == whole.nominal == person
    for field in ("threshold_cold", "threshold_warm", "criterion_cold", "decision_s", "memory"):
        assert np.array_equal(getattr(model.people(9, 4), field), getattr(whole.people(9, 4), field)), field


@pytest.mark.slow
def test_memory_stands_beside_the_constants_of_each_draw(found: Observed[Answered, Fit], tmp_path: Path) -> None:
    (tmp_path / "lab.csv").write_text(found.files()[1], encoding="utf-8")
    draws = PosteriorDraws.load(tmp_path / "lab.csv")
    assert draws.memory_names == ("share of the scatter of ratings", "bar of an episode", "memory noise (episodes)")
    assert np.array_equal(draws.draws, found.draws().draws) and np.array_equal(draws.memory, found.draws().memory)
    values = found.prior.values(found.conditioned.after)
    for k, name in enumerate(draws.memory_names):
        column = values[:, found.prior.names.index(name)]
        assert np.allclose(np.sort(draws.memory[:, k]), np.sort(column), rtol=1e-5)
    person = draws.observer(3)
    assert (person.memory.share, person.memory.bar, person.memory.timing) == tuple(draws.memory[3])
    assert draws.table(3).one("memory noise", method="episodes").central == draws.memory[3, 2]
    assert draws.table(3).one("bar of an episode").central == draws.memory[3, 1]


@pytest.mark.parametrize(
    ("memory", "said"),
    [
        (("1.5", "1", "0.3"), r"share of the scatter of ratings: 1\.5 must lie in 0 to 1"),
        (("0.5", "1", "-0.3"), r"memory noise \(episodes\): -0\.3 must be above 0"),
        (("0.5", "0", "0.3"), r"bar of an episode: 0 must be above 0"),
    ],
)
def test_memory_that_cannot_be_is_refused(
    found: Observed[Answered, Fit], tmp_path: Path, memory: tuple[str, ...], said: str
) -> None:
    path = tmp_path / "lab.csv"
    lines = [line for line in found.files()[1].splitlines() if not line.startswith("# sha256")]
    first = next(k for k, line in enumerate(lines) if not line.startswith("#")) + 1
    lines[first] = ",".join([*lines[first].split(",")[:-3], *memory])
    path.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(RecordError, match=said):
        PosteriorDraws.load(path)


def test_the_prior_of_a_kept_laboratory_has_its_memory(found: Observed[Answered, Fit], tmp_path: Path) -> None:
    (tmp_path / "lab.csv").write_text(found.files()[1], encoding="utf-8")
    draws = PosteriorDraws.load(tmp_path / "lab.csv")
    prior = LaboratoryPrior(draws, "episodes")
    values = prior.values(prior.first(len(draws), 3))
    assert prior.names.count("memory noise (episodes)") == 1
    for k, name in enumerate(draws.memory_names):
        assert np.allclose(values[:, prior.names.index(name)], draws.memory[:, k], rtol=1e-4, atol=1e-5)
    naming = LaboratoryPrior(draws, "naming")  # its own memory is not all that naming needs
    others = naming.values(naming.first(len(draws), 3))
    assert np.ptp(others[:, naming.names.index("cost of a missing episode")]) > 4.0
    column = others[:, naming.names.index("memory noise (episodes)")]
    assert np.allclose(column, draws.memory[:, draws.memory_names.index("memory noise (episodes)")], rtol=1e-4)


def test_a_kept_laboratory_is_the_prior_of_the_next_prediction(found: Observed[Answered, Fit], tmp_path: Path) -> None:
    observer, table = found.files()
    (tmp_path / "lab.csv").write_text(table, encoding="utf-8")
    (tmp_path / "lab.toml").write_text(observer, encoding="utf-8")
    prior = LaboratoryPrior.of(tmp_path / "lab.csv", "episodes")
    values = prior.values(prior.first(20, 0))
    assert np.abs(values[:, prior.names.index("sensitivity of the laboratory, cold")]).max() < 1e-4
    with pytest.raises(ValueError, match=r"lab.toml has no posterior draws, .*give a table of draws \(.csv\)"):
        LaboratoryPrior.of(tmp_path / "lab.toml", "episodes")


def test_thresholds_carry_the_offset_of_the_laboratory(found: Observed[Answered, Fit]) -> None:
    values, draws = found.prior.values(found.conditioned.after), found.draws()
    names = found.prior.names
    drive = values[:, names.index("warm threshold drive")]
    offset = values[:, names.index("sensitivity of the laboratory, warm")]
    assert np.allclose(sorted(draws.values("warm threshold drive")), sorted(drive * np.exp(-offset)))


def test_answers_to_another_set_and_too_few_draws_are_refused(icons: IconSet, rig: Rig, answers: Trials) -> None:
    other = Trials(("a", "b"), ("P1",), np.ones((1, 2, 2)))
    with pytest.raises(ValueError, match="the answers are to other icons than those of the set"):
        observed(other, icons, rig)
    with pytest.raises(ValueError, match="at least 20 draws, not 5"):
        observed(answers, icons, rig, draws=5)
