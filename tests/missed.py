"""Slips that no case of a module notices: each condition turned or fixed, each sum, product and text changed."""

import ast
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

Cases = Mapping[str, Callable[[Any], object]]
"""What a module says, by the name of the case; each is called with the module or with one that has a slip."""
SILENT = ("prepare_set",)
"""Functions that work and say nothing: their slips are not asked for."""
EXCHANGED: list[tuple[type[ast.AST], type[ast.AST]]] = [
    *((ast.Eq, ast.NotEq), (ast.Is, ast.IsNot), (ast.In, ast.NotIn), (ast.Lt, ast.GtE), (ast.LtE, ast.Gt)),
    *((ast.Mult, ast.Div), (ast.Add, ast.Sub)),
]
OPPOSITE = {**dict(EXCHANGED), **{second: first for first, second in EXCHANGED}}


def said(case: Callable[[Any], object], module: ModuleType) -> object:
    """What a case says, or the error instead."""
    try:
        return case(module)
    except Exception as fault:
        return repr(fault)


def missed(module: ModuleType, cases: Cases) -> list[str]:
    """The slips with which every case still says the same, as line and change."""
    expected = {name: said(case, module) for name, case in cases.items()}
    source = Path(str(module.__file__)).read_text(encoding="utf-8")
    unnoticed = []
    for line, change, tree in slips(ast.parse(source)):
        slipped = ModuleType(module.__name__)
        slipped.__package__ = module.__package__
        exec(compile(tree, str(module.__file__), "exec"), slipped.__dict__)
        if all(said(case, slipped) == expected[name] for name, case in cases.items()):
            unnoticed.append(f"{source.splitlines()[line - 1].strip()} ({change})")
    return unnoticed


def slips(tree: ast.Module) -> Iterator[tuple[int, str, ast.Module]]:
    """Line, change and the text with it for each slip; the text is as it was when the next one is asked for."""
    left = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and node.name in SILENT]
    left += [node for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)]
    without = {id(inside) for node in left for inside in ast.walk(node)}
    deciding = [node.value for node in tree.body if isinstance(node, ast.Assign)]
    deciding += [number for node in ast.walk(tree) if isinstance(node, ast.Compare) for number in node.comparators]
    numbers = {id(number) for node in deciding for number in ast.walk(node)}
    for node in [node for node in ast.walk(tree) if id(node) not in without]:
        for name, field, value in changes(node, id(node) in numbers):
            before = getattr(node, field)
            setattr(node, field, value)
            yield node.lineno if hasattr(node, "lineno") else node.iter.lineno, name, ast.fix_missing_locations(tree)
            setattr(node, field, before)


def changes(node: ast.AST, decides: bool) -> Iterator[tuple[str, str, object]]:
    """Slips of one node: name, field and another value; a number that decides is moved by one or by a fiftieth."""
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        yield "turned", "ops", [OPPOSITE[type(node.ops[0])]()]
    elif isinstance(node, ast.BinOp) and type(node.op) in OPPOSITE:
        yield "exchanged", "op", OPPOSITE[type(node.op)]()
    elif isinstance(node, ast.If | ast.IfExp) and getattr(node.test, "id", "") != "TYPE_CHECKING":
        yield "always", "test", ast.Constant(True)
        yield "never", "test", ast.Constant(False)
    elif isinstance(node, ast.BoolOp):
        if not isinstance(node.values[-1], ast.Constant):  # "or 0.0", which types ask for
            yield "without the last", "values", node.values[:-1] * 2
        yield "without the first", "values", node.values[1:] * 2
    elif isinstance(node, ast.comprehension) and node.ifs:
        yield "unfiltered", "ifs", []
    elif isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value.strip():
        yield "unsaid", "value", "·"
    elif isinstance(node, ast.Constant) and decides and type(node.value) in (int, float) and node.value:
        step = 1 if isinstance(node.value, int) else 0.02 * node.value
        yield "more", "value", node.value + step
        yield "less", "value", node.value - step
