"""What a benchmark ran on: processor, cores, load, system and versions."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from thermicon.circuit.cores import available
from thermicon.circuit.program import own_version

from .peers import find_ngspice, ngspice_version

PACKAGES = ("numpy", "scipy", "numba", "llvmlite")


def machine_facts() -> tuple[tuple[str, str], ...]:
    """Return names and values of everything that a time depends on."""
    program = find_ngspice()
    return (
        ("processor", f"{processor()}, {available()} cores"),
        ("load before the run", load()),
        ("system", f"{platform.system()} {platform.release()}, Python {platform.python_version()}"),
        ("thermicon", own_version()),
        *((name, _version(name)) for name in PACKAGES),
        ("ngspice", "not installed" if program is None else ngspice_version(program)),
    )


def processor() -> str:
    """Name of the processor, as the system states it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    named = next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
    return named or platform.processor() or platform.machine()


def load() -> str:
    """How many programs ran on average over the last minute: what others take is missing here."""
    try:
        return f"{os.getloadavg()[0]:.1f} programs on average over a minute"
    except (AttributeError, OSError):
        return "not known"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
