"""Checks of the installed distributions: Python, thermicon itself, what it requires by ``pip check``, and its extras.

Nothing that may be broken is imported.
"""

from __future__ import annotations

import platform
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distributions, version
from pathlib import Path
from typing import Literal, get_args

from ..startup import hidden_by, installed_folders

PROGRAM = "thermicon"
REPORTED = ("numpy", "scipy", "pandas", "matplotlib", "numba", "pydantic", "typer", "jupyterlab", "ipywidgets")
"""Packages whose versions a report of a fault should state."""

EXTRAS = {
    "page": ("voila", "the workbench as a web page (lab --page)"),
    "hardware": ("npTDMS", "drives and logs in TDMS, the format of National Instruments"),
    "parquet": ("pyarrow", "traces in Parquet (simulate -o OUT.parquet)"),
    "cluster": ("distributed", "ranking on a dask cluster (rank --workers ADDRESS)"),
    "calibrate": ("emcee", "sampling the constants of the observer again (python -m thermicon.perception.evidence)"),
    "study": ("questplus", "QUEST+ threshold runs in a study ([threshold])"),
}
"""The package that each extra brings, and what it is for; extras that only developers need are left out."""

PIP_ENDS_S = 120.0
"""Seconds after which pip is given up."""
State = Literal["ok", "note", "fault"]
"""A note costs something that can be done without; a fault keeps thermicon from working or from being right."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What a check found: one sentence without a full stop, and the cure exactly where the state is not ``ok``.

    >>> print(Finding("voila", "note", "not installed", 'pip install "thermicon[page]"').line)
    note   voila: not installed; pip install "thermicon[page]"
    """

    check: str
    state: State
    text: str
    cure: str | None = None

    def __post_init__(self) -> None:
        if self.state not in get_args(State):
            raise ValueError(f"state {self.state!r} is not one of {', '.join(get_args(State))}")
        if "\n" in f"{self.text}{self.cure}":
            raise ValueError(f"{self.check}: a finding is one line")
        if (self.cure is None) != (self.state == "ok"):
            raise ValueError(f"{self.check}: {self.state} {'without' if self.cure is None else 'with'} a cure")

    @property
    def line(self) -> str:
        """The finding as one line of text."""
        cure = "" if self.cure is None else f"; {self.cure}"
        return readable(f"{self.state:<5}  {self.check}: {self.text}{cure}")

    def to_dict(self) -> dict[str, str | None]:
        """The finding as plain data, for JSON."""
        cure = None if self.cure is None else readable(self.cure)
        return {"check": self.check, "state": self.state, "text": readable(self.text), "cure": cure}


def readable(text: str) -> str:
    """Return text with the letters of paths that Python read without knowing their encoding, as with LC_ALL=C.

    >>> readable("/home/Gr\\udcc3\\udcb6")
    '/home/Grö'
    """
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def first_line(error: BaseException) -> str:
    """Return the kind of an error and the first line of its text.

    >>> first_line(ImportError("no module\\nmore words"))
    'ImportError: no module'
    """
    words = str(error).strip().splitlines()
    return f"{type(error).__name__}: {words[0].strip()}" if words else type(error).__name__


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
