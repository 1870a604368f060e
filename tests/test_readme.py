"""What README.md and docs/ show is what the program does: their commands and snippets are run, the output compared.

``python tests/test_readme.py`` writes outputs and pictures anew. Digits are not compared, since the last one may differ
between machines; words, names and order are.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import tempfile
from pathlib import Path

import pytest
from typer.testing import CliRunner

from thermicon.notebooks.cli.main import app

ROOT = Path(__file__).resolve().parents[1]
README = ROOT / "README.md"
PAGES = (README, *sorted((ROOT / "docs").rglob("*.md")))
FILE = re.compile(r"Save as `(?P<name>[\w.-]+)`[^\n]*\n\n```\w*\n(?P<text>.*?)```", re.DOTALL)
BLOCK = re.compile(r"```(?P<kind>console|python)\n(?P<text>.*?)```", re.DOTALL)


def run_commands(text: str) -> str:
    """Run the ``$ thermicon …`` lines of a block and put what they print below each."""
    shown = []
    for line in text.splitlines():
        if not line.startswith("$ "):
            continue
        words = shlex.split(line[2:])
        assert words[0] == "thermicon"
        result = CliRunner(env={"COLUMNS": "80"}).invoke(app, words[1:])
        assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
        shown.append(f"{line}\n{result.output.rstrip()}".rstrip())
    return "\n\n".join(shown) + "\n"


def run_python(text: str) -> str:
    """Run a snippet; what it prints must be what its ``# →`` comments say, in order."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(text, "README.md", "exec"), {})
    lines = iter(said.getvalue().splitlines())
    fresh = re.sub(r"(?<=^# → ).*", lambda _: next(lines), text, flags=re.MULTILINE)
    assert next(lines, None) is None, "the snippet prints more than it has comments for"
    return fresh


def replay(readme: str) -> str:
    """Return the readme with every output made anew, in an empty folder that holds the files it tells to save."""
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            for found in FILE.finditer(readme):
                Path(found["name"]).write_text(found["text"], encoding="utf-8")
            run = {"console": run_commands, "python": run_python}
            return BLOCK.sub(lambda b: f"```{b['kind']}\n{run[b['kind']](b['text'])}```", readme)
        finally:
            os.chdir(here)


def masked(text: str) -> list[str]:
    """Return the words of a text with digits and signs taken out of its numbers."""
    return re.sub(r"[-−+]?\d+(\.\d+)?", "#", text).split()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_shows_what_happens(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert masked(replay(text)) == masked(text)


def test_the_readme_begins_with_the_two_commands() -> None:
    readme = README.read_text(encoding="utf-8")
    assert "python3 -m venv .venv && .venv/bin/pip install -e . && .venv/bin/thermicon rank six-icons\n" in readme
    assert 'python3 -m venv .venv && .venv/bin/pip install -e ".[test]" && .venv/bin/pytest\n' in readme


@pytest.mark.parametrize("page", (*PAGES, ROOT / "CONTRIBUTING.md"), ids=lambda page: page.name)
def test_links_to_files_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target


def draw_images(folder: Path) -> None:
    """Draw the two pictures of the readme anew."""
    from thermicon.circuit import Rig, simulate
    from thermicon.icons import read_cue
    from thermicon.notebooks import overview, set_figure
    from thermicon.perception import perceive, rank

    rig = Rig.load("thenar")
    set_figure(rank(read_cue("six-icons"), rig)).savefig(folder / "six-icons.png", dpi=100)
    trace = simulate(read_cue("cooling-step-skin")["cooling-step"], rig, tail_s=10.0)
    overview(trace, perceive(trace)).savefig(folder / "cooling-step.png", dpi=90)


if __name__ == "__main__":
    for page in PAGES:
        page.write_text(replay(page.read_text(encoding="utf-8")), encoding="utf-8")
    draw_images(README.parent / "images")
