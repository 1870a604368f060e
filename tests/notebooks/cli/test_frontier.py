"""``thermicon frontier``: a row for each number of icons, a table and a figure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

Cli = Callable[..., Any]


def test_a_row_for_each_number_of_icons(cli: Cli, tmp_path: Path) -> None:
    out, picture = tmp_path / "out.csv", tmp_path / "out.png"
    said = cli("frontier", "six-icons", "--people", 4, "--most", 4, "--parameters", 4, "-o", out, "--figure", picture)
    assert said.exit_code == 0, said.stderr
    frame = pd.read_csv(out)
    assert list(frame["icons"]) == [2, 3, 4]
    words = " ".join(said.stdout.split())
    assert "icons correct 95 % of people d′ bits time energy" in words
    assert "The 4: " + ", ".join(frame["names"][2].split()) in words
    assert picture.stat().st_size > 10_000


def test_a_goal_is_judged_at_every_number(cli: Cli) -> None:
    asked = ("--people", 4, "--parameters", 4, "--most", 3, "--goal", "correct >= 1 % for 95 % of people, time <= 17 s")
    words = " ".join(cli("frontier", "six-icons", *asked).stdout.split())
    assert "time energy goal" in words
    assert "Goal: met by the best 2, the largest choice here ✓ correct >= 1 % for 95 % of people: " in words
    assert "✓ time <= 17 s: " in words
    assert "is about people and the uncertainty of the model together (4 draws), as in a goal" in words
    plain = " ".join(cli("frontier", "six-icons", *asked[:2], "--parameters", 0, "--most", 2).stdout.split())
    assert "about people alone, at the nominal constants: milder than in a goal" in plain
    none = " ".join(cli("frontier", "six-icons", *asked[:6], "--goal", "correct >= 99.9 %").stdout.split())
    assert "Goal: met by none of these choices; the best 2: ✗ correct >= 99.9 %: " in none
    assert "missed by" in none
    assert "In the way: " in none


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (("--most", 1), 2, "1 is outside 2 to 64"),
        (("--parameters", 1), 2, "1 draw has no interval"),
        (("--goal", "corect >= 9 %"), 1, "there is no quantity 'corect'"),
        (("--objective", "all"), 2, "'all' is not one of"),
        (("--most-time", 0), 2, "0 s is not above 0"),
        (("-o", "out.txt"), 1, "a table is written as .csv or .parquet, not .txt"),
    ],
)
def test_bad_options(cli: Cli, options: tuple[object, ...], code: int, told: str) -> None:
    said = cli("frontier", "six-icons", *options)
    assert said.exit_code == code
    assert told in " ".join(said.stderr.replace("│", " ").split())
