"""``thermicon validate`` at the command line and in the notebook."""

import json
from pathlib import Path

import pytest

from tests.notebooks.conftest import Cli
from thermicon.notebooks.report.validate_report import TITLE
from thermicon.perception.evidence.results import load_missed
from thermicon.perception.evidence.validate import ValidationReport


def test_the_table_and_the_json(
    validation_report: ValidationReport, cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    report = validation_report
    monkeypatch.setattr("thermicon.perception.evidence.validate.validate", lambda **_: report)
    said = cli.good("validate", "--json", tmp_path / "v.json")
    assert "wrote" in said.stderr
    words = " ".join(said.stdout.split())
    for section in report.sections:
        assert f"{section.target.number} {section.target.title}" in words
    for part in (TITLE, "✓ holds, ✗ misses", "34 of 36 published numbers"):
        assert part in words
    for each in load_missed():
        assert each.suspected.split(":")[0] in words
    assert max(len(line) for line in said.stdout.splitlines()) <= 80
    printed = cli("validate", "--json", "-")
    assert printed.stdout == (tmp_path / "v.json").read_text(encoding="utf-8")
    assert set(json.loads(printed.stdout)) >= {"targets", "conditioning"}
