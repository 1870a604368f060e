"""``thermicon rank``: the JSON that scripts read and the table that people read."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]
TOP = {
    *("thermicon", "rig", "seed", "people", "tracking", "by", "norm", "content_hash"),
    *("icons", "pairs", "confusion", "set", "chosen"),
}
ICON = {
    *("name", "detected_probability", "onset_s", "channel", "peak_change_K", "attack_K_per_s", "delay_s"),
    *("percent_correct", "reachable", "safe", "reason", "rules"),
}
PAIR = {"a", "b", "d_prime", "confused_probability", "why", "rules", "edit"}
SET = {
    *("percent_correct", "percent_correct_interval", "information_bits", "information_bits_interval", "bits_per_s"),
    *("information_bits_plugin", "trials", "worst_pair", "rules_disagree", "norm_sensitivity"),
}


@pytest.fixture
def ranked(cli: Cli, two: Path, tmp_path: Path) -> dict[str, Any]:
    out = tmp_path / "rank.json"
    said = cli("rank", two, "--people", 20, "--seed", 3, "--json", out)
    assert said.exit_code == 0, said.stderr
    text = out.read_text(encoding="utf-8")
    assert "NaN" not in text
    assert "Infinity" not in text
    found: dict[str, Any] = json.loads(text)
    return found


def test_the_json_has_the_promised_keys(ranked: dict[str, Any]) -> None:
    assert set(ranked) >= TOP
    assert (ranked["rig"], ranked["seed"], ranked["people"], ranked["norm"]) == ("thenar", 3, 20, "max")
    assert ranked["tracking"] == "display"  # what control display asks for
    for icon in ranked["icons"]:
        assert set(icon) >= ICON
        assert set(icon["peak_change_K"]) == {"cold_receptor", "warm_receptor"}
    for pair in ranked["pairs"]:
        assert set(pair) >= PAIR
    assert set(ranked["set"]) >= SET


def test_rows_of_the_confusions_sum_to_one(ranked: dict[str, Any]) -> None:
    assert ranked["confusion"]["labels"] == ["cool-step", "warm-step"]
    for row in ranked["confusion"]["probability"]:
        assert sum(row) == pytest.approx(1.0, abs=1e-9)
        assert all(0 <= share <= 1 for share in row)


def test_the_same_question_gets_the_same_bytes(cli: Cli, two: Path, tmp_path: Path) -> None:
    texts = []
    for name in ("a.json", "b.json"):
        assert cli("rank", two, "--people", 10, "--json", tmp_path / name).exit_code == 0
        texts.append((tmp_path / name).read_bytes())
    assert texts[0] == texts[1]


def test_json_on_stdout_is_nothing_but_json(cli: Cli, two: Path) -> None:
    said = cli("rank", two, "--people", 5, "--json", "-")
    assert said.exit_code == 0
    assert json.loads(said.stdout)["people"] == 5


def test_the_table_reads_well_in_a_pipe(process: Cli) -> None:
    said = process("rank", "six-icons", "--people", 20)
    assert said.exit_code == 0, said.stderr
    assert "\x1b" not in said.stdout
    assert max(len(line) for line in said.stdout.splitlines()) <= 80
    for word in ("detected", "onset", "channel", "most confused with", "bits/s", "Worst pair: ", "48 trials"):
        assert word in said.stdout
    assert "not measurements" in " ".join(said.stdout.split())


def test_files_are_joined_into_one_set(cli: Cli, two: Path, tmp_path: Path) -> None:
    more = tmp_path / "more.cue"
    more.write_text(
        "cue 1\nset more { control skin; baseline 33 °C }\nicon slow { warm by 2 °C at 0.5 °C/s; return at 1 °C/s }\n",
        encoding="utf-8",
    )
    said = cli("rank", two, more, "--people", 5, "--json", "-")
    assert said.exit_code == 0, said.stderr
    assert json.loads(said.stdout)["confusion"]["labels"] == ["cool-step", "warm-step", "slow"]


def test_one_icon_has_nothing_to_be_confused_with(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "one.cue"
    path.write_text("cue 1\nicon only { warm by 2 °C at 1 °C/s; return at 1 °C/s }\n", encoding="utf-8")
    said = cli("rank", path, "--people", 5)
    assert said.exit_code == 0, said.stderr
    assert "Worst pair" not in said.stdout


def test_figures_go_into_a_folder_that_is_made(cli: Cli, two: Path, tmp_path: Path) -> None:
    folder = tmp_path / "figures"
    said = cli("rank", two, "--people", 5, "--figure", folder)
    assert said.exit_code == 0, said.stderr
    assert sorted(path.name for path in folder.iterdir()) == [
        "confusion.png",
        "distance.png",
        "overview-cool-step.png",
        "overview-warm-step.png",
    ]
