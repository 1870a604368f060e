"""``validate --leave-out``: goes on from finished parts, sums up, and writes the tables that the report reads."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

from thermicon.perception.evidence.left_out_file import load_left_out
from thermicon.perception.evidence.variant_scores import load_variant_scores
from thermicon.perception.observer.observer import DATA

Cli = Callable[..., Any]


@pytest.fixture
def finished(tmp_path: Path) -> Path:
    """A folder in which a run has left every part."""
    folder = tmp_path / "parts"
    folder.mkdir()
    rows = load_left_out()
    for experiment in dict.fromkeys(row.experiment for row in rows):
        own = [asdict(row) for row in rows if row.experiment == experiment]
        (folder / f"left-out-{experiment}.json").write_text(json.dumps(own), encoding="utf-8")
    for name, ending in (("temperature", "temperature"), ("heat_flow", "heat-flow")):
        scores = [getattr(row, name) for row in load_variant_scores()]
        (folder / f"scores-{ending}.json").write_text(json.dumps(scores), encoding="utf-8")
    return folder


def test_finished_parts_are_summed_up_and_written(cli: Cli, finished: Path, tmp_path: Path) -> None:
    out = tmp_path / "tables"
    said = cli("validate", "--leave-out", "--keep", finished, "-o", out)
    assert said.exit_code == 0, said.stderr
    words = " ".join(said.stdout.split())
    assert "rows lie inside their 50 % interval" in words
    assert "temperature is ahead of heat flow by" in words
    for name in ("left-out.csv", "variant-scores.csv"):
        assert (out / name).read_text(encoding="utf-8") == (DATA / name).read_text(encoding="utf-8")


def test_options_that_do_not_go_together(cli: Cli, tmp_path: Path) -> None:
    said = cli("validate", "--leave-out", "--json", tmp_path / "out.json")
    assert said.exit_code == 2
    assert "--leave-out writes tables" in " ".join(said.stderr.replace("│", " ").split())
    said = cli("validate", "--keep", tmp_path)
    assert said.exit_code == 2
    assert "only --leave-out keeps parts" in " ".join(said.stderr.replace("│", " ").split())


def test_a_folder_that_is_a_file_is_bad_input(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("", encoding="utf-8")
    said = cli("validate", "--leave-out", "--keep", path)
    assert (said.exit_code, said.stdout) == (1, "")
    assert "file" in said.stderr
