"""The group of commands: how it lists them, and how errors, wrong numbers, interrupts and closed pipes end it."""

from __future__ import annotations

import os
import re
import sys
from pickle import UnpicklingError
from typing import Any

import typer
from typer.core import TyperGroup

from ..messages import fail, interrupted, into_nowhere, is_ours, late_notes

SENTENCE = 400
"""More letters than any first sentence of a command's help has."""
UNITS = {"S": "s", "HZ": "Hz", "J": "J", "K": "K", "POINTS": "percentage points", "PERCENT": "%"}
"""Units by the metavar of an option; others have none."""
WHOLE, DECIMAL = "int", "float"
ONE_OF, QUOTE = " is not one of ", "'"
BOUNDS = ("greater_than_equal", "less_than_equal")
DIGITS = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


class Commands(TyperGroup):
    """A group of commands that ends with a message and an exit code, never with a traceback for a wrong input."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """List the commands by job, each with its whole first sentence."""
        panels: dict[str, list[tuple[str, str]]] = {}
        for name in self.list_commands(ctx):
            command = self.get_command(ctx, name)
            if command is not None and not command.hidden:
                panel = getattr(command, "rich_help_panel", None)
                title = panel if isinstance(panel, str) else "Commands"
                panels.setdefault(title, []).append((name, command.get_short_help_str(SENTENCE)))
        width = max(len(name) for rows in panels.values() for name, _ in rows)
        for title, rows in panels.items():
            with formatter.section(title):
                formatter.write_dl([(name.ljust(width), sentence) for name, sentence in rows])

    def make_context(self, *arguments: Any, **extra: Any) -> Any:
        """Read the command line; Ctrl-C exits with 130."""
        # Python's workers, and every server that is started from here, import nothing from where they are started.
        os.environ.setdefault("PYTHONSAFEPATH", "1")
        try:
            return super().make_context(*arguments, **extra)
        except KeyboardInterrupt:
            raise interrupted() from None

    def invoke(self, ctx: Any) -> Any:
        """Run the command; bad input exits with 1, Ctrl-C with 130, a reader that went away with 0."""
        try:
            with late_notes():
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
            from thermicon.icons.userfolder import cache_folder

            fail(f"machine code in {cache_folder() / 'compiled'} is damaged: delete this folder; it is made again")
        except RecursionError:
            fail("the input is nested too deeply to be read")
        except Exception as error:
            if isinstance(error, RuntimeError) and "Symlink loop" in str(error):  # pathlib's words, before 3.13
                fail(f"a path cannot be followed because its links form a circle: {str(error).partition('from ')[2]}")
            if isinstance(error, typer.BadParameter):
                reworded(error)
                raise
            if not is_ours(error):
                raise
            fail(str(error))
        else:
            return result


def number_fault(text: str, kind: str, unit: str = "") -> str:
    """Say what kind of number was wanted, and how to write it.

    >>> number_fault("abc", "float", "s")
    "'abc' is not a number in s; write it in digits, such as 2.5"
    >>> number_fault("10 s", "float", "s")
    "'10 s' is not a number in s; leave the unit out: 10"
    >>> number_fault("2,5", "float"), number_fault("2.5", "int")
    ("'2,5' is not a number; write a decimal point: 2.5", "'2.5' is not a whole number; write one, such as 12")
    """
    from thermicon.circuit.inputs import quoted

    bare = text.strip()
    what = "a whole number" if kind == WHOLE else f"a number in {unit}" if unit else "a number"
    own = re.fullmatch(rf"({DIGITS})\s*{re.escape(unit)}", bare) if unit else None
    if kind == WHOLE and re.fullmatch(r"[-+]?\d+", bare):
        return f"{quoted(text)} has too many digits to be read"
    if kind == DECIMAL and own:
        cure = f"leave the unit out: {own[1]}"
    elif kind == DECIMAL and re.fullmatch(r"[-+]?\d*,\d+", bare):
        cure = f"write a decimal point: {bare.replace(',', '.')}"
    else:
        cure = "write one, such as 12" if kind == WHOLE else "write it in digits, such as 2.5"
    return f"{quoted(text)} is not {what}; {cure}"


def reworded(error: Any) -> None:
    """Put such a sentence in the place of the parser's own words, where the value of an option cannot be.

    `error` is a bad parameter of the command line; others stay as they are.
    """
    param, faults = getattr(error, "param", None), getattr(error.__cause__, "errors", None)
    if param is None or faults is None:
        return
    fault = faults()[0]
    kind, text, unit = fault["type"].partition("_")[0], str(fault["input"]), UNITS.get(param.metavar or "", "")
    if kind in (WHOLE, DECIMAL):
        error.message = number_fault(text, kind, unit)
    elif fault["type"] in BOUNDS:
        unit = f" {unit}" if unit else ""
        error.message = f"{float(text):.10g}{unit} is outside {param.min:.10g} to {param.max:.10g}{unit}"
    else:
        wrong, joint, choices = error.message.removeprefix("Value error, ").removesuffix(".").partition(ONE_OF)
        error.message = f"{wrong}{joint}{choices.replace(QUOTE, '')}"
