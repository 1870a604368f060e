"""The group of commands: how it lists them, and how errors, interrupts and closed pipes end the program."""

from __future__ import annotations

import os
import sys
from pickle import UnpicklingError
from typing import Any

import typer
from typer.core import TyperGroup

from ..messages import fail, interrupted, into_nowhere, is_ours, late_notes
from ..report.number_fault import reworded

SENTENCE = 400
"""More letters than any first sentence of a command's help has."""


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
