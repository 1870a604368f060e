"""The numbers of a release beside the budget: ``python tests/count.py`` prints them and warns where one is above.

Lines are counted room by room. Density is a count in 1,000 lines, or per cent where it says so.
"""

import ast
import re
import tomllib
from collections import Counter
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = {"product": ("icons", "circuit", "perception", "notebooks", "thermicon", "docs", ".ci"), "tests": ("tests",)}
CODE = {"product": (".py", ".py.txt"), "tests": (".py", ".toml", ".csv", ".cue", ".c", ".json", ".txt")}
"""Endings of what counts: tests with their data, but not the reference data of others."""
BUDGET = tomllib.loads((ROOT / "tests" / "budget.toml").read_text(encoding="utf-8"))
FILLERS = {"found", "each", "what", "one", "own", "made", "said"}
COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


@dataclass(frozen=True, slots=True)
class Room:
    """A folder with the lines and the number of files in it."""

    name: str
    lines: int
    files: int


def _files(part: str) -> list[Path]:
    paths = (path for folder in FOLDERS[part] for path in sorted((ROOT / folder).rglob("*")))
    return [path for path in paths if path.is_file() and path.name.endswith(CODE[part]) and "build" not in path.parts]


def rooms(part: str) -> list[Room]:
    """The rooms of the product or of the tests."""
    lines: Counter[str] = Counter()
    files: Counter[str] = Counter()
    for path in _files(part):
        room = path.parent.relative_to(ROOT).as_posix()
        lines[room] += len(path.read_text(encoding="utf-8").splitlines())
        files[room] += 1
    return [Room(name, lines[name], files[name]) for name in sorted(lines)]


def words_of_docs() -> int:
    """Words are what holds a letter or a digit, but for comments; what the site's build makes is not in the pages."""
    pages = (re.sub("<!--.*?-->", "", path.read_text("utf-8")) for path in (ROOT / "docs").rglob("*.md"))
    return sum(bool(re.search(r"\w", word)) for page in pages for word in page.split())


def density() -> dict[str, float]:
    """How densely the product is written: rows of the budget's table of this name."""
    counts = Counter(dict.fromkeys(BUDGET["density"], 0))
    lines = names = fillers = 0
    for path in _files("product"):
        if path.suffix == ".py":
            text = path.read_text(encoding="utf-8")
            lines += len(text.splitlines())
            tree = ast.parse(text)
            nodes = list(ast.walk(tree))
            first_line = (ast.get_docstring(tree) or "").partition("\n")[0]
            counts["lists_without_and"] += "," in first_line and not re.search(r"\b(and|or)\b", first_line)
            tuples = [node for node in nodes if isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple)]
            packed = {node.targets[0].id for node in tuples if isinstance(node.targets[0], ast.Name)}
            counts["pairs_assigned"] += sum(isinstance(node.targets[0], ast.Tuple) for node in tuples)
            for node in nodes:
                if isinstance(node, ast.Call):
                    starred = [argument.value for argument in node.args if isinstance(argument, ast.Starred)]
                    counts["arguments_packed"] += sum(getattr(value, "id", None) in packed for value in starred)
                counts["walrus"] += isinstance(node, ast.NamedExpr)
                counts["double_comprehensions"] += isinstance(node, COMPREHENSIONS) and len(node.generators) > 1
                if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                    names += 1
                    fillers += node.id in FILLERS
    rows = {name: count * 1000 / lines for name, count in counts.items()}
    return {
        **rows,
        "lists_without_and": counts["lists_without_and"],
        "filler_names_percent": 100 * fillers / names,
    }


def report(name: str, number: float, budget: float) -> None:
    """A number of a release with a warning where it is above the budget."""
    warning = f"  ABOVE THE BUDGET of {budget:,}" if round(number, 2) > budget else ""
    print(f"{round(number, 2):10,}  {name}{warning}")


def options() -> dict[str, int]:
    """Number of options of each command; what has no dashes is an argument."""
    from typer.main import get_command

    from thermicon.notebooks.cli.main import app

    commands = get_command(app).commands
    return {
        name: sum(parameter.opts[0].startswith("-") for parameter in command.params)
        for name, command in commands.items()
    }


def main() -> None:
    """Print lines, density, words, modules that journeys enter, public names and options."""
    from test_journeys import SCRIPTS, modules_entered

    for part in FOLDERS:
        counted = rooms(part)
        for room in counted:
            print(f"{room.lines:7,} {room.files:4}  {room.name}")
        report(part, sum(room.lines for room in counted), BUDGET["lines"][part])
    for name, number in density().items():
        report(name, number, BUDGET["density"][name])
    report("words of docs", words_of_docs(), BUDGET["docs_words"])
    for name in SCRIPTS:
        report(f"modules entered: {name}", len(modules_entered(name)), BUDGET["journeys"][name])
    for package in ("icons", "circuit", "perception", "notebooks"):
        print(f"{len(import_module(f'thermicon.{package}').__all__):10}  names in thermicon.{package}")
    print("options:", ", ".join(f"{name} {number}" for name, number in options().items()))


if __name__ == "__main__":
    main()
