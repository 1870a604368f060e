"""``thermicon validate``: the table, the report in a folder, and what it says to bad input."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from thermicon.notebooks.cli.main import validation
from thermicon.notebooks.cli.validation import draw_pictures, show_report, write_report
from thermicon.notebooks.files.outputs import OutputError
from thermicon.notebooks.pages.blocks import Bullets, Cell, Grid, Heading, Picture, Text, as_html, as_markdown
from thermicon.notebooks.pages.conditioning_page import TITLE
from thermicon.notebooks.pages.validation_page import page, target_rows
from thermicon.perception.inference.table_text import number
from thermicon.perception.validation.validate import ValidationReport, validate

NOTEBOOK = Path(__file__).parents[3] / "notebooks/07_validation.ipynb"


@pytest.fixture(scope="module")
def report(validation_report: ValidationReport) -> ValidationReport:
    return validation_report


@pytest.fixture(scope="module")
def written(report: ValidationReport, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("out") / "report"
    write_report(report, folder)
    return folder


def test_the_report_is_complete(written: Path) -> None:
    names = sorted(path.name for path in written.iterdir())
    assert names == ["figures", "validation.html", "validation.json", "validation.md"]
    html = (written / "validation.html").read_text(encoding="utf-8")
    assert len(html) < 2_000_000
    assert 'src="data:image/png' in html
    assert "http" not in html
    markdown = (written / "validation.md").read_text(encoding="utf-8")
    linked = set(re.findall(r"\]\(figures/(.+?)\.png\)", markdown))
    assert linked == {path.stem for path in (written / "figures").iterdir()}
    assert html.count("<img") == len(linked)


def test_the_numbers_agree(written: Path) -> None:
    """Every prediction of the JSON file stands in the row of its number, in Markdown and in HTML."""
    data = json.loads((written / "validation.json").read_text(encoding="utf-8"))
    markdown = (written / "validation.md").read_text(encoding="utf-8")
    html = (written / "validation.html").read_text(encoding="utf-8")
    for target in data["targets"]:
        part = markdown.split(f"\n## {target['number']} ")[1].split("\n## ")[0]
        for row in target["rows"]:
            (line,) = [one for one in part.splitlines() if one.startswith(f"| {row['row']} |")]
            cells = [cell.strip() for cell in line.strip("|").split(" | ")]
            assert cells[1] == row["published"]["text"]
            assert cells[2] == row["criterion"]["text"]
            for cell, one in zip(cells[3:], row["predicted"], strict=True):
                assert one["verdict"] == "shown" or one["verdict"] in cell
                number = re.match(r"[✓✗ ]*(\S+)", cell)
                assert number is not None
                if one["value"] is not None:
                    shown = float(number[1].replace("−", "-"))
                    assert shown == pytest.approx(one["value"], rel=0.006, abs=1e-9)
                    assert number[1] in html
                else:
                    assert "not felt" in cell


def test_the_table_of_targets_comes_first(report: ValidationReport) -> None:
    blocks = page(report)
    (first, second) = [block for block in blocks if isinstance(block, Grid)][:2]
    assert [row[0].text for row in first.rows] == [str(k) for k in range(1, 9)]
    assert second.columns[-1] == "better"
    assert list(first.rows) == target_rows(report)
    titles = [block.text for block in blocks if isinstance(block, Heading) and block.level < 3]
    assert titles[1:3] == ["Temperature or heat flow: which variable explains which result", TITLE]
    assert titles[-1] == "Trade-offs"
    assert [title[0] for title in titles[3:-1]] == [str(k) for k in range(1, 9)]


def test_the_page_leads_with_every_published_number(report: ValidationReport, written: Path) -> None:
    first = next(block for block in page(report) if isinstance(block, Picture))
    assert page(report)[1] == first
    assert first.name == "published-predicted"
    assert (written / "figures/published-predicted.pdf").read_bytes().startswith(b"%PDF")


def test_the_evidence_behind_the_constants_is_on_the_page(report: ValidationReport, written: Path) -> None:
    text = (written / "validation.md").read_text(encoding="utf-8").split(f"## {TITLE}")[1].split("\n## 1 ")[0]
    known = report.conditioning
    for each in known.rows:
        label = each.row.label.removesuffix(", both")
        (line,) = [one for one in text.splitlines() if re.match(rf"\| {re.escape(label)}( \([^|]*\))? \|", one)]
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        assert cells[1].startswith(number(each.row.published))
        assert cells[2:4] == [number(one) for one in (each.row.fitted, each.row.heat_flow)]
        assert cells[4].startswith(f"{'✓' if each.covered else '✗'} {number(each.row.left_out)} [")
    for each in known.constants:
        assert f"| {each.constant.name} |" in text
    for each in known.ablation:
        assert f"without {each.run.without}" in text
        assert all(source.partition("|")[0] in text for source in each.sources)
    for stages in known.stages:
        assert f"| {stages.icon} | {stages.channel} | {stages.receptor_s:.2f} |" in text
    assert "3 K: d′ 17.7; 10 K: 34 steps" in text


def test_json_to_a_file_or_to_stdout(
    report: ValidationReport, cli: Callable[..., object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermicon.perception.validation.validate.validate", lambda **_: report)
    said = cli("validate", "--json", tmp_path / "v.json")
    assert said.exit_code == 0  # type: ignore[attr-defined]
    assert "wrote" in said.stderr  # type: ignore[attr-defined]
    assert TITLE in said.stdout  # type: ignore[attr-defined]
    printed = cli("validate", "--json", "-")
    assert printed.stdout == (tmp_path / "v.json").read_text(encoding="utf-8")  # type: ignore[attr-defined]
    assert set(json.loads(printed.stdout)) >= {"targets", "conditioning"}  # type: ignore[attr-defined]
    missing = cli("validate", "--json", tmp_path / "nowhere" / "v.json")
    assert missing.exit_code == 1  # type: ignore[attr-defined]
    assert "nowhere" in missing.stderr  # type: ignore[attr-defined]


@pytest.mark.slow
def test_the_same_report_gives_the_same_files(report: ValidationReport, written: Path, tmp_path: Path) -> None:
    write_report(report, tmp_path)
    for path in written.rglob("*"):
        if path.is_file():
            assert path.read_bytes() == (tmp_path / path.relative_to(written)).read_bytes(), path.name


def test_it_is_complete_or_absent(report: ValidationReport, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(self: Path, *_: object, **__: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", broken)
    monkeypatch.setattr(validation, "draw_pictures", lambda _: dict.fromkeys(draw_names(report), b""))
    folder = tmp_path / "report"
    with pytest.raises(OutputError, match=r"cannot write into .*report: No space left on device"):
        write_report(report, folder)
    assert not folder.exists()


def draw_names(report: ValidationReport) -> list[str]:
    return [block.name for block in page(report) if isinstance(block, Picture)]


def test_the_table_on_a_terminal(report: ValidationReport, capsys: pytest.CaptureFixture[str]) -> None:
    show_report(report)
    said = capsys.readouterr().out
    for section in report.sections:
        assert f"{section.target.number} {section.target.title}" in said
    assert "✓ holds, ✗ misses" in said
    assert "49 of 54 published numbers" in " ".join(said.split())
    for each in report.conditioning.missed:
        assert each.suspected.split(":")[0] in " ".join(said.split())
    assert max(len(line) for line in said.splitlines()) <= 80


@pytest.mark.slow
def test_without_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bare = validate(people=2, draws=0)
    write_report(bare, tmp_path / "r")
    text = (tmp_path / "r/validation.md").read_text(encoding="utf-8")
    assert "Too few draws" in text
    assert "(0; at least 8 are needed)" in text
    assert "trade-offs" not in draw_pictures(bare)
    assert "of draws hold" not in text


def test_bad_usage(cli: Callable[..., object], tmp_path: Path) -> None:
    for arguments, message in (
        (("--people", 1), "1 is outside 2 to 2000"),
        (("--draws", -1), "-1 is outside 0 to 1000"),
        (("--draws", 1), "1 draw has no interval"),
        (("--seed", -1), "-1 is outside 0 to"),
    ):
        said = cli("validate", *arguments)
        assert said.exit_code == 2  # type: ignore[attr-defined]
        assert message in " ".join(said.stderr.split())  # type: ignore[attr-defined]
    (tmp_path / "file").write_text("")
    said = cli("validate", "-o", tmp_path / "file")
    assert said.exit_code == 1  # type: ignore[attr-defined]
    assert "it is a file; give the name of a folder" in " ".join(said.stderr.split())  # type: ignore[attr-defined]


def test_pages() -> None:
    blocks = [
        Heading("A | B"),
        Text("x_y"),
        Bullets(("one", "<two>")),
        Grid(("a",), ((Cell("1", "holds"),),)),
        Picture("p", "c"),
    ]
    assert as_markdown(blocks) == (
        "## A \\| B\n\nx\\_y\n\n- one\n- <two>\n\n| a |\n| --- |\n| ✓ 1 |\n\n![c](figures/p.png)\n\n*c*\n"
    )
    html = as_html(blocks, "t", {"p": b"x"})
    assert '<td class="holds">1</td>' in html
    assert "&lt;two&gt;" in html


def test_the_notebook_is_thin_and_has_no_outputs() -> None:
    code = [cell for cell in nbformat.read(NOTEBOOK, as_version=4).cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    assert all(len(cell.source.splitlines()) <= 7 for cell in code)
    assert "def " not in "".join(cell.source for cell in code)


@pytest.mark.slow
def test_every_cell_of_the_notebook_runs_and_shows_something(tmp_path: Path) -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    resources = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources=resources).execute()
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    kinds = [{kind for output in cell.outputs for kind in output.get("data", {"text": 1})} for cell in code]
    assert kinds[0] == set()
    assert all(kinds[1:])
    assert sum("image/png" in kind for kind in kinds) == 10
    assert len(nbformat.writes(notebook)) < 450_000


@pytest.mark.slow
def test_the_command_writes_the_report_within_its_time(process: Callable[..., object], tmp_path: Path) -> None:
    said = process("validate", "-o", tmp_path / "report", "--people", "20", "--draws", "8")
    assert said.exit_code == 0  # type: ignore[attr-defined]
    assert "wrote" in said.stderr  # type: ignore[attr-defined]
    assert (tmp_path / "report/validation.html").exists()
