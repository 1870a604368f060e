"""Docstrings of all public names: numpydoc form, with every argument and its unit."""

import importlib
import inspect
import re
from collections.abc import Iterator

import pytest
from numpydoc.docscrape import NumpyDocString
from numpydoc.validate import get_doc_object, validate

PACKAGES = ("icons", "circuit", "perception", "notebooks")
ASKED = {"GL07", "GL08", "PR01", "PR02", "PR03", "PR07", "RT01", "EX01", "SS03"}
"""Of numpydoc's checks: order of sections, arguments of the signature, descriptions, returns, examples, a full stop."""
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


def public() -> list[str]:
    """Import names of everything at the front doors that can be called."""
    modules = [importlib.import_module(f"thermicon.{package}") for package in PACKAGES]
    return [
        f"{module.__name__}.{name}" for module in modules for name in module.__all__ if callable(getattr(module, name))
    ]


def described(docstring: NumpyDocString) -> Iterator[tuple[str, str]]:
    """Every argument and attribute with what is said of it: `a, b` describes both."""
    for entry in (*docstring["Parameters"], *docstring["Attributes"]):
        yield from (
            (name.strip().lstrip("*"), f"{entry.type} {' '.join(entry.desc)}") for name in entry.name.split(",")
        )


def faults_of(name: str) -> list[str]:
    """What the docstring of a public name lacks, a sentence each."""
    package, _, thing = name.rpartition(".")
    value = getattr(importlib.import_module(package), thing)
    docstring = NumpyDocString(inspect.getdoc(value) or "")
    excused = {"EX01"} if docstring["See Also"] else set()  # the function that returns it has the example
    if inspect.isclass(value):
        names = [] if issubclass(value, BaseException) else list(inspect.signature(value).parameters)
        excused |= {"PR01"} if not names or names == [name for name, _ in described(docstring)] else set()
    found = [text for code, text in validate(get_doc_object(value))["errors"] if code in ASKED - excused]
    for argument, text in described(docstring):
        ending = max((end for end in UNITS if argument.endswith(end)), key=len, default="")
        if ending and not re.search(rf"(?<![\w°/]){UNITS[ending]}(?![\w°])", text):
            found.append(f"{argument} is described without its unit, {UNITS[ending]}")
    return found


@pytest.mark.parametrize("name", public())
def test_a_docstring_is_complete(name: str) -> None:
    assert faults_of(name) == []


@pytest.mark.parametrize(
    ("doc", "fault"),
    [
        ("", "does not have a docstring"),
        ("Cool for a while.\n\nParameters\n----------\na_s\n    A time.\nb\n    More.", "without its unit, s"),
        ("Cool for a while\n", "period"),
        ("Cool for a while.\n\nParameters\n----------\nb\n    Other.", "not documented"),
        ("Cool for a while.\n", "No examples section found"),
    ],
)
def test_a_fault_is_seen(doc: str, fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def cool(a_s: float, b: float) -> float:
        return a_s + b

    cool.__doc__ = doc
    monkeypatch.setattr("thermicon.icons.cool", cool)
    assert any(fault in text for text in faults_of("thermicon.icons.cool"))
