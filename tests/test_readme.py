"""Commands or snippets in README.md and docs/, run again with the shown output.

``python tests/test_readme.py`` regenerates outputs and pictures; with pages, the outputs of these. Numbers may differ
by 20 % and one of the last digit, as machines round differently; words, names and order may not. A command that several
pages show runs once (`RUNS`).
"""

import contextlib
import hashlib
import io
import os
import re
import shlex
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import pytest
from typer.testing import CliRunner

from thermicon.notebooks.cli.main import app

ROOT = Path(__file__).resolve().parents[1]
README = ROOT / "README.md"
INDEX = ROOT / "docs" / "README.md"
PAGES = (README, *sorted((ROOT / "docs").rglob("*.md")))
LINKING = (*PAGES, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md")
NAMES = [page.relative_to(ROOT).as_posix() for page in PAGES]
FILE = re.compile(r"Save as `(?P<name>[\w.-]+)`[^\n]*\n\n```\w*\n(?P<text>.*?)```", re.DOTALL)
NUMBER = re.compile(r"[-−+]?\d+(\.\d+)?")
BLOCK = re.compile(r"```(?P<kind>console|python)\n(?P<text>.*?)```", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Run:
    """What a command printed, and the files that it wrote."""

    output: str
    written: dict[Path, bytes]


RUNS: dict[tuple[str, str], Run] = {}
"""Runs by command line and by the content of the files that it names: pages share the slow ones."""


def files_below(*places: Path) -> dict[Path, bytes]:
    """Content of every file at or below these places."""
    paths = {path for place in places for path in (place, *place.rglob("*")) if path.is_file()}
    return {path: path.read_bytes() for path in sorted(paths)}


def run_command(line: str) -> str:
    """Return what a ``$ thermicon …`` line prints, and leave the files that it writes in the current folder."""
    words = shlex.split(line[2:])
    assert words[0] == "thermicon"
    named = files_below(*(Path(word) for word in words[1:] if word not in (".", "..") and Path(word).exists()))
    inputs = hashlib.sha256(repr(sorted(named.items())).encode()).hexdigest()
    if (line, inputs) not in RUNS:
        before = files_below(Path())
        result = CliRunner(env={"COLUMNS": "80"}).invoke(app, words[1:])
        assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
        after = files_below(Path())
        written = {path: content for path, content in after.items() if before.get(path) != content}
        RUNS[line, inputs] = Run(result.output.rstrip(), written)
    run = RUNS[line, inputs]
    for path, content in run.written.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return run.output


def run_commands(text: str) -> str:
    """Run the commands of a block and put what each prints below it."""
    lines = [line for line in text.splitlines() if line.startswith("$ ")]
    return "\n\n".join(f"{line}\n{run_command(line)}".rstrip() for line in lines) + "\n"


def run_python(text: str) -> str:
    """Run a snippet; what it prints must be what its ``# →`` comments say, in order."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(text, "snippet", "exec"), {})
    lines = iter(printed.getvalue().splitlines())
    shown = re.sub(r"(?<=^# → ).*", lambda _: next(lines), text, flags=re.MULTILINE)
    assert next(lines, None) is None, "the snippet prints more than it has comments for"
    return shown


def regenerated(page: str) -> str:
    """Return a page with every output regenerated, in an empty folder with the files that it says to save."""
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            for file in FILE.finditer(page):
                Path(file["name"]).write_text(file["text"], encoding="utf-8")
            run = {"console": run_commands, "python": run_python}
            return BLOCK.sub(lambda block: f"```{block['kind']}\n{run[block['kind']](block['text'])}```", page)
        finally:
            os.chdir(here)


def masked(text: str) -> list[str]:
    """Return the words of a text with digits and signs taken out of its numbers."""
    return NUMBER.sub("#", text).split()


def far(shown: str, printed: str) -> list[tuple[str, str]]:
    """Numbers of a text that are more than 20 % and one of their last digit from those of another with its words."""

    def is_far(one: str, other: str) -> bool:
        a, b = (float(number.replace("−", "-")) for number in (one, other))
        last_digit = 10.0 ** -min(len(number.partition(".")[2]) for number in (one, other))
        return abs(a - b) > 0.2 * max(abs(a), abs(b)) + last_digit

    numbers = ([each[0] for each in NUMBER.finditer(text)] for text in (shown, printed))
    return [pair for pair in zip(*numbers, strict=True) if is_far(*pair)]


def anchors(page: Path) -> set[str]:
    """Anchors of the headings of a page, as GitHub makes them; code blocks have none."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    titles = re.findall(r"^#+ (.+)$", text, flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def broken_links(text: str, page: Path) -> list[str]:
    """Relative links of a page whose file or heading does not exist."""
    broken = []
    for link in re.findall(r"\]\((?!\w+:)([^)\s]+)\)", text):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            broken.append(link)
    return broken


@pytest.mark.parametrize(
    "page", [README, *(pytest.param(page, marks=pytest.mark.slow) for page in PAGES[1:])], ids=NAMES
)
def test_a_page_shows_what_happens(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    printed = regenerated(text)
    assert masked(printed) == masked(text), "if it is right: python tests/test_readme.py"
    assert far(text, printed) == [], "if they are right: python tests/test_readme.py"


def test_a_number_of_another_version_is_noticed() -> None:
    assert far("93 % of 12.5 s at −6 °C, 0.2 A", "92 % of 14.9 s at −5 °C, 0.1 A") == []
    assert far("93 % at −6 °C for 12.5 s", "70 % at 6 °C for 16.5 s") == [("93", "70"), ("−6", "6"), ("12.5", "16.5")]


def test_the_readme_is_a_front_door_of_two_commands() -> None:
    """At most two hundred lines: what is longer belongs in docs/."""
    readme, install = README.read_text(encoding="utf-8"), "python3 -m venv .venv && .venv/bin/pip install -e"
    assert f"{install} . && .venv/bin/thermicon rank six-icons\n" in readme
    assert f'{install} ".[test]" && .venv/bin/pytest\n' in readme
    assert len(readme.splitlines()) <= 200


@pytest.mark.parametrize("page", LINKING, ids=[page.relative_to(ROOT).as_posix() for page in LINKING])
def test_every_link_leads_to_a_file_and_a_heading(page: Path) -> None:
    assert broken_links(page.read_text(encoding="utf-8"), page) == []
    wrong = "[file](docs/nothing.md) [heading](LICENSE#nothing) [right](docs/README.md) [web](https://example.org)"
    assert broken_links(wrong, README) == ["docs/nothing.md", "LICENSE#nothing"]


def test_the_index_lists_every_page() -> None:
    linked = re.findall(r"\]\(([^)#]+)", INDEX.read_text(encoding="utf-8"))
    listed = {(INDEX.parent / link).resolve() for link in linked if ":" not in link}
    assert [page for page in PAGES if page not in (README, INDEX) and page not in listed] == []


if __name__ == "__main__":
    named = {Path(name).resolve() for name in sys.argv[1:]}
    for page in (page for page in PAGES if not named or page in named):
        page.write_text(regenerated(page.read_text(encoding="utf-8")), encoding="utf-8")
    if not named:
        sys.path.insert(0, str(ROOT / "docs" / "explain"))  # the pictures are made beside their pages
        from mechanisms.draw_images import draw_images

        draw_images(ROOT / "images")
