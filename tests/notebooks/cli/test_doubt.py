"""``thermicon rank --doubt``: what to measure first, as a table for people and a file for scripts."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

Cli = Callable[..., Any]
QUICK = ("--doubt", "--people", 3, "--intervals", 64)


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


def test_the_same_question_gets_the_same_bytes(cli: Cli, two: Path) -> None:
    said = [cli("rank", two, *QUICK, "--seed", 4, "--json", "-").stdout for _ in range(2)]
    assert said[0] == said[1]
    effect = json.loads(said[0])["effects"][0]
    assert {"constant", "unit", "low", "high", "proportion_correct", "information_bits"} <= set(effect)


def test_a_what_if(cli: Cli, two: Path) -> None:
    printed = cli("rank", two, *QUICK, "--set", "contact.area_cm2=4")
    words = " ".join(printed.stdout.split())
    assert "on the thenar rig with contact.area_cm2=4 (seed 0, episodes norm)" in words
