"""The identity of the program that computed a result: its version and the digest of its files."""

import hashlib
import platform
import sys
from collections.abc import Iterator
from functools import lru_cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from importlib.resources.abc import Traversable

DRIVES = ("thermicon.base", "thermicon.icons", "thermicon.circuit")
"""Packages that determine the bytes of a drive and the verdict on it."""

SUFFIXES = (".py", ".toml", ".csv", ".lark")


@lru_cache(maxsize=4)
def code_digest(packages: tuple[str, ...] = DRIVES) -> str:
    """The SHA-256 of the version and of every source and data file of some packages."""
    digest = hashlib.sha256(own_version().encode("utf-8"))
    for package in packages:
        for name, content in _sources(files(package), ""):
            digest.update(name.encode("utf-8") + content)
    return digest.hexdigest()


def this_program() -> dict[str, str]:
    """The program as a sidecar states it: its version, and the digest of the code that computes drives."""
    return {"version": own_version(), "code_sha256": code_digest()}


def numerics() -> tuple[str, ...]:
    """What the last digits of a result depend on besides our code: Python, processor and numerical libraries."""
    tools = (f"{name} {import_module(name).__version__}" for name in ("numpy", "scipy", "numba", "llvmlite"))
    return (sys.version, platform.machine(), *tools)


def own_version() -> str:
    """Version of the package as installed."""
    try:
        return version("thermicon")
    except PackageNotFoundError:
        return "unknown"


def _sources(folder: Traversable, within: str) -> Iterator[tuple[str, bytes]]:
    """Name below a package and content of every file that determines the results, in all rooms and data folders."""
    for entry in sorted(folder.iterdir(), key=lambda one: one.name):
        name = f"{within}/{entry.name}"
        if entry.is_dir():
            yield from _sources(entry, name)
        elif entry.name.endswith(SUFFIXES):
            yield name, entry.read_bytes()
