"""Checks of what is installed: Python, thermicon itself, what it requires by ``pip check``, extras, outside programs.

Nothing that may be broken is imported.
"""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distributions, version
from pathlib import Path

from ..startup import hidden_by, installed_folders
from .finding import Finding, State

PROGRAM = "thermicon"
REPORTED = ("numpy", "scipy", "pandas", "matplotlib", "numba", "pydantic", "typer", "jupyterlab", "ipywidgets")
"""Packages whose versions a report of a fault should state."""

EXTRAS = {
    "page": ("voila", "the workbench as a web page (lab --page)"),
    "hardware": ("npTDMS", "drives and logs in TDMS, the format of National Instruments"),
    "parquet": ("pyarrow", "traces in Parquet (simulate -o OUT.parquet)"),
    "cluster": ("distributed", "ranking on a dask cluster (rank --workers ADDRESS)"),
    "calibrate": ("emcee", "sampling the observer's constants again (python -m thermicon.perception.evidence)"),
    "study": ("questplus", "QUEST+ threshold runs in a study ([threshold])"),
}
"""The package that each extra brings, and what it is for; extras that only developers need are left out."""

PIP_ENDS_S = 120.0
"""Seconds after which pip is given up."""


def pip() -> str:
    """The words that run pip for the Python of this process, and not for another one.

    >>> pip().endswith("-m pip")
    True
    """
    python = f'"{sys.executable}"' if " " in sys.executable else sys.executable
    return f"{python} -m pip"


def check_python() -> Iterator[Finding]:
    """State the Python that runs, and on what."""
    text = f"{platform.python_version()} ({sys.executable}) on {platform.platform(terse=True)} {platform.machine()}"
    yield Finding("Python", "ok", text)


def check_program() -> Iterator[Finding]:
    """Look for the installed thermicon, for a second one, and for a folder that hides it."""
    here = Path(__file__).parents[1]
    installed = list(distributions(name=PROGRAM))
    if not installed:
        cure = f"in the folder of its pyproject.toml: {pip()} install -e ."
        yield Finding(PROGRAM, "fault", f"runs from {here}, but is not installed", cure)
        return
    hiding = hidden_by(str(here), installed_folders())
    if hiding is not None:
        what, _, cure = hiding.removeprefix("warning: ").partition("; ")
        yield Finding(PROGRAM, "fault", what, cure)
        return
    text = f"{installed[0].version} in {here}"
    places = sorted({str(each.locate_file("")) for each in installed})
    if len(places) > 1:
        cure = f"{pip()} uninstall {PROGRAM} until none is left, then install it once"
        yield Finding(PROGRAM, "note", f"{text}; installed {len(places)} times: {', '.join(places)}", cure)
    else:
        yield Finding(PROGRAM, "ok", text)


def check_required() -> Iterator[Finding]:
    """Say what ``pip check`` says: a misfit of thermicon is a fault, one between other packages of Python a note."""
    run = run_program([sys.executable, "-P", "-m", "pip", "check"], PIP_ENDS_S)
    misfits = run.stdout.splitlines() if run.returncode else []
    if run.returncode and not misfits:
        text = f"not compared with each other, since pip check says: {' '.join(run.stderr.split()) or 'nothing'}"
        yield Finding("packages", "note", text, f"{sys.executable} -m ensurepip, where pip is missing")
        return
    for misfit in misfits:
        state: State = "fault" if misfit.startswith(f"{PROGRAM} ") else "note"
        yield Finding("packages", state, misfit.rstrip("."), f"install it with {pip()} install")
    if not misfits:
        versions = ", ".join(f"{name} {there}" for name in REPORTED if (there := installed_version(name)))
        yield Finding("packages", "ok", f"every required package is there and fits the others ({versions})")


def check_extras() -> Iterator[Finding]:
    """Look which extras are installed."""
    for extra, (package, purpose) in EXTRAS.items():
        if installed_version(package) is not None:
            yield Finding(f"extra {extra}", "ok", f"for {purpose}")
        else:
            cure = f'{pip()} install "{PROGRAM}[{extra}]"'
            yield Finding(f"extra {extra}", "note", f"not installed, for {purpose}", cure)


def installed_version(name: str) -> str | None:
    """Return the version of an installed distribution, None where there is none.

    >>> installed_version("no-such-distribution") is None
    True
    """
    try:
        return version(name)
    except PackageNotFoundError:
        return None


ANSWERS_S = 10.0
"""Seconds after which a program that does not print its version is given up."""


@dataclass(frozen=True, slots=True)
class Program:
    """A program of the machine: its possible commands, what it is for, and how it is installed."""

    name: str
    commands: tuple[str, ...]
    purpose: str
    cures: dict[str, str]

    @property
    def cure(self) -> str:
        """How to install it on this kind of machine."""
        return self.cures.get(sys.platform, self.cures["linux"])


PROGRAMS = (
    Program(
        "ngspice",
        ("ngspice",),
        "running the netlists that simulate writes",
        {
            "linux": "sudo apt install ngspice, or the package of that name of your system",
            "darwin": "brew install ngspice",
            "win32": "install it from ngspice.sourceforge.io, or open netlists in LTspice",
        },
    ),
    Program(
        "C compiler",
        ("cc", "gcc", "clang", "cl"),
        "compiling the players that export writes as C arrays",
        {
            "linux": "sudo apt install gcc, or the package of that name of your system",
            "darwin": "xcode-select --install",
            "win32": "install the Build Tools for Visual Studio",
        },
    ),
    Program(
        "Chromium",
        ("chromium", "google-chrome", "chromium-browser", "chrome"),
        "the browser tests of developers; every browser shows the workbench and the reports",
        {
            "linux": "sudo apt install chromium, or the package of that name of your system",
            "darwin": "brew install --cask chromium",
            "win32": "install Chrome or Chromium",
        },
    ),
)


def check_programs() -> Iterator[Finding]:
    """Look for outside programs."""
    for program in PROGRAMS:
        path = next((found for command in program.commands if (found := shutil.which(command))), None)
        if path is None:
            text = f"not installed; only needed for {program.purpose}"
            yield Finding(program.name, "note", text, program.cure)
        else:
            yield Finding(program.name, "ok", f"{path}{version_of(path)}, for {program.purpose}")


def run_program(
    command: Sequence[str], longest_s: float, environment: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a program without input and return what it says; one that takes longer raises `subprocess.TimeoutExpired`."""
    return subprocess.run(
        command,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        stdin=subprocess.DEVNULL,
        timeout=longest_s,
        check=False,
        env=environment,
    )


def version_of(path: str) -> str:
    """Return what a program says of its own version, in brackets; nothing where it says nothing that helps."""
    if sys.platform == "win32":  # where a browser that is asked for its version opens a window
        return ""
    try:
        run = run_program([path, "--version"], ANSWERS_S)
    except (OSError, subprocess.SubprocessError):
        return ""
    lines = [line.strip(" *\t") for line in run.stdout.splitlines() if any(letter.isdigit() for letter in line)]
    return f" ({lines[0]})" if run.returncode == 0 and lines else ""
