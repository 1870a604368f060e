"""The package as a stranger gets it: source archive or wheel, installed elsewhere."""

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("thermicon", "base", "icons", "circuit", "perception", "notebooks")
LEFT_OUT = shutil.ignore_patterns(
    ".git", ".venv", "__pycache__", "*.py[cod]", "*.egg-info", "build", "dist", ".*_cache", ".hypothesis"
)
AWKWARD = "Größe mit Lücken"
"""A folder whose name has spaces and umlauts."""

pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Archives:
    """The built source archive and wheel, and what the build printed."""

    source: Path
    wheel: Path
    printed: str


def shipped(folder: Path) -> set[str]:
    """Files of the packages, by their paths in the checkout."""
    return {
        path.relative_to(folder).as_posix()
        for package in PACKAGES
        for path in (folder / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


@pytest.fixture(scope="module")
def archives(tmp_path_factory: pytest.TempPathFactory) -> Archives:
    """Built from a copy: the source archive first, and the wheel from that archive, as `python -m build` does."""
    folder = tmp_path_factory.mktemp("build") / AWKWARD
    shutil.copytree(ROOT, folder, symlinks=True, ignore=LEFT_OUT)
    command = [sys.executable, "-m", "build", "--outdir", str(folder / "dist"), str(folder)]
    run = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=600, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    (source,), (wheel,) = (folder / "dist").glob("*.tar.gz"), (folder / "dist").glob("*.whl")
    return Archives(source, wheel, run.stdout + run.stderr)


def test_the_build_warns_of_nothing(archives: Archives) -> None:
    warned = re.compile(r"deprecat|absent from|warning: (?!build_py|install_lib|location|no previously)", re.IGNORECASE)
    assert [line for line in archives.printed.splitlines() if warned.search(line)] == []


def test_the_source_archive_is_complete(archives: Archives) -> None:
    with tarfile.open(archives.source) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    expected = shipped(ROOT) | {
        path.relative_to(ROOT).as_posix()
        for folder in ("tests", "docs", "images", ".ci", "conda-recipe")
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and not {"__pycache__", "_build"} & set(path.parts)
    }
    expected |= {"LICENSE", "README.md", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "SECURITY.md", "Dockerfile"}
    expected |= {".dockerignore", ".types/thermicon/__init__.pyi", ".types/thermicon/py.typed"}
    typed = {name for name in shipped(ROOT) if name.endswith((".py", ".pyi")) and not name.startswith("thermicon/")}
    expected |= {f".types/thermicon/{name}" for name in typed}  # mypy reads the packages there
    assert expected - names == set()
    assert [name for name in names if name.endswith(".pyc") or "__pycache__" in name] == []


def test_the_wheel_holds_the_packages_and_nothing_else(archives: Archives) -> None:
    with zipfile.ZipFile(archives.wheel) as wheel:
        names = set(wheel.namelist())
    held = {name for name in names if name.startswith("thermicon/")}
    assert held == {name if name.startswith("thermicon/") else f"thermicon/{name}" for name in shipped(ROOT)}
    others = {name.partition("/")[0] for name in names} - {"thermicon"}
    assert {name.rpartition(".")[2] for name in others} == {"dist-info"}
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in names)


@dataclass(frozen=True)
class Stranger:
    """An environment with the wheel in it, and a folder to work in."""

    python: Path
    folder: Path

    def run(self, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
        """Run the command in a bare environment: no terminal, no locale, no mode of UTF-8."""
        keep = {name: os.environ[name] for name in ("PATH", "SYSTEMROOT", "TEMP", "HOME") if name in os.environ}
        bare = {"LC_ALL": "C", "TERM": "dumb", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
        command = [str(self.python.with_name("thermicon")), *words]
        return subprocess.run(
            command,
            cwd=self.folder,
            env={**keep, **bare, **variables},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=500,
            check=False,
        )


@pytest.fixture(scope="module")
def stranger(archives: Archives, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stranger]:
    """The wheel in an environment that sees the libraries of this one, and not this checkout.

    Only Python's own lines of a .pth file are read at the start, so that an editable installation stays out of sight.
    """
    folder = tmp_path_factory.mktemp("stranger") / AWKWARD
    subprocess.run([sys.executable, "-m", "venv", str(folder / "venv")], check=True, timeout=300)
    python = folder / "venv" / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    (site,) = {*(folder / "venv").glob("lib/*/site-packages"), *(folder / "venv").glob("Lib/site-packages")}
    seen = [path for path in sys.path if path.endswith("site-packages")]
    (site / "libraries.pth").write_text("".join(f"{path}\n" for path in seen), encoding="utf-8")
    install = [str(python), "-m", "pip", "install", "--quiet", "--no-deps", "--ignore-installed", str(archives.wheel)]
    subprocess.run(install, check=True, timeout=300, capture_output=True)
    (folder / "mine").mkdir()
    yield Stranger(python, folder / "mine")
    subprocess.run([str(python), "-m", "pip", "uninstall", "--yes", "thermicon"], check=True, capture_output=True)
    left = subprocess.run([str(python), "-c", "import thermicon.icons"], cwd=folder, capture_output=True, text=True)
    assert "ModuleNotFoundError" in left.stderr, "something of it can still be imported"
    assert not any((site / "thermicon").rglob("*.*")), "files are left"


def test_the_installed_package_ranks_a_set(stranger: Stranger) -> None:
    run = stranger.run("rank", "six-icons", "--people", "20", "--json", "ränge.json")
    assert (run.returncode, run.stderr.count("Traceback")) == (0, 0), run.stderr
    assert "double-dip" in run.stdout
    assert len(json.loads((stranger.folder / "ränge.json").read_text("utf-8"))["icons"]) == 6


def test_the_installed_package_checks_exports_and_copies_notebooks(stranger: Stranger) -> None:
    cue = "cue 1\nset mine { site thenar; control display; baseline 32 °C }\nicon kühl { cool by 2 °C at 1 °C/s }\n"
    (stranger.folder / "größe.cue").write_text(cue.replace("kühl", "cool"), encoding="utf-8")
    run = stranger.run("check", "größe.cue")
    (following,) = run.stderr.splitlines()
    assert run.returncode == 0 and following.startswith("Next: thermicon simulate "), run.stderr
    run = stranger.run("export", "größe.cue", "--to", "csv", "-o", "Aus gabe")
    assert run.returncode == 0, run.stderr
    assert {path.suffix for path in (stranger.folder / "Aus gabe").rglob("*")} >= {".csv", ".json"}
    run = stranger.run("lab", "Hefte", "--files-only")
    assert run.returncode == 0, run.stderr
    assert (stranger.folder / "Hefte" / "workbench.ipynb").is_file()


def test_the_doctor_finds_the_installed_package_sound(stranger: Stranger) -> None:
    run = stranger.run("doctor", "--json")
    findings = {each["check"]: each for each in json.loads(run.stdout)["findings"]}
    assert "Größe mit Lücken" in findings["Python"]["text"]
    states = {check: findings[check]["state"] for check in ("Python", "packages", "self-test")}
    assert set(states.values()) == {"ok"}, findings


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such file")
def test_without_a_home_everything_runs_and_says_what_it_costs(stranger: Stranger) -> None:
    run = stranger.run("simulate", "six-icons", "--icon", "cooling-step", HOME="/dev/null", XDG_CACHE_HOME="/dev/null")
    assert run.returncode == 0, run.stderr
    assert "compiled code cannot be stored" in run.stderr
    assert "cooling-step" in run.stdout
