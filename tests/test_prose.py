"""Sentences are made once, of objects, and read by people alone; only notebooks know what an option is called."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
BELOW = ("icons", "circuit", "perception")
READING = {"startswith", "endswith", "removeprefix", "removesuffix", "split", "rsplit", "replace", "partition"}
WORDS = re.compile(r"[^\W\d_]{2,},? [^\W\d_]{2,}")
OPTION = re.compile(r"(?<![\w-])--[a-z]+")


OTHERS = {ROOT / "perception/evidence/__main__.py", ROOT / "notebooks/cli/main.py"}
"""A command line of its own, and the words of Python and of the parser of the command line, which have no values."""


def modules(*folders: str) -> list[Path]:
    """Modules of these folders."""
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py")) if path not in OTHERS]


def texts(node: ast.AST) -> Iterator[str]:
    """Literal texts below a node, and the literal parts of those with values."""
    yield from (each.value for each in ast.walk(node) if isinstance(each, ast.Constant) and isinstance(each.value, str))


def test_no_code_reads_a_sentence() -> None:
    """What a caller needs of a message is a value beside it."""
    wrong = []
    for path in modules("circuit", "perception", "notebooks"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            read: list[ast.expr] = []
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in READING:
                read = node.args[:1]
            elif isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.In | ast.NotIn):
                read = [node.left]
            wrong += [f"{path.relative_to(ROOT)}:{node.lineno} {text!r}" for each in read for text in texts(each)
                      if WORDS.search(text)]  # fmt: skip
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("package", BELOW)
def test_no_sentence_below_notebooks_names_an_option(package: str) -> None:
    wrong = []
    for path in modules(package):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        prose = {ast.get_docstring(node, clean=False) for node in ast.walk(tree)
                 if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)}  # fmt: skip
        wrong += [f"{path.relative_to(ROOT)} {text!r}" for text in texts(tree)
                  if OPTION.search(text) and text not in prose]  # fmt: skip
    assert not wrong, "\n".join(wrong)
