"""The command line: every command of ``thermicon``, grouped by job.

A command imports what it needs when it runs, so that ``check`` answers at once. The work of each command is in a module
of this package.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Annotated, Any

import typer

from ..messages import be_quiet, interrupted
from ..startup import is_command, print_anywhere, warn_if_hidden
from .app import Commands
from .options import flat

WRITE, SIMULATE, PREDICT = "Write icons", "Simulate a rig", "Predict perception"
PLAY, NOTEBOOKS, INSTALLATION = "Play on hardware", "Notebooks", "Installation"
"""Jobs, as the headings of ``thermicon --help``."""

COMMANDS = {
    "check": ("check", WRITE),
    "convert": ("convert", WRITE),
    "list": ("listing", WRITE),
    "simulate": ("simulate", SIMULATE),
    "sweep": ("sweep", SIMULATE),
    "compare": ("compare", SIMULATE),
    "fit": ("fit", SIMULATE),
    "rank": ("ranking", PREDICT),
    "improve": ("improve", PREDICT),
    "pilot": ("pilot", PREDICT),
    "validate": ("validation", PREDICT),
    "export": ("export", PLAY),
    "study": ("study", PLAY),
    "lab": ("lab", NOTEBOOKS),
    "doctor": ("main", INSTALLATION),
}
"""Each command with its module of this room, whose function NAME_command it is, and its job."""


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"thermicon {version('thermicon')}")
        raise typer.Exit


def thermicon(
    quiet: Annotated[
        bool, typer.Option("-q", "--quiet", help="No progress, notes or warnings: results and errors only.")
    ] = False,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Design thermal icons, simulate them on display and skin, and predict which ones people confuse."""
    be_quiet(quiet)


def doctor_command(
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of lines.")] = False,
) -> None:
    """Check the installation: versions, extras, ngspice, the cache, the kernel of Jupyter, and a self-test.

    Every line is ok, a note (something that can be done without) or a fault, with its cure. With a fault, the exit code
    is 1.
    """
    from .examine import doctor

    raise typer.Exit(doctor(json))


def program(words: Sequence[str] = ()) -> typer.Typer:
    """The program with the one command that a command line begins with, otherwise with all.

    Importing all of them, and reading their options, takes longer than checking a file.

    >>> [command.name for command in program(["check"]).registered_commands]
    ['check']
    """
    made = typer.Typer(
        name="thermicon",
        cls=Commands,
        callback=thermicon,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        no_args_is_help=True,
    )
    for name in words[:1] if words and words[0] in COMMANDS else COMMANDS:
        module, job = COMMANDS[name]
        command = getattr(import_module(f".{module}", __package__), f"{name}_command")
        made.command(name, rich_help_panel=job)(flat(command))
    return made


def __getattr__(name: str) -> Any:
    """`app`, the program with all commands."""
    if name == "app":
        return program()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def main() -> None:
    """Run the command line of the process; the entry point of the ``thermicon`` command."""
    # What imports create is not garbage, and looking for some after each 700 objects takes a twentieth of a command.
    gc.set_threshold(100_000)
    try:
        if is_command():
            warn_if_hidden()
        print_anywhere()
        program(sys.argv[1:])(prog_name="thermicon")
    except KeyboardInterrupt:
        sys.exit(interrupted().exit_code)
    finally:
        gc.freeze()  # a process that ends needs no last search for garbage either


if __name__ == "__main__":
    main()
