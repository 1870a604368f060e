"""Words that people try as commands, each with the command that does it; and answers of three lines at most."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer

SAID = {
    "version": "--version",
    "frontier pareto": "improve FILE --up-to 6",
    "search optimise optimize": "improve FILE --evaluations 2000",
    "choose select": "improve FILE --choose 4",
    "goal target": 'improve FILE --goal "correct >= 90 %"',
    "edit edits": "improve FILE --edits",
    "plan power sample": "pilot FILE",
    "answers trials measurements": "pilot FILE --answers TRIALS.csv",
    "experiment psychopy orders": "study example -o out",
    "icons sets library": "list icons",
    "rig rigs": "list rigs",
    "device devices": "list devices",
    "format formats": "list formats",
    "cite methods bibtex": "list --cite FILE",
    "copy new init create template": "list --copy six-icons mine.cue",
    "fix lint": "check --fix FILE",
    "explain": "check --explain E102",
    "predict confusion confusions report": "rank FILE",
    "plot figure draw": "rank FILE --figure OUT.png",
    "doubt sensitivity": "rank FILE --doubt",
    "run trace play": "simulate FILE",
    "session": "simulate FILE --random 10",
    "vary": "sweep FILE --vary contact.area_cm2=4:16:7 -o OUT.csv",
    "drive drives save write": "export FILE --to csv -o drives",
    "verify": "export --verify DIR",
    "json": "convert FILE -o OUT.json",
    "record recording import": "convert TABLE.csv -o OUT.cue",
    "diff overlay": "compare A B",
    "calibrate": "fit LOG.csv",
    "notebook notebooks jupyter workbench gui": "lab",
    "test selftest self-test": "doctor",
}
"""Words of users, and the command line that answers them."""


def answer_to(word: str) -> str:
    """The command line for a word that is no command; empty where there is none to offer.

    >>> answer_to("Frontier"), answer_to("alerts.cue"), answer_to("xyz")
    ('thermicon improve FILE --up-to 6', 'thermicon rank alerts.cue', '')
    """
    if word.endswith(".cue"):
        return f"thermicon rank {word}"
    if word.endswith(".toml") and Path(word).is_file():
        return f"thermicon rank six-icons --rig {word}"
    return next((f"thermicon {line}" for words, line in SAID.items() if word.casefold() in words.split()), "")


def outputs_of(command: Any) -> str:
    """Which options of a command name what it writes, for who asks for another.

    `command` is as typer makes it.
    """
    named: Sequence[str] = [each.opts[0] for each in command.params if str(each.metavar or "").startswith("OUT")]
    return f"; what it writes is named by {', '.join(named)}" if named else ""


def in_three_lines(error: Any) -> None:
    """Let an error of the command line say how the command is used, where its help is, and what is wrong, a line each.

    `error` is one of typer's; others stay as they are.
    """
    if (where := getattr(error, "ctx", None)) is not None:
        head = f"{where.get_usage().splitlines()[0]}\nTry '{where.command_path} --help' for help."
        error.show = lambda file=None: typer.echo(f"{head}\nError: {error.format_message()}", file=file, err=True)
