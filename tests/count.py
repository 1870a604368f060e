"""The numbers of a release beside the budget: ``python tests/count.py`` prints them and warns where one is above.

Lines are counted room by room. Density is a count in 1,000 lines, or per cent where it says so.
"""

import ast
import re
import tomllib
from collections import Counter
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = {
    "product": ("base", "icons", "circuit", "perception", "notebooks", "thermicon", "docs", ".ci"),
    "tests": ("tests",),
}
CODE = {"product": (".py",), "tests": (".py", ".toml", ".csv", ".cue", ".c", ".json", ".txt")}
"""Endings of what counts: tests with their data, but not the reference data of others."""
BUDGET = tomllib.loads((ROOT / "tests" / "budget.toml").read_text(encoding="utf-8"))
FILLERS = {"found", "each", "what", "one", "own", "made", "said"}


def _texts(part: str) -> dict[Path, str]:
    paths = [path for folder in FOLDERS[part] for path in sorted((ROOT / folder).rglob("*")) if path.is_file()]
    counted = [path for path in paths if path.name.endswith(CODE[part]) and "build" not in path.parts]
    return {path: path.read_text(encoding="utf-8") for path in counted}


def rooms(part: str) -> dict[str, list[int]]:
    """Lines of each file in the rooms of the product or of the tests."""
    lines: dict[str, list[int]] = {}
    for path, text in _texts(part).items():
        lines.setdefault(path.parent.relative_to(ROOT).as_posix(), []).append(len(text.splitlines()))
    return dict(sorted(lines.items()))


def words_of_docs() -> int:
    """Words are what holds a letter or a digit, but for comments; what the site's build makes is not in the pages."""
    pages = (re.sub("<!--.*?-->", "", path.read_text("utf-8")) for path in (ROOT / "docs").rglob("*.md"))
    return sum(bool(re.search(r"\w", word)) for page in pages for word in page.split())


def dense(tree: ast.Module) -> Iterator[str]:
    """What a module counts for in the budget's table of density, and its stored names."""
    first_line = (ast.get_docstring(tree) or "").partition("\n")[0]
    if "," in first_line and not re.search(r"\b(and|or)\b", first_line):
        yield "lists_without_and"
    packed, starred = set(), []
    for node in ast.walk(tree):
        match node:
            case ast.Assign(targets=[ast.Name(id=name), *_], value=ast.Tuple()):
                packed.add(name)
            case ast.Assign(targets=[ast.Tuple(), *_], value=ast.Tuple()):
                yield "pairs_assigned"
            case ast.Call(args=arguments):
                starred += [argument.value for argument in arguments if isinstance(argument, ast.Starred)]
            case ast.NamedExpr():
                yield "walrus"
            case ast.Name(id=name, ctx=ast.Store()):
                yield "fillers" if name in FILLERS else "names"
        if len(getattr(node, "generators", ())) > 1:
            yield "double_comprehensions"
    yield from ("arguments_packed" for value in starred if isinstance(value, ast.Name) and value.id in packed)


def density() -> dict[str, float]:
    """How densely the product is written: rows of the budget's table of this name."""
    texts = [text for path, text in _texts("product").items() if path.suffix == ".py"]
    counts = Counter(row for text in texts for row in dense(ast.parse(text)))
    lines = sum(len(text.splitlines()) for text in texts)
    rows = {name: counts[name] * 1000 / lines for name in BUDGET["density"]}
    percent = 100 * counts["fillers"] / (counts["names"] + counts["fillers"])
    return {**rows, "lists_without_and": counts["lists_without_and"], "filler_names_percent": percent}


def report(name: str, number: float, budget: float) -> None:
    """A number of a release with a warning where it is above the budget."""
    warning = f"  ABOVE THE BUDGET of {budget:,}" if round(number, 2) > budget else ""
    print(f"{round(number, 2):10,}  {name}{warning}")


def main() -> None:
    """Print lines, density, words, modules that journeys enter, public names and options."""
    from test_journeys import SCRIPTS, modules_entered
    from typer.main import get_command

    from thermicon.notebooks.cli.main import app

    for part in FOLDERS:
        for room, lines in rooms(part).items():
            print(f"{sum(lines):7,} {len(lines):4}  {room}")
        report(part, sum(map(sum, rooms(part).values())), BUDGET["lines"][part])
    for name, number in density().items():
        report(name, number, BUDGET["density"][name])
    report("words of docs", words_of_docs(), BUDGET["docs_words"])
    for name in SCRIPTS:
        report(f"modules entered: {name}", len(modules_entered(name)), BUDGET["journeys"][name])
    for package in ("icons", "circuit", "perception", "notebooks"):
        print(f"{len(import_module(f'thermicon.{package}').__all__):10}  names in thermicon.{package}")
    for name, command in get_command(app).commands.items():
        print(f"{sum(one.opts[0].startswith('-') for one in command.params):10}  options of {name}")


if __name__ == "__main__":
    main()
