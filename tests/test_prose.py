"""Sentences made once from objects and never read by code."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OTHERS = {ROOT / "perception/evidence/__main__.py", ROOT / "notebooks/cli/main.py"}
"""A command line of its own, and the words of Python and of the parser of the command line, which have no values."""
READING = {"startswith", "endswith", "removeprefix", "removesuffix", "split", "rsplit", "replace", "partition"}
WORDS, OPTION = re.compile(r"[^\W\d_]{2,},? [^\W\d_]{2,}"), re.compile(r"(?<![\w-])--[a-z]+")


def nodes(*folders: str, within: str = "") -> Iterator[tuple[Path, ast.AST]]:
    """Every node of every module of some folders, of those alone whose text has a pattern."""
    for path in (path for folder in folders for path in sorted((ROOT / folder).rglob("*.py")) if path not in OTHERS):
        if re.search(within, text := path.read_text(encoding="utf-8")):
            yield from ((path.relative_to(ROOT), node) for node in ast.walk(ast.parse(text)))


def text_of(node: ast.AST) -> str:
    return "".join(each.value for each in ast.walk(node) if isinstance(each, ast.Constant) and type(each.value) is str)


def test_no_code_reads_a_sentence() -> None:
    read = []
    for path, node in nodes("circuit", "perception", "notebooks"):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in READING:
            read += [(path, node.lineno, text_of(argument)) for argument in node.args[:1]]
        elif isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.In | ast.NotIn):
            read.append((path, node.lineno, text_of(node.left)))
    assert [each for each in read if WORDS.search(each[2])] == []


def test_no_sentence_below_notebooks_names_an_option() -> None:
    every = list(nodes("base", "icons", "circuit", "perception", within=OPTION.pattern))
    prose = {id(node.value) for _, node in every if isinstance(node, ast.Expr)}
    told = [(path, node) for path, node in every if isinstance(node, ast.Constant) and id(node) not in prose]
    assert [(path, node.lineno) for path, node in told if OPTION.search(text_of(node))] == []
