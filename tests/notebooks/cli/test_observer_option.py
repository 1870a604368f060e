"""``--observer FILE``: another posterior or other records in place of the shipped observer."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

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
    said = cli("rank", two, "--people", 4, "--parameters", 8, "--observer", own, "--json", out)
    assert said.exit_code == 0, said.stderr
    assert "predicted with the observer of lab.csv" in said.stdout
    held = json.loads(out.read_text(encoding="utf-8"))
    assert held["observer"] == "lab.csv"
    assert held["set"]["proportion_correct_interval_new_laboratory"] is not None
    assert len(held["persons"]["proportion_correct"]) == 4


def test_records_have_no_interval_and_say_so(cli: Cli, two: Path, records: Path) -> None:
    said = cli("rank", two, "--people", 4, "--observer", records)
    assert said.exit_code == 0, said.stderr
    assert "lab.toml has no posterior draws" in said.stderr
    assert "no interval for a new laboratory" in " ".join(said.stdout.split())
    assert "in a new laboratory" not in said.stdout
    said = cli("sensitivity", two, "--observer", records)
    assert (said.exit_code, said.stdout) == (1, "")
    assert "lab.toml: a sensitivity is read from draws of a posterior" in " ".join(said.stderr.split())


@pytest.mark.parametrize("command", ["rank", "search", "sensitivity"])
def test_a_file_that_is_no_observer_is_bad_input(cli: Cli, two: Path, tmp_path: Path, command: str) -> None:
    for name, text, words in (
        ("none.csv", None, "cannot be read"),
        ("other.csv", "time_s,current_A\n0,1\n", "this is not a table of posterior draws"),
        ("other.toml", "[[record]]\n", "other.toml"),
    ):
        path = tmp_path / name
        if text is not None:
            path.write_text(text, encoding="utf-8")
        said = cli(command, two, "--observer", path)
        assert (said.exit_code, said.stdout) == (1, ""), command
        assert words in said.stderr


def test_more_draws_than_there_are(cli: Cli, two: Path) -> None:
    said = cli("rank", two, "--parameters", 2000)
    assert said.exit_code == 1
    assert "--parameters 2000: the shipped posterior has 1000 draws" in said.stderr
