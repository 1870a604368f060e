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
    said = cli("frontier", "six-icons", "--people", 4, "--most", 4, "-o", out, "--figure", picture)
    assert said.exit_code == 0, said.stderr
    frame = pd.read_csv(out)
    assert list(frame["icons"]) == [2, 3, 4]
    words = " ".join(said.stdout.split())
    assert "icons correct 95 % of people d′ bits time energy" in words
    assert "The 4: " + ", ".join(frame["names"][2].split()) in words
    assert picture.stat().st_size > 10_000


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (("--most", 1), 2, "1 is outside 2 to 64"),
        (("--objective", "all"), 2, "'all' is not one of"),
        (("--most-time", 0), 2, "0 s is not above 0"),
        (("-o", "out.txt"), 1, "a table is written as .csv or .parquet, not .txt"),
    ],
)
def test_bad_options(cli: Cli, options: tuple[object, ...], code: int, told: str) -> None:
    said = cli("frontier", "six-icons", *options)
    assert said.exit_code == code
    assert told in " ".join(said.stderr.replace("│", " ").split())
