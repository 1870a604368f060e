"""Answers to words that are no commands and the short form of usage errors."""

import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import typer


def answer_to(word: str) -> str:
    """The command line for a word that is no command; empty where there is none to offer.

    >>> answer_to("Frontier"), answer_to("alerts.cue"), answer_to("xyz")
    ('thermicon improve FILE --up-to 6', 'thermicon rank alerts.cue', '')
    """
    if word.endswith(".cue"):
        return f"thermicon rank {word}"
    if word.endswith(".toml") and Path(word).is_file():
        return f"thermicon rank six-icons --rig {word}"
    said = tomllib.loads((resources.files("thermicon.notebooks") / "data" / "other-words.toml").read_text("utf-8"))
    return next((f"thermicon {line}" for words, line in said.items() if word.casefold() in words.split()), "")


def outputs_of(command: Any) -> str:
    """Which options of a command name what it writes, for who asks for another.

    `command` is as typer makes it.
    """
    named = [each.opts[0] for each in command.params if str(each.metavar or "").startswith("OUT")]
    return f"; what it writes is named by {', '.join(named)}" if named else ""


def in_three_lines(error: Any) -> None:
    """Let an error of the command line say how the command is used, where its help is, and what is wrong, a line each.

    `error` is one of typer's; others stay as they are.
    """
    if (where := getattr(error, "ctx", None)) is not None:
        head = f"{where.get_usage().splitlines()[0]}\nTry '{where.command_path} --help' for help."
        error.show = lambda file=None: typer.echo(f"{head}\nError: {error.format_message()}", file=file, err=True)
