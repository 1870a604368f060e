"""``thermicon validate``: the table, the notebook in a folder, and what it says to bad input."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import nbformat
import pytest

from thermicon.icons.atomic import OutputError
from thermicon.notebooks.cli import validation
from thermicon.notebooks.cli.validation import COMPUTED, KEPT, executed_notebook, json_text, write_report
from thermicon.notebooks.report.terminal import show
from thermicon.notebooks.report.validate_report import TITLE, validate_report
from thermicon.perception.evidence.conditioning import suspected
from thermicon.perception.evidence.validate import ValidationReport, validate

Cli = Callable[..., Any]
NOTEBOOK = Path(__file__).parents[3] / "notebooks/07_validation.ipynb"
PICTURES = 12
MOST_SAVED = 1_000_000


@pytest.fixture(scope="module")
def report(validation_report: ValidationReport) -> ValidationReport:
    return validation_report


def outputs(text: str) -> tuple[list[set[str]], str]:
    """Kinds of the outputs of every cell with code, and all that the cells show as text."""
    code = [cell for cell in nbformat.reads(text, as_version=4).cells if cell.cell_type == "code"]
    kinds = [{kind for output in cell.outputs for kind in output.get("data", {"stream": 1})} for cell in code]
    shown = (output.data.get("text/html", "") for cell in code for output in cell.outputs if "data" in output)
    return kinds, "".join(shown)


@pytest.mark.slow
def test_the_executed_notebook_shows_every_number(report: ValidationReport, tmp_path: Path) -> None:
    write_report(report, tmp_path / "report")
    assert sorted(path.name for path in (tmp_path / "report").iterdir()) == ["07_validation.ipynb", "validation.json"]
    data = json.loads((tmp_path / "report/validation.json").read_text(encoding="utf-8"))
    text = (tmp_path / "report/07_validation.ipynb").read_text(encoding="utf-8")
    kinds, shown = outputs(text)
    assert sum("image/png" in kind for kind in kinds) == PICTURES - 1  # both maps of trade-offs are of one cell
    assert not any("stream" in kind for kind in kinds)
    assert len(text) < MOST_SAVED
    for target in data["targets"]:
        for row in target["rows"]:
            for said in (row["row"], row["published"]["text"], row["criterion"]["text"]):
                assert html(said) in shown
            for one in row["predicted"]:
                value = "not felt" if one["value"] is None else f"{one['value']:.3g}"
                assert f"{value} [" in shown
                assert html(f"{one['verdict']}: {one['text']}") in shown
        assert html(target["mechanism_suspected"]) in shown
    for row in data["conditioning"]["rows"]:
        assert html(row["row"]) in shown
    for constant in data["conditioning"]["constants"]:
        assert constant["name"] in shown


def html(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


@pytest.mark.slow
def test_the_same_numbers_give_the_same_notebook_also_without_draws() -> None:
    numbers = json_text(validate(people=2, draws=0))
    first = executed_notebook(numbers)
    assert first == executed_notebook(numbers)
    kinds, _ = outputs(first)
    assert sum("image/png" in kind for kind in kinds) == PICTURES - 2  # no trade-offs


def test_json_to_a_file_or_to_stdout(
    report: ValidationReport, cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermicon.perception.evidence.validate.validate", lambda **_: report)
    said = cli("validate", "--json", tmp_path / "v.json")
    assert said.exit_code == 0
    assert "wrote" in said.stderr
    assert TITLE in said.stdout
    printed = cli("validate", "--json", "-")
    assert printed.stdout == (tmp_path / "v.json").read_text(encoding="utf-8")
    assert set(json.loads(printed.stdout)) >= {"targets", "conditioning"}


def test_it_is_complete_or_absent(report: ValidationReport, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(self: Path, *_: object, **__: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(validation, "executed_notebook", lambda _: "{}")
    monkeypatch.setattr(Path, "write_text", broken)
    folder = tmp_path / "report"
    with pytest.raises(OutputError, match=r"cannot write .*report.*: No space left on device"):
        write_report(report, folder)
    assert not folder.exists()


def test_without_the_parts_of_jupyter_the_cure_is_said_before_anything_is_computed(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(validation, "find_spec", lambda name: None if name == "nbclient" else object())
    said = cli("validate", "-o", tmp_path / "report")
    assert said.exit_code == 1
    assert "needs nbclient: pip install nbclient" in " ".join(said.stderr.split())
    assert not (tmp_path / "report").exists()


def test_the_table_on_a_terminal(report: ValidationReport, capsys: pytest.CaptureFixture[str]) -> None:
    show(validate_report(report))
    said = capsys.readouterr().out
    for section in report.sections:
        assert f"{section.target.number} {section.target.title}" in said
    assert "✓ holds, ✗ misses" in said
    assert "49 of 54 published numbers" in " ".join(said.split())
    for each in report.conditioning.missed:
        assert suspected(each).split(":")[0] in " ".join(said.split())
    assert max(len(line) for line in said.splitlines()) <= 80


def test_one_cell_of_the_notebook_computes_and_can_be_replaced() -> None:
    code = [cell for cell in nbformat.read(NOTEBOOK, as_version=4).cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    (computing,) = [cell for cell in code if cell.source.startswith(COMPUTED)]
    assert computing.source == "data = report_file(validate(people=40, draws=8))"
    assert KEPT.splitlines()[-1].startswith("data = ")


@pytest.mark.slow
def test_the_command_writes_the_report_within_its_time(process: Cli, tmp_path: Path) -> None:
    said = process("validate", "-o", tmp_path / "report", "--people", "20", "--draws", "8")
    assert said.exit_code == 0
    assert "wrote" in said.stderr
    assert (tmp_path / "report/07_validation.ipynb").exists()
