"""The docs site as its build makes it."""

import re
import shlex
import subprocess
import sys
from pathlib import Path, PurePosixPath
from types import ModuleType

import pytest
from click import Context
from typer.main import get_command

from tests.legible import troubles
from thermicon.circuit import Rig
from thermicon.notebooks.cli.main import app

ROOT = Path(__file__).resolve().parents[2]
BUILDER = ROOT / "docs" / "builder"
DRAWN = ("gallery", "paper figures", "circuit diagram", "moving percept", "rig stack")
TABLES = ("data_tables", "key_tables", "posterior_tables")
SLOTS = ("options of commands", "python names", *DRAWN)
FROM_ELSEWHERE = re.compile(r"""(?:<script[^>]+src|<link[^>]+href|<img[^>]+src)="(?:https?:)?//[^"]*""")
"""A script, a style or a picture that a page would fetch from another host."""


@pytest.fixture
def builder(monkeypatch: pytest.MonkeyPatch) -> dict[str, ModuleType]:
    """The modules of docs/builder, which is a program and not a package."""
    monkeypatch.syspath_prepend(str(BUILDER))
    names = ("staging", "sections", "command_options", "python_names", "gallery", "page_pictures")
    return {name: __import__(name) for name in (*names, "rig_stack", *TABLES)}


def slots(builder: dict[str, ModuleType]) -> set[str]:
    """Every place that the program fills."""
    tables = (builder["data_tables"].DATA_TABLES, builder["key_tables"].KEY_TABLES, builder["posterior_tables"].TABLES)
    return {*SLOTS, *(name for each in tables for name in each)}


def staged(builder: dict[str, ModuleType], folder: Path) -> Path:
    site = builder["staging"].Staging(folder, dict.fromkeys(slots(builder), lambda: "MADE"))
    site.stage({})
    return folder


def test_every_page_and_tutorial_stands_on_the_site(builder: dict[str, ModuleType], tmp_path: Path) -> None:
    folder, staging = staged(builder, tmp_path), builder["staging"]
    for path in staging.pages():
        assert (folder / staging.staged(PurePosixPath(path.relative_to(ROOT).as_posix()))).is_file(), path
    assert {path.name for path in folder.glob("start/*.ipynb")} >= {"01_first_icon.ipynb", "07_validation.ipynb"}
    assert len(staging.pages()) > 30
    assert (folder / "images" / "workbench.png").is_file()
    front = (folder / "index.md").read_text(encoding="utf-8")
    assert front.count("{grid-item-card}") == 6
    assert (folder / "how-to" / "index.md").read_text(encoding="utf-8").count("\nsimulate\n") == 1
    unsearched = [
        path.name for path in folder.rglob("*.md") if path.read_bytes().startswith(b"---\nnosearch: true\n---")
    ]
    assert sorted(unsearched) == ["changelog.md", "errors.md", "refusals.md"]


def test_links_lead_inside_the_site_and_cue_text_is_plain(builder: dict[str, ModuleType], tmp_path: Path) -> None:
    folder = staged(builder, tmp_path)
    simulate = (folder / "how-to" / "simulate.md").read_text(encoding="utf-8")
    write = (folder / "how-to" / "write-icons.md").read_text(encoding="utf-8")
    assert "(../start/five-minutes.md#five-minutes-from-cue-to-drive)" in write
    assert "```text\ncue 1\n" in write
    assert "(../images/cooling-step.png)" in simulate
    for path in folder.rglob("*.md"):
        prose = re.sub(r"^ *```.*?^ *```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        for link in re.findall(r"\]\((?!\w+:)([^)\s#]+)", prose):
            assert (path.parent / link).exists(), f"{path.name}: {link}"


def test_a_slot_is_filled_and_its_stand_in_gone(builder: dict[str, ModuleType], tmp_path: Path) -> None:
    page = (staged(builder, tmp_path) / "reference" / "options.md").read_text(encoding="utf-8")
    assert "MADE" in page
    assert "site is built" not in page


def test_every_slot_is_on_a_page(builder: dict[str, ModuleType]) -> None:
    pages = [path.read_text(encoding="utf-8") for path in builder["staging"].pages()] + [builder["sections"].WELCOME]
    assert {slot["name"] for page in pages for slot in builder["staging"].SLOT.finditer(page)} == slots(builder)


def test_every_job_has_a_picture_that_commands_can_draw(builder: dict[str, ModuleType]) -> None:
    commands = getattr(get_command(app), "commands", {})
    for path in (ROOT / "docs" / "how-to").glob("*.md"):
        text, pictures = path.read_text(encoding="utf-8"), builder["page_pictures"]
        lines = [line for mark in pictures.MARK.finditer(text) for line in pictures.command_lines(mark)]
        assert lines or "](../../images/" in text, path
        for line in lines:
            name, *words = shlex.split(line)
            commands[name].make_parser(Context(commands[name])).parse_args(words)  # an unknown option raises


def test_a_picture_is_drawn_from_the_files_of_its_page(builder: dict[str, ModuleType], tmp_path: Path) -> None:
    page = "Save as `a.cue`:\n\n```\ncue 1\nicon a { cool by 4 °C at 4 °C/s }\n```\n\n"
    site = builder["staging"].Staging(tmp_path / "site", {}, tmp_path / "kept")
    text = site.filled(f"{page}<!-- picture: simulate a.cue | An icon -->\n", PurePosixPath("docs/x.md"))
    [picture] = (tmp_path / "site" / "pictures").iterdir()
    assert f"```{{figure}} /pictures/{picture.name}\n:alt: An icon\n:figclass: beside\n" in text
    assert picture.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(RuntimeError, match=r"thermicon simulate b\.cue --figure"):
        site.filled(f"{page}<!-- picture: simulate b.cue | Another -->\n", PurePosixPath("docs/x.md"))


def test_the_lists_are_those_of_the_data(builder: dict[str, ModuleType]) -> None:
    tables = builder["data_tables"]
    assert tables.errors().count("\n### E") == len(tables.catalogue())
    assert "| skin surface | hard | ≤ 42 °C | `skin_highest_C` | 43 °C |" in tables.limits_table().splitlines()
    assert (
        "| rate of skin temperature | hard | ±10 K/s | `skin_rate_K_per_s` | only tightened |" in tables.limits_table()
    )
    assert tables.uncertainties_table().count("| thermicon, a choice of this project") == 7


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("[a](nowhere.md)", r"docs/x\.md: the link to nowhere\.md leads to no file"),
        ("<!-- site: galery -->\n<!-- end of site -->\n", r"docs/x\.md: there is no slot 'galery', only gallery"),
    ],
)
def test_a_page_that_cannot_be_staged_is_named(
    builder: dict[str, ModuleType], tmp_path: Path, text: str, fault: str
) -> None:
    staging = builder["staging"]
    site = staging.Staging(tmp_path, {"gallery": str})
    with pytest.raises(staging.StagingError, match=fault):
        site.filled(site.linked(text, PurePosixPath("docs/x.md"), PurePosixPath("x.md")), PurePosixPath("docs/x.md"))


