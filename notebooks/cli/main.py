"""The entry point of the command line.

A command imports what it needs when it runs, so that ``check`` answers at once. The work of each command is in a module
of this package.
"""

import io
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from pickle import UnpicklingError
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from ..messages import INTERRUPTED, be_quiet, fail, interrupted, into_nowhere, is_ours
from .options import flat
from .other_words import in_three_lines, option_meant, unknown_command

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
    "play": ("play", PLAY),
    "study": ("study", PLAY),
    "lab": ("lab", NOTEBOOKS),
    "doctor": ("doctor", INSTALLATION),
}
"""Each command with its module of this room, whose function NAME_command it is, and its job."""

SENTENCE = 400
"""More letters than any first sentence of a command's help has."""
UNITS = {"S": " s", "HZ": " Hz", "J": " J", "K": " K", "POINTS": " percentage points", "PERCENT": " %"}
"""Units by the metavar of an option; others have none."""
NUMBERS = {
    "int": "is not a whole number; write one, such as 12",
    "float": "is not a number; write digits with a decimal point and without a unit, such as 2.5",
}
BOUNDS = ("greater_than_equal", "less_than_equal")


EVERYWHERE = ("-q", "--quiet", "-v", "--verbose")
"""Options of the program that may stand behind a command too."""


def in_front(words: Sequence[str]) -> list[str]:
    """Return a command line with the options of the program in front; what stands behind -- stays.

    >>> in_front(["rank", "-q", "two.cue", "--", "-v"])
    ['-q', 'rank', 'two.cue', '--', '-v']
    """
    end = words.index("--") if "--" in words else len(words)
    front = [word for word in words[:end] if word in EVERYWHERE]
    return [*front, *(word for word in words[:end] if word not in EVERYWHERE), *words[end:]]


class Commands(TyperGroup):
    """A group of commands that ends with a message and an exit code, never with a traceback for a wrong input."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """List the commands by job, each with its whole first sentence."""
        width = max(map(len, self.commands))
        for job in dict.fromkeys(command.rich_help_panel for command in self.commands.values()):  # type: ignore[attr-defined]
            rows = [
                (name.ljust(width), command.get_short_help_str(SENTENCE))
                for name, command in self.commands.items()
                if command.rich_help_panel == job  # type: ignore[attr-defined]
            ]
            with formatter.section(job):
                formatter.write_dl(rows)

    def make_context(self, *arguments: Any, **extra: Any) -> Any:
        """Read the command line; Ctrl-C exits with 130."""
        # Python's workers, and every server that is started from here, import nothing from where they are started.
        os.environ.setdefault("PYTHONSAFEPATH", "1")
        try:
            return super().make_context(*arguments, **extra)
        except KeyboardInterrupt:
            raise interrupted() from None
        except Exception as error:
            in_three_lines(error)
            raise

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read -q and -v, which may stand anywhere; a line without any other word asks for help."""
        return list(super().parse_args(ctx, in_front(args) if {*args} - {*EVERYWHERE} else ["--help"]))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command that a line begins with; ``help NAME`` is its help, other words are answered with theirs."""
        if args[0] == "help" and args[1:2]:
            return self.resolve_command(ctx, [args[1], "--help"])
        if args[0] == "help":
            typer.echo(ctx.get_help())
            raise typer.Exit
        if args[0] not in COMMANDS and not args[0].startswith("-"):
            ctx.fail(f"No such command '{args[0]}'; {unknown_command(args[0], COMMANDS)}")
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the command; bad input exits with 1, Ctrl-C with 130, a reader that went away with 0."""
        try:
            result = super().invoke(ctx)
            sys.stdout.flush()
        except KeyboardInterrupt:
            raise interrupted() from None
        except BrokenPipeError:
            into_nowhere(sys.stdout)
            raise typer.Exit(0) from None
        except MemoryError:
            fail("not enough memory; use fewer people, a lower sample rate (--rate) or a shorter --tail")
        except OSError as error:
            place = f"{error.filename}: " if error.filename else ""
            fail(f"{place}{error.strerror or error}")
        except (EOFError, UnpicklingError):  # as numba reads what a crash of the machine left half-written
            from thermicon.base.files.cache_folder import cache_folder

            fail(f"machine code in {cache_folder() / 'compiled'} is damaged: delete this folder; it is made again")
        except RecursionError:
            fail("the input is nested too deeply to be read")
        except Exception as error:
            if isinstance(error, RuntimeError) and "Symlink loop" in str(error):  # pathlib's words, before 3.13
                fail(f"a path cannot be followed because its links form a circle: {str(error).partition('from ')[2]}")
            in_three_lines(error)
            if type(error).__name__ == "NoSuchOption":
                error.possibilities = ()  # type: ignore[attr-defined]
                error.message += option_meant(error.option_name, error.ctx.command, typer.main.get_command(program()))  # type: ignore[attr-defined]
                raise
            if isinstance(error, typer.BadParameter):
                reworded(error)
                raise
            if not is_ours(error) or type(error.__cause__) is ValueError:  # which may be a mistake of ours
                raise
            fail(error)
        else:
            return result


def reworded(error: Any) -> None:
    """Say, in place of the parser's own words, which value an option cannot have, and what it may be.

    `error` is a bad parameter of the command line; others stay as they are.
    """
    from thermicon.base.files.inputs import quoted
    from thermicon.base.words.near_words import proposals

    param, faults = getattr(error, "param", None), getattr(error.__cause__, "errors", None)
    if param is None or faults is None:
        return
    fault = faults()[0]
    kind, text, unit = fault["type"].partition("_")[0], str(fault["input"]), UNITS.get(param.metavar or "", "")
    if kind in NUMBERS:
        error.message = f"{quoted(text)} {NUMBERS[kind]}"
    elif fault["type"] in BOUNDS:
        error.message = f"{float(text):.10g}{unit} is outside {param.min:.10g} to {param.max:.10g}{unit}"
    else:
        wrong, joint, choices = error.message.removeprefix("Value error, ").removesuffix(".").partition(" is not one ")
        choices = choices.replace("'", "")
        near = proposals(text, choices.removeprefix("of ").split(", "))
        error.message = wrong + joint + choices + (f"; did you mean {near[0]}?" if near else "")


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"thermicon {version('thermicon')}")
        raise typer.Exit


def thermicon(
    quiet: Annotated[
        bool, typer.Option("-q", "--quiet", help="No progress, notes or warnings: results and errors only.")
    ] = False,
    verbose: Annotated[bool, typer.Option("-v", "--verbose", help="Warnings of a rig in full, each time.")] = False,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Design thermal icons, simulate them on display and skin, and predict which ones people confuse."""
    be_quiet(quiet, verbose)


def program(words: Sequence[str] = ()) -> typer.Typer:
    """The program with the one command that a command line begins with, otherwise with all.

    Importing all of them, and reading their options, takes longer than checking a file.
    """
    made = typer.Typer(
        name="thermicon",
        cls=Commands,
        callback=thermicon,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
    )
    first = next((word for word in words if word not in EVERYWHERE), "")
    for name in [first] if first in COMMANDS else COMMANDS:
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
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # where the output has no code for a character
    try:
        program(sys.argv[1:])(prog_name="thermicon")
    except KeyboardInterrupt:
        interrupted()
    except SystemExit as end:
        if end.code != INTERRUPTED:
            raise
    else:
        return
    # Threads that are still at work would be waited for.
    sys.stdout.flush()
    os._exit(INTERRUPTED)


if __name__ == "__main__":
    main()
