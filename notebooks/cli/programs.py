"""Checks of programs that pip does not install; thermicon itself runs without any of them."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from .finding import Finding

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
        "running what netlist writes",
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
