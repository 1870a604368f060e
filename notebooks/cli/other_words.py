"""Answers to words that are neither commands nor options and the short form of usage errors."""

import tomllib
from collections.abc import Iterable
from importlib import import_module, resources
from pathlib import Path
from typing import Any

import typer

from thermicon.base.words.near_words import proposals


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


def unknown_command(word: str, commands: Iterable[str]) -> str:
    """What to do about a word that is no command: a command line, a name of Python, or the nearest commands.

    >>> unknown_command("netlist", ["list"]), unknown_command("ranks", ["rank", "list"])
    ('in Python it is thermicon.circuit.netlist', 'did you mean rank?')
    """
    if line := answer_to(word):
        return f"try: {line}"
    for package in ("icons", "circuit", "perception", "notebooks"):
        if word in import_module(f"thermicon.{package}").__all__:
            return f"in Python it is thermicon.{package}.{word}"
    near = proposals(word, commands, 2)
    return f"did you mean {' or '.join(near)}?" if near else "thermicon --help lists all"


OUTPUTS = ("o", "output", "csv", "format", "save", "table")
"""What people write for an option that names a file to write."""
FIRST = 4
"""Words of an option's help that say what it is; the others say more than that."""


def option_meant(typed: str, command: Any, program: Any) -> str:
    """What was meant by an option that a command does not have; empty where nothing is like it.

    `command` and `program` are as typer makes them.
    """
    from thermicon.circuit.rig.rigfile import rig_keys

    word, known = typed.lstrip("-"), [(name, option) for option in command.params for name in option.opts]
    options = {name[2:]: option for name, option in known if name.startswith("--")}
    having = [name for name, other in program.commands.items() if any(typed in option.opts for option in other.params)]
    also = {name: f"{option.metavar} {' '.join(str(option.help).split()[:FIRST])}" for name, option in options.items()}
    outputs = [option.opts[0] for option in command.params if str(option.metavar or "").startswith("OUT")]
    near = proposals(word, [*options, *(OUTPUTS if outputs else ())], cutoff=0.6, also=also)
    if near and near[0] in OUTPUTS and near[0] not in options:
        return f"; what it writes is named by {', '.join(outputs)}"
    if having:
        return f"; it belongs to {', '.join(having)}"
    if near:
        return f"; did you mean --{near[0]}?"
    keys = proposals(word, rig_keys(), cutoff=0.8) if "set" in options else []
    return f"; did you mean --set {keys[0]}=VALUE?" if keys else ""


def in_three_lines(error: Any) -> None:
    """Let an error of the command line say how the command is used, where its help is, and what is wrong, a line each.

    `error` is one of typer's; others stay as they are.
    """
    if (where := getattr(error, "ctx", None)) is not None:
        head = f"{where.get_usage().splitlines()[0]}\nTry '{where.command_path} --help' for help."
        error.show = lambda file=None: typer.echo(f"{head}\nError: {error.format_message()}", file=file, err=True)
