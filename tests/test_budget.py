"""The budget of the house (`budget.toml`): maintained lines, public names, options of commands, words of docs."""

import re
import tomllib

import pytest
from typer.main import get_command_from_info
from typer.models import CommandInfo

from tests.count import ROOT, rooms

BUDGET = tomllib.loads((ROOT / "tests" / "budget.toml").read_text(encoding="utf-8"))
PACKAGES = ("icons", "circuit", "perception", "notebooks")


def _judge(what: str, number: int, most: int) -> None:
    assert number <= most, f"{what}: {number}, the budget is {most}; remove {number - most}, or take it from elsewhere"


@pytest.mark.parametrize("what", ["product", "tests"])
def test_what_is_maintained_stays_within_its_lines(what: str) -> None:
    _judge(f"lines of the {what}", sum(room.lines for room in rooms(what)), BUDGET["lines"][what])


def test_the_docs_have_no_more_words_than_their_budget() -> None:
    """Words are what holds a letter or a digit, but for comments; what the site's build makes is not in the pages."""
    pages = (re.sub("<!--.*?-->", "", path.read_text("utf-8")) for path in (ROOT / "docs").rglob("*.md"))
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
