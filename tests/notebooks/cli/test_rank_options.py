"""Options of ``thermicon rank``: another observer, workers and kept parts, and what carries the doubt."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.builders import few_draws
from thermicon.perception.observer.observer import DATA

Cli = Callable[..., Any]
QUICK = ("--doubt", "--people", 3, "--intervals", 64)


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


def test_workers_change_no_byte(cli: Cli, two: Path, tmp_path: Path) -> None:
    outs = []
    for extra in ((), ("--workers", 1), ("--workers", 3)):
        outs.append(tmp_path / f"{len(outs)}.json")
        said = cli("rank", two, "--people", 5, "--intervals", 0, "--json", outs[-1], *extra)
        assert said.exit_code == 0, said.stderr
    assert len({out.read_bytes() for out in outs}) == 1


def test_a_cluster_that_is_not_there_is_bad_input(cli: Cli, two: Path) -> None:
    pytest.importorskip("distributed")
    said = cli("rank", two, "--people", 2, "--workers", "nowhere")
    assert said.exit_code == 1
    assert "'nowhere' is not the address of a scheduler" in said.stderr
    assert "Traceback" not in said.stderr


def test_the_table_says_what_to_measure_first(cli: Cli, two: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "out.json", tmp_path / "out.png"
    said = cli("rank", two, *QUICK, "--json", out, "--figure", picture)
    assert said.exit_code == 0, said.stderr
    assert said.stderr == f"wrote {out}\nwrote {picture}\n"
    assert max(len(line) for line in said.stdout.splitlines()) <= 80
    names = [each["constant"] for each in json.loads(out.read_text(encoding="utf-8"))["effects"]]
    words = " ".join(said.stdout.split())
    assert words.startswith("Two for a test constant 95 % of draws correct bits correct low–high ")
    assert "Measure first, by the share of the variance of the proportion correct that would go: - " in words
    assert names[0].split()[0] in words
    assert "64 draws for 3 virtual people on the thenar rig (seed 0, episodes norm): " in words
    assert {"memory noise (episodes)", "contact resistance"} <= set(names)
    assert picture.stat().st_size > 10_000
    assert not list(tmp_path.glob(".*"))


def test_the_doubt_of_a_what_if_is_the_same_again(cli: Cli, two: Path) -> None:
    asked = ("rank", two, *QUICK, "--seed", 4, "--set", "contact.area_cm2=4")
    said = [cli(*asked, "--json", "-").stdout for _ in range(2)]
    assert said[0] == said[1]
    effect = json.loads(said[0])["effects"][0]
    assert {"constant", "unit", "low", "high", "proportion_correct", "information_bits"} <= set(effect)
    words = " ".join(cli(*asked).stdout.split())
    assert "on the thenar rig with contact.area_cm2=4 (seed 4, episodes norm)" in words