def test_every_option_of_every_command_is_listed(builder: dict[str, ModuleType]) -> None:
    page = builder["command_options"].command_options()
    for name, command in getattr(get_command(app), "commands", {}).items():
        assert f"### `{name}`\n" in page
        for parameter in command.params:
            if parameter.name != "help":
                assert (parameter.opts[0] if parameter.opts[0].startswith("-") else parameter.metavar) in page
    assert "[default: 200; 1<=x<=100000]" in page.replace("\\", "")


def test_every_public_name_has_its_entry(builder: dict[str, ModuleType]) -> None:
    from thermicon import circuit, icons, notebooks, perception

    pages = dict(builder["python_names"].python_pages())
    for package in (icons, circuit, perception, notebooks):
        page = pages[f"reference/python-{package.__name__.rpartition('.')[2]}.md"]
        for name in package.__all__:
            assert f":: {package.__name__}.{name}\n" in page, name


@pytest.mark.slow
def test_a_gallery_without_predictions_shows_every_set(builder: dict[str, ModuleType]) -> None:
    from thermicon.icons.files.shipped import library_names

    written: dict[str, bytes] = {}
    page = builder["gallery"].gallery(None, written.__setitem__)
    for name in library_names():
        assert f"## {name}\n" in page
        assert written[f"gallery/{name}.png"].startswith(b"\x89PNG")
    assert page.count("```cue\ncue 1\n") == len(list(library_names()))


def test_sphinx_alone_names_the_command(tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "sphinx", "-q", "docs", str(tmp_path)], cwd=ROOT, capture_output=True, text=True
    )
    assert run.returncode != 0
    assert "python docs/builder" in run.stderr


def build(folder: Path, *options: str) -> str:
    """Build the site, and return what was reported."""
    run = subprocess.run(
        [sys.executable, "docs/builder", "-o", str(folder), *options], cwd=ROOT, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    assert "WARNING: " not in run.stderr.replace("[IPKernelApp] WARNING | ", ""), run.stderr
    return run.stderr


@pytest.mark.slow
def test_the_site_builds_without_a_warning_and_fetches_nothing(tmp_path: Path) -> None:
    build(tmp_path, "--no-execute")
    html = tmp_path / "plain" / "html"
    for page in ("index", "search", "gallery", "how-to/netlist", "reference/python-circuit", "contribute/index"):
        assert (html / f"{page}.html").is_file()
    for path in html.rglob("*.html"):
        assert FROM_ELSEWHERE.findall(path.read_text(encoding="utf-8")) == [], path


@pytest.mark.slow
def test_tutorials_and_predictions_are_made_once(tmp_path: Path) -> None:
    build(tmp_path)
    first = {path: path.stat().st_mtime_ns for path in (tmp_path / "predicted").rglob("*.png")}
    page = (tmp_path / "html" / "start" / "03_six_icons_ranked.html").read_text(encoding="utf-8")
    assert page.count("<img") >= 2
    assert "d′" in page
    gallery = (tmp_path / "html" / "gallery.html").read_text(encoding="utf-8")
    assert gallery.count("-confusions.png") >= 6
    assert "Executing notebook" not in build(tmp_path)
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "predicted").rglob("*.png")} == first


@pytest.mark.parametrize("width_mm", [85.0, 180.0])
def test_the_stack_of_a_rig_names_keys_that_set_it(builder: dict[str, ModuleType], width_mm: float) -> None:
    rig = Rig.load("thenar")
    axes = builder["rig_stack"].plot_stack(rig, width_mm)
    said = [text.get_text().split(" = ") for text in axes.texts if " = " in text.get_text()]
    assert rig.with_(**{key: 0.9 * float(value.rstrip(", …")) for key, value in said}).changes
    assert len(said) >= 20
    assert troubles(axes.figure) == []
