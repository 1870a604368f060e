"""Limits, tolerances and thresholds of the product stand in `numbers.toml` too: one that slips is noticed by every run.

A number that decides something is changed in both places, on purpose; ``python tests/test_numbers.py`` writes the
table.
"""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TABLE = ROOT / "tests" / "numbers.toml"
PACKAGES = ("icons", "circuit", "perception", "notebooks")
ARITHMETIC = (ast.Constant, ast.UnaryOp, ast.BinOp, ast.Tuple, ast.operator, ast.unaryop, ast.expr_context)

Number = int | float
Value = Number | list[Number]


def number_of(node: ast.expr) -> Value | None:
    """The value of an expression of numbers alone, a tuple of them as a list; None for anything else."""
    inside = list(ast.walk(node))
    if not all(isinstance(each, ARITHMETIC) for each in inside):
        return None
    if any(isinstance(each, ast.Constant) and type(each.value) not in (int, float) for each in inside):
        return None
    value = eval(compile(ast.Expression(node), "number", "eval"), {"__builtins__": {}})
    if isinstance(value, tuple):
        return [float(each) for each in value] if value and all(type(each) is not tuple for each in value) else None
    return value if isinstance(value, int | float) else None


def numbers() -> Iterator[tuple[str, str, Value]]:
    """Room, name and value of each number that a module of the product names in capitals."""
    for path in sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py")):
        room = path.parent.relative_to(ROOT).as_posix()
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", None)
            if isinstance(target, ast.Name) and target.id.isupper() and isinstance(node, ast.Assign | ast.AnnAssign):
                value = None if node.value is None else number_of(node.value)
                if value is not None:
                    yield room, target.id, value


def table() -> dict[str, dict[str, list[Value]]]:
    """Values by room and name; a name that stands in two modules of a room has two."""
    rooms: dict[str, dict[str, list[Value]]] = {}
    for room, name, value in numbers():
        rooms.setdefault(room, {}).setdefault(name, []).append(value)
    return {room: {name: sorted(values, key=str) for name, values in names.items()} for room, names in rooms.items()}


def test_every_number_that_decides_is_the_one_on_record() -> None:
    recorded, found = tomllib.loads(TABLE.read_text(encoding="utf-8")), table()
    assert sum(map(len, found.values())) > 150
    for room in sorted({*recorded, *found}):
        assert found.get(room, {}) == recorded.get(room, {}), (
            f"{room}: run python tests/test_numbers.py if this is meant"
        )


if __name__ == "__main__":
    lines = ["# Numbers that decide something, by room; written by test_numbers.py.", ""]
    for room, names in sorted(table().items()):
        lines += [f'["{room}"]', *(f"{name} = {values!r}" for name, values in sorted(names.items())), ""]
    TABLE.write_text("\n".join(lines[:-1]) + "\n", encoding="utf-8")
