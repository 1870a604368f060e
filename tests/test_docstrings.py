"""Every public name of the four packages has a numpydoc docstring that agrees with its signature."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator
from typing import Any

import pytest

PACKAGES = ("icons", "circuit", "perception", "notebooks")
SECTIONS = ("Parameters", "Attributes", "Returns", "Yields", "Raises", "See Also", "Notes", "References", "Examples")
"""The sections of numpydoc that we use, in its order."""

UNITS = {
    "_s": "s",
    "_K": "K",
    "_C": "°C",
    "_A": "A",
    "_V": "V",
    "_J": "J",
    "_m": "m",
    "_m2": "m²",
    "_Hz": "(?:Hz|per second)",
    "_W_per_m2": "W/m²",
    "_A_per_V": "A/V",
    "_K_per_s": "K/s",
}
"""Endings of names, and the unit that the description must name."""


def public() -> list[tuple[str, str]]:
    """Package and name of everything at the front doors that can be called."""
    names = []
    for package in PACKAGES:
        module = importlib.import_module(f"thermicon.{package}")
        names += [(package, name) for name in module.__all__ if callable(getattr(module, name))]
    return names


def sections_of(doc: str) -> dict[str, list[str]]:
    """Lines of each section of a docstring; those before the first section are under an empty name."""
    lines = inspect.cleandoc(doc).split("\n")
    sections: dict[str, list[str]] = {"": []}
    title = ""
    for place, line in enumerate(lines):
        following = lines[place + 1] if place + 1 < len(lines) else ""
        if line and following == "-" * len(line):
            title = line
            sections[title] = []
        elif not (line and set(line) == {"-"}):
            sections[title].append(line)
    return sections


def entries_of(lines: list[str]) -> dict[str, str]:
    """Description of each entry of a section: `a, b : type` and indented lines below describe both `a` and `b`."""
    entries: dict[str, str] = {}
    names: list[str] = []
    for line in lines:
        if line and not line.startswith(" "):
            heading, _, kind = line.partition(" : ")
            names = [name.strip().lstrip("*") for name in heading.split(",")]
            entries |= dict.fromkeys(names, kind)
        for name in names if line.startswith(" ") else []:
            entries[name] += f" {line.strip()}"
    return entries


def arguments_of(thing: Any) -> list[str]:
    """Names that a docstring must describe, in order; none for an exception that takes only texts."""
    if inspect.isclass(thing) and issubclass(thing, BaseException) and "__init__" not in vars(thing):
        return []
    parameters = list(inspect.signature(thing).parameters.values())
    if inspect.isclass(thing) and issubclass(thing, BaseException):
        parameters = [one for one in parameters if one.kind is not one.VAR_POSITIONAL]
    return [one.name for one in parameters]


def exceptions(base: type[BaseException]) -> Iterator[type[BaseException]]:
    """Every exception of a kind that is loaded, ours and Python's."""
    for kind in base.__subclasses__():
        yield kind
        yield from exceptions(kind)


def missing_of(thing: Any) -> list[str]:
    """What a docstring lacks or says that is not so, a sentence each."""
    doc = inspect.getdoc(thing) or ""
    if not doc or (inspect.isclass(thing) and not thing.__doc__):
        return ["there is no docstring"]
    sections, wrong = sections_of(doc), []
    summary = sections[""][0]
    if not summary.endswith(".") or (len(sections[""]) > 1 and sections[""][1]):
        wrong.append("the summary is not one line that ends with a full stop")
    titles = [title for title in sections if title]
    if titles != sorted(titles, key=SECTIONS.index):
        wrong.append(f"the sections are out of order: {', '.join(titles)}")
    described = entries_of(sections.get("Parameters", [])) | entries_of(sections.get("Attributes", []))
    expected = arguments_of(thing)
    if list(described) != expected:
        wrong.append(f"described are {list(described)}, the signature has {expected}")
    for name, text in described.items():
        if not text.strip():
            wrong.append(f"{name} has no description")
        ending = max((end for end in UNITS if name.endswith(end)), key=len, default=None)
        if ending and not re.search(rf"(?<![\w°/]){UNITS[ending]}(?![\w°])", text):
            wrong.append(f"{name} is described without its unit, {UNITS[ending]}")
    nothing = inspect.isclass(thing) or inspect.signature(thing).return_annotation in (None, "None")
    if not nothing and not {"Returns", "Yields"} & set(titles):
        wrong.append("there is no section Returns")
    prose = " ".join(line for title, lines in sections.items() if title != "Examples" for line in lines)
    if re.search(r"\b[Rr]aises\b", prose):
        wrong.append("errors are in the prose, not in a section Raises")
    known = {kind.__name__ for kind in exceptions(BaseException)}
    for name in entries_of(sections.get("Raises", [])):
        if name not in known:
            wrong.append(f"the section Raises names {name}, which is no exception")
    returned = inspect.isclass(thing) and "See Also" in titles
    if ">>> " not in "\n".join(sections.get("Examples", [])) and not returned:
        wrong.append("there is no example, nor a reference to the function that returns it")
    return wrong


@pytest.mark.parametrize(("package", "name"), public())
def test_docstring_is_complete(package: str, name: str) -> None:
    wrong = missing_of(getattr(importlib.import_module(f"thermicon.{package}"), name))
    assert not wrong, f"thermicon.{package}.{name}: " + "; ".join(wrong)


@pytest.mark.parametrize(
    ("doc", "fault"),
    [
        ("", "no docstring"),
        ("Add\ntwo.", "summary"),
        ("Add.\n\nRaises ValueError.", "prose"),
        ("Add.\n\nParameters\n----------\nb\n    Other.", "described are"),
        ("Add.\n\nParameters\n----------\na_s\n    A time.", "without its unit"),
        ("Add.\n\nRaises\n------\nNoSuchError\n    Never.", "no exception"),
        ("Add.\n\nExamples\n--------\n>>> 1\n1\n\nReturns\n-------\nint\n    It.", "out of order"),
    ],
)
def test_the_check_sees_a_fault(doc: str, fault: str) -> None:
    def add(a_s: float) -> float:
        return a_s

    add.__doc__ = doc
    assert any(fault in text for text in missing_of(add))
