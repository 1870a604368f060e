"""A threshold run at judged levels."""

import importlib
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .conftest import CHANGES, make, rows_of, run_script

THRESHOLD = f"""format = 1
name = "cold"
[stimuli]
{CHANGES}
[participants]
labels = ["A"]
[threshold]
direction = "cool"
least_K = 0.1
most_K = 2
levels = 6
hold_s = 1
trials = 40
[timing]
gap_s = 8
landing_s = 20
"""


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make(tmp_path_factory.mktemp("threshold"), THRESHOLD)


def run(out: Path, folder: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    return run_script(out, folder, "--participant", "A", "--simulate", *arguments)


@pytest.mark.slow
def test_every_level_is_a_judged_drive(out: Path) -> None:
    levels = rows_of(out / "levels.csv")
    changes = [float(row["change_K"]) for row in levels]
    assert (changes[0], changes[-1], len(changes)) == (0.1, 2.0, 6)
    assert np.allclose(np.diff(np.log(changes)), math.log(20.0) / 5.0, atol=0.02)
    for row in levels:
        sidecar = json.loads((out / row["sidecar_file"]).read_text(encoding="utf-8"))
        assert sidecar["safety"]["colour"] == "green"
        assert (out / row["drive_file"]).is_file()
    facts = json.loads((out / "study.json").read_text(encoding="utf-8"))
    assert facts["sessions"]["any"]["verdict"] == "green", "every trial at the greatest change"
    assert facts["planned_s"] == pytest.approx(20.0 + 40 * float(levels[-1]["duration_s"]) + 39 * 8.0, abs=0.1)


@pytest.mark.slow
def test_a_stopped_run_goes_on_with_what_it_knows(out: Path, tmp_path: Path) -> None:
    run(out, tmp_path, "--press", "200:q")
    before = rows_of(tmp_path / "sub-A_task-cold_answers.csv")
    assert 0 < len(before) < 40
    assert not (tmp_path / "sub-A_task-cold_threshold.json").exists()
    done = run(out, tmp_path, "--resume")
    assert "40 answers" in done.stdout
    after = rows_of(tmp_path / "sub-A_task-cold_answers.csv")
    assert after[: len(before)] == before
    assert [int(row["trial"]) for row in after] == list(range(1, 41))


def quest_of(out: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(out))
    monkeypatch.delitem(sys.modules, "study_questplus", raising=False)
    return importlib.import_module("study_questplus")


@pytest.mark.slow
def test_without_answers_the_interval_is_that_of_the_prior(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = quest_of(out, monkeypatch)
    qp = module.quest([0.1, 0.4, 1.6])
    middle, (low, high) = module.estimate(qp, 1.0 - math.exp(-1.0))  # there the threshold is the parameter itself
    assert (low, high) == (pytest.approx(0.05, rel=0.15), pytest.approx(3.2, rel=0.15))
    assert middle == pytest.approx(0.4, rel=0.1)


def test_answers_to_nothing_teach_the_rate_of_false_alarms_alone(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = quest_of(out, monkeypatch)
    qp = module.quest([0.1, 0.4, 1.6])
    before = module.estimate(qp, 0.5)
    for _ in range(5):
        module.learn(qp, [], "nothing", "felt")
    assert module.estimate(qp, 0.5) == before
    alarms = qp.posterior.sum(dim=("threshold", "slope", "lapse_rate"))
    assert float(alarms.sum()) == pytest.approx(1.0)
    expected = np.array(module.FALSE_ALARMS) ** 5
    assert np.allclose(alarms, expected / expected.sum())


@pytest.mark.slow
def test_intervals_cover_the_threshold_as_often_as_they_say(out: Path, tmp_path: Path) -> None:
    names, covered = {row["icon"] for row in rows_of(out / "levels.csv")} | {"nothing"}, []
    for seed in range(12):
        threshold_K, folder = 0.2 * 5.0 ** (seed / 11.0), tmp_path / str(seed)
        done = run(out, folder, "--threshold", threshold_K, "--seed", seed)
        assert (done.returncode, done.stderr) == (0, "")
        found = json.loads((folder / "sub-A_task-cold_threshold.json").read_text(encoding="utf-8"))
        given, (low, high) = rows_of(folder / "sub-A_task-cold_answers.csv"), found["interval_95_K"]
        covered.append(low <= threshold_K <= high)
        assert low < found["threshold_K"] < high < 8.0 * low, "forty trials narrow it down"
        assert {row["presented"] for row in given} <= names, "nothing but judged drives"
        assert found["trials"] == len(given) == 40
        assert 2 <= found["catch_trials"] <= 16
    assert sum(covered) >= 10  # of 12 at 95 %: fewer have a probability of 2 %
