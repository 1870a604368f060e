"""Checks of the installed distributions: Python, thermicon itself, what it requires, and its extras.

Everything is read from the metadata of distributions, so that nothing that may be broken has to be imported.
"""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution, distributions, version
from pathlib import Path
from typing import TYPE_CHECKING

from ..startup import hidden_by, installed_folders
from .finding import Finding

if TYPE_CHECKING:
    from packaging.requirements import Requirement

PROGRAM = "thermicon"
REPORTED = ("numpy", "scipy", "pandas", "matplotlib", "numba", "pydantic", "typer", "jupyterlab", "ipywidgets")
"""Packages whose versions a report of a fault should state."""

EXTRAS = {
    "page": "the workbench as a web page (lab --page)",
    "hardware": "drives and logs in TDMS, the format of National Instruments",
    "parquet": "traces in Parquet (simulate -o OUT.parquet)",
    "cluster": "ranking on a dask cluster (rank --cluster)",
    "calibrate": "sampling the observer's constants again (calibrate)",
    "study": "QUEST+ threshold runs in a study ([threshold])",
}
"""What each extra is for; extras that only developers need are left out."""


@dataclass(frozen=True, slots=True)
class Unmet:
    """A requirement that the installed packages do not meet; ``installed`` is None where the package is missing."""

    by: str
    requirement: Requirement
    installed: str | None

    @property
    def text(self) -> str:
        """What is needed, by what, and what is there."""
        there = "not installed" if self.installed is None else f"{self.installed} is installed"
        return f"{self.by} needs {self.requirement.name}{self.requirement.specifier}, {there}"

    @property
    def cure(self) -> str:
        """The command that installs what is needed."""
        return f'{pip()} install "{self.requirement.name}{self.requirement.specifier}"'


def pip() -> str:
    """The words that run pip for the Python of this process, and not for another one.

    >>> pip().endswith("-m pip")
    True
    """
    python = f'"{sys.executable}"' if " " in sys.executable else sys.executable
    return f"{python} -m pip"


def check_python() -> Iterator[Finding]:
    """Compare the version of Python with the one that thermicon requires."""
    running = platform.python_version()
    text = f"{running} ({sys.executable}) on {platform.platform(terse=True)} {platform.machine()}"
    from packaging.specifiers import SpecifierSet

    metadata = distribution(PROGRAM).metadata
    required = metadata["Requires-Python"] if "Requires-Python" in metadata else ""  # noqa: SIM401
    if not SpecifierSet(required).contains(running, prereleases=True):
        cure = f"make an environment with a Python {required} and install thermicon there"
        yield Finding("Python", "fault", f"{text}, but thermicon requires {required}", cure)
    else:
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
    """Compare every installed package that thermicon requires, directly or not, with what is asked of it."""
    misfits = list(unmet(PROGRAM))
    for misfit in misfits:
        yield Finding("packages", "fault", misfit.text, misfit.cure)
    if not misfits:
        versions = ", ".join(f"{name} {there}" for name in REPORTED if (there := installed_version(name)))
        yield Finding("packages", "ok", f"every required package is there and fits the others ({versions})")


def check_extras() -> Iterator[Finding]:
    """Look which extras are installed."""
    for extra, purpose in EXTRAS.items():
        misfits = list(unmet(PROGRAM, extra))
        text = f"for {purpose}"
        if not misfits:
            yield Finding(f"extra {extra}", "ok", text)
            continue
        missing = "not installed" if misfits[0].installed is None else misfits[0].text
        yield Finding(f"extra {extra}", "note", f"{missing}, {text}", f'{pip()} install "{PROGRAM}[{extra}]"')


def unmet(name: str, extra: str = "") -> Iterator[Unmet]:
    """Walk the requirements of a distribution down to the last, and give those that are not met.

    With an extra, only the requirements of that extra are walked.

    Parameters
    ----------
    name
        An installed distribution.
    extra
        The name of one of its extras.

    Yields
    ------
    Unmet
        Each requirement that is not met once, in the order of the walk.

    Raises
    ------
    importlib.metadata.PackageNotFoundError
        Where the distribution itself is not installed.

    """
    seen: set[str] = set()
    waiting = [(name, each) for each in requirements(name, extra)]
    while waiting:
        by, requirement = waiting.pop(0)
        asked = str(requirement)
        if asked in seen:
            continue
        seen.add(asked)
        installed = installed_version(requirement.name)
        if installed is None or not requirement.specifier.contains(installed, prereleases=True):
            yield Unmet(by, requirement, installed)
        if installed is not None:
            for part in ("", *sorted(requirement.extras)):
                waiting += [(requirement.name, each) for each in requirements(requirement.name, part)]


def requirements(name: str, extra: str) -> list[Requirement]:
    """Return what a distribution requires on this machine: without any extra, or for one extra alone."""
    from packaging.requirements import Requirement

    listed = [Requirement(text) for text in distribution(name).requires or ()]
    always = [each for each in listed if each.marker is None or each.marker.evaluate({"extra": ""})]
    if not extra:
        return always
    return [each for each in listed if each not in always and each.marker and each.marker.evaluate({"extra": extra})]


def installed_version(name: str) -> str | None:
    """Return the version of an installed distribution, None where there is none.

    >>> installed_version("no-such-distribution") is None
    True
    """
    try:
        return version(name)
    except PackageNotFoundError:
        return None
