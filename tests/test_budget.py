"""The budget of the house: lines and modules of each room, public names, options of commands. Numbers only fall.

`budget.toml` holds them. A room that is 3 % below its number asks for the number to be lowered; one that is above it
must shrink, or another room must give what it takes: the sum never rises.
"""

import re
import tomllib
from collections import Counter
from pathlib import Path

import pytest
from typer.main import get_command_from_info
from typer.models import CommandInfo

ROOT = Path(__file__).resolve().parents[1]
BUDGET = tomllib.loads((ROOT / "tests" / "budget.toml").read_text(encoding="utf-8"))
PACKAGES = ("icons", "circuit", "perception", "notebooks")
SLACK = 0.03
"""A number that is this far above what there is has to be lowered."""
FEW = 10
"""Fewer lines or modules than this below a number are no reason to lower it."""


def _rooms(folders: tuple[str, ...]) -> dict[str, tuple[int, int]]:
    """Lines and modules of each folder that holds Python files, `__init__.py` included."""
    lines: Counter[str] = Counter()
    modules: Counter[str] = Counter()
    for folder in folders:
        for path in (ROOT / folder).rglob("*.py"):
            room = path.parent.relative_to(ROOT).as_posix()
            lines[room] += len(path.read_text(encoding="utf-8").splitlines())
            modules[room] += 1
    return {room: (lines[room], modules[room]) for room in sorted(lines)}


ROOMS = _rooms(("thermicon", *PACKAGES))


def _judge(what: str, number: int, most: int) -> None:
    assert number <= most, f"{what}: {number}, the budget is {most}; remove {number - most}, or take it from elsewhere"
    spare = most - number
    assert spare <= max(SLACK * most, FEW), f"{what}: {number}, lower its number in tests/budget.toml from {most}"


def test_every_room_has_a_budget() -> None:
    assert set(BUDGET["room"]) == set(ROOMS)


@pytest.mark.parametrize("room", BUDGET["room"])
def test_a_room_stays_within_its_lines_and_modules(room: str) -> None:
    lines, modules = ROOMS.get(room, (0, 0))
    most_lines, most_modules = BUDGET["room"][room]
    _judge(f"lines of {room}", lines, most_lines)
    _judge(f"modules of {room}", modules, most_modules)


def test_the_sum_only_falls() -> None:
    _judge("lines of the product", sum(lines for lines, _ in ROOMS.values()), BUDGET["sum"]["lines"])
    _judge("modules of the product", sum(modules for _, modules in ROOMS.values()), BUDGET["sum"]["modules"])
    _judge("lines of the tests", sum(lines for lines, _ in _rooms(("tests",)).values()), BUDGET["sum"]["test_lines"])


def test_the_tests_are_at_most_half_of_the_product() -> None:
    tests, product = (sum(lines for lines, _ in _rooms(folders).values()) for folders in (("tests",), PACKAGES))
    assert tests <= BUDGET["sum"]["tests_over_product"] * product


def test_the_docs_have_no_more_words_than_their_budget() -> None:
    """Words are what holds a letter or a digit; what the site's build makes does not stand in the pages."""
    pages = (path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md"))
    _judge(
        "words of docs",
        sum(bool(re.search(r"\w", word)) for page in pages for word in page.split()),
        BUDGET["sum"]["docs_words"],
    )


@pytest.mark.parametrize("package", PACKAGES)
def test_a_front_door_offers_no_more_names_than_its_budget(package: str) -> None:
    import importlib

    names = importlib.import_module(f"thermicon.{package}").__all__
    assert len(names) <= BUDGET["names"][package], f"{len(names)} names in thermicon.{package}"


def options_of(command: CommandInfo) -> int:
    """Number of options of a command; what has no dashes is an argument."""
    parameters = get_command_from_info(command, pretty_exceptions_short=True, rich_markup_mode=None).params
    return sum(any(word.startswith("-") for word in one.opts) for one in parameters)


def test_commands_and_their_options_stay_within_the_budget() -> None:
    from thermicon.notebooks.cli.main import app

    commands = {command.name: options_of(command) for command in app.registered_commands}
    assert len(commands) <= BUDGET["sum"]["commands"]
    for name, count in commands.items():
        assert count <= BUDGET["sum"]["options"], f"{name} has {count} options"
