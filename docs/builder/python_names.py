"""Pages of the Python API from its docstrings."""

from __future__ import annotations

import ast
import inspect
from collections import Counter
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

from command_options import plain

PACKAGES = {
    "icons": "cue text and builders to icons",
    "circuit": "icons to drive current, temperatures and files for hardware",
    "perception": "temperatures to sensations, confusions and rankings",
    "notebooks": "figures and the workbench",
}


def python_pages() -> Iterator[tuple[str, str]]:
    """Yield the page of each package, as name and Markdown."""
    for package in PACKAGES:
        yield f"reference/python-{package}.md", "\n".join(_page(package))


def python_index() -> str:
    """Return links to the pages of the four packages, and the toctree that holds them."""
    lines = [f"- [`thermicon.{package}`](python-{package}.md): {what}" for package, what in PACKAGES.items()]
    tree = ["```{toctree}", ":hidden:", "", *(f"python-{package}" for package in PACKAGES), "```"]
    return "\n".join([*lines, "", *tree, ""])


def _page(package: str) -> Iterator[str]:
    module = import_module(f"thermicon.{package}")
    yield f"# `thermicon.{package}`\n"
    yield f"{(module.__doc__ or '').strip()}\n"
    seen: Counter[str] = Counter()
    rooms = listed(module)
    for room, names in rooms.items():
        yield f"| {room} | what it is |\n|---|---|"
        for name in names:
            slug = name.lower() + (f"-{seen[name.lower()]}" if seen[name.lower()] else "")
            seen[name.lower()] += 1
            value = getattr(module, name)
            summary = (inspect.getdoc(value) or "").partition("\n")[0] if callable(value) else ""
            yield f"| [`{name}`](#{slug}) | {plain(summary)} |"
        yield ""
    for name in (name for names in rooms.values() for name in names):
        value = getattr(module, name)
        kind = "class" if isinstance(value, type) else "function" if callable(value) else "data"
        kind = "exception" if isinstance(value, type) and issubclass(value, BaseException) else kind
        members = "\n   :members:" if kind == "class" else ""
        yield f"## `{name}`\n\n```{{eval-rst}}\n.. auto{kind}:: thermicon.{package}.{name}{members}\n```\n"


def listed(module: ModuleType) -> dict[str, list[str]]:
    """Return the public names of a package by the room that they come from, in the order of the flow."""
    tree = ast.parse(Path(str(module.__file__)).with_suffix(".pyi").read_text(encoding="utf-8"))
    rooms: dict[str, list[str]] = {}
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.module:
            rooms.setdefault(node.module.partition(".")[0], []).extend(alias.name for alias in node.names)
    return rooms
