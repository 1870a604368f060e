"""``--observer FILE``: another posterior or other records in place of the shipped observer."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.builders import few_draws
from thermicon.perception.observer.observer import DATA

Cli = Callable[..., Any]


@pytest.fixture
def records(tmp_path: Path) -> Path:
    own = tmp_path / "lab.toml"
    own.write_bytes((DATA / "observer.toml").read_bytes())
    return own


def test_a_ranking_names_its_observer(cli: Cli, two: Path, tmp_path: Path) -> None:
    own, out = tmp_path / "lab.csv", tmp_path / "out.json"
    own.write_bytes((DATA / "posterior.csv").read_bytes())
    said = cli("rank", two, "--people", 4, "--intervals", 8, "--observer", own, "--json", out)
    assert said.exit_code == 0, said.stderr
    assert ", observer lab.csv." in said.stdout
    held = json.loads(out.read_text(encoding="utf-8"))
    assert held["observer"] == "lab.csv"
    assert held["set"]["proportion_correct_interval_new_laboratory"] is not None
    assert len(held["persons"]["proportion_correct"]) == 4


def test_records_have_no_interval_and_say_so(cli: Cli, two: Path, records: Path) -> None:
    said = cli("rank", two, "--people", 4, "--observer", records, "--details")
    assert said.exit_code == 0, said.stderr
    assert "lab.toml has no posterior draws" in said.stderr
    assert "no interval for a new laboratory" in " ".join(said.stdout.split())
    assert "in a new laboratory" not in said.stdout


@pytest.mark.parametrize("command", [("pilot", "--answers", "t.csv"), ("pilot",), ("rank", "--doubt")])
def test_what_needs_draws_refuses_records_and_names_the_draws_beside_them(
    cli: Cli, two: Path, records: Path, tmp_path: Path, command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    trials = tmp_path / "t.csv"
    trials.write_text("participant,trial,presented,responded\nP,1,cool-step,cool-step\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for beside in ("the table of draws (.csv) that pilot --keep writes", "lab.csv, which stands beside it"):
        said = cli(*command, two, "--observer", records)
        assert (said.exit_code, said.stdout) == (1, "")
        assert beside in " ".join(said.stderr.split())
        (tmp_path / "lab.csv").write_bytes((DATA / "posterior.csv").read_bytes())


def test_as_many_draws_are_used_as_there_are(cli: Cli, two: Path, tmp_path: Path) -> None:
    lab = few_draws(tmp_path / "lab.csv", 6, "by weights from 12 laboratories", "thenar")
    said = cli("rank", two, "--people", 4, "--observer", lab)
    assert said.exit_code == 0, said.stderr
    assert "note: lab.csv has 6 draws: all of them are used (--intervals is 128 by default)" in said.stderr
    assert "conditioned on" not in said.stderr
    assert "in your laboratory, lab.csv (95 %): " in " ".join(said.stdout.split())
    assert "a new laboratory" not in said.stdout
    for more, words in (
        (("--people", 4, "--intervals", 7), "--intervals 7: the lab.csv posterior has 6 draws"),
        (("--doubt",), "lab.csv has 6 draws, and 64 are needed: keep more with pilot --draws 128"),
    ):
        said = cli("rank", two, "--observer", lab, *more)
        assert (said.exit_code, said.stdout) == (1, "")
        assert words in said.stderr


def test_another_rig_than_that_of_the_answers_is_warned_of(cli: Cli, two: Path, tmp_path: Path) -> None:
    lab = few_draws(tmp_path / "lab.csv", 3, "by weights from 12 laboratories", "hand-dorsum")
    said = cli("rank", two, "--people", 2, "--observer", lab)
    assert said.exit_code == 0
    assert "warning: lab.csv was conditioned on the hand-dorsum rig, not on thenar" in said.stderr
    assert said.stderr.count("warning") == 1
