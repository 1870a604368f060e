"""``thermicon sensitivity``: what to measure first, as a table for people and a file for scripts."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

Cli = Callable[..., Any]
QUICK = ("--people", 3, "--draws", 64)


def test_the_table_says_what_to_measure_first(cli: Cli, two: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "out.csv", tmp_path / "out.png"
    said = cli("sensitivity", two, *QUICK, "-o", out, "--figure", picture)
    assert said.exit_code == 0, said.stderr
    assert said.stderr == f"wrote {out}\nwrote {picture}\n"
    assert max(len(line) for line in said.stdout.splitlines()) <= 80
    frame = pd.read_csv(out)
    words = " ".join(said.stdout.split())
    assert words.startswith("Two for a test constant 95 % of draws correct bits correct low–high ")
    assert "Measure first, by the share of the variance of the proportion correct that would go: - " in words
    assert frame["constant"][0].split()[0] in words
    assert "64 draws for 3 virtual people on the thenar rig (seed 0, episodes norm): " in words
    assert {"memory noise (episodes)", "contact resistance"} <= set(frame["constant"])
    assert picture.stat().st_size > 10_000
    assert not list(tmp_path.glob(".*"))


def test_the_same_question_gets_the_same_bytes(cli: Cli, two: Path) -> None:
    said = [cli("sensitivity", two, *QUICK, "--seed", 4, "-o", "-").stdout for _ in range(2)]
    assert said[0] == said[1]
    assert list(pd.read_csv(io.StringIO(said[0])).columns[:5]) == [
        "constant",
        "unit",
        "low",
        "high",
        "proportion_correct_share",
    ]


def test_a_what_if(cli: Cli, two: Path) -> None:
    printed = cli("sensitivity", two, *QUICK, "--set", "contact.area_cm2=4")
    words = " ".join(printed.stdout.split())
    assert "on the thenar rig with contact.area_cm2=4 (seed 0, episodes norm)" in words


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--people", 0), "'--people': 0 is outside 1 to 10000"),
        (("--draws", 2), "'--draws': 2 is outside 64 to 100000"),
        (("--seed", -1), "'--seed': -1 is outside 0 to 4294967295"),
        (("--norm", "mean"), "'--norm': 'mean' is not one of episodes, naming"),
    ],
)
def test_bad_options_are_usage_errors(cli: Cli, two: Path, options: tuple[object, ...], told: str) -> None:
    said = cli("sensitivity", two, *options)
    assert (said.exit_code, said.stdout) == (2, "")
    assert told in " ".join(said.stderr.replace("│", " ").split())


def test_one_icon_is_bad_input(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "one.cue"
    path.write_text("cue 1\nicon only { warm by 2 °C at 1 °C/s }\n", encoding="utf-8")
    said = cli("sensitivity", path)
    assert said.exit_code == 1
    assert said.stderr == f"{path}: a sensitivity study needs at least two icons, since one alone is never confused\n"


def test_a_wrong_ending_is_told_before_work_begins(cli: Cli, two: Path, tmp_path: Path) -> None:
    said = cli("sensitivity", two, "-o", tmp_path / "out.txt")
    assert said.exit_code == 1
    assert "a table of sensitivities is written as .csv or .parquet, not .txt" in said.stderr


def test_nothing_that_moves() -> None:
    from thermicon.notebooks.cli.sensitivity import sentences
    from thermicon.perception.ranking.sensitivity import Sensitivity

    still = Sensitivity("thenar", (), 1, 0, "naming", 64, "shipped", 1.0, 1.0, (1.0, 1.0), (), ())
    assert sentences(still)[0] == "No measurement would narrow the prediction noticeably."
    assert "1 virtual person on the thenar rig" in sentences(still)[-1]


def test_more_draws_than_the_posterior_has_is_bad_input(cli: Cli, two: Path) -> None:
    said = cli("sensitivity", two, "--draws", 5000)
    assert said.exit_code == 1
    assert "--draws 5000: the shipped posterior has 1000 draws" in said.stderr
