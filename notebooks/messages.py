"""Messages to the person at the terminal with exit codes."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextvars import ContextVar
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Any, NoReturn, TextIO

import typer

from thermicon.base.checks.arguments import InputError, advised
from thermicon.base.words.clean_text import clean, clean_line

if TYPE_CHECKING:
    pass

Progress = Callable[[int, int], None]

BAD_INPUT = 1
REFUSED = 3
STOPPED = 4
INTERRUPTED = 130
_QUIET: ContextVar[bool] = ContextVar("quiet", default=False)
VERBOSE: ContextVar[bool] = ContextVar("verbose", default=False)


def shown_at_once() -> bool:
    """Whether somebody watches results as they come, who may be shown a rough one before the final one."""
    return sys.stdout.isatty() and not _QUIET.get()


@contextlib.contextmanager
def bars_aside() -> Iterator[None]:
    """Clear the progress bars while something is printed."""
    from tqdm import tqdm

    with tqdm.external_write_mode():
        yield


def is_ours(error: BaseException) -> bool:
    """Whether the error is one that this project raises on purpose, with a text for people."""
    return type(error).__module__.partition(".")[0] == "thermicon"


def interrupted() -> typer.Exit:
    """Say on stderr that Ctrl-C ended the program, and build the exit with its code."""
    with contextlib.suppress(OSError):
        typer.echo("interrupted", err=True)
    return typer.Exit(INTERRUPTED)


def _column(names: Mapping[str, str]) -> str:
    quotes = {theirs: '"' if set(theirs) & set(" ()[]/&;*|<>$'°#") else "" for theirs in names.values()}
    return " ".join(f"--column {quotes[theirs]}{ours}={theirs}{quotes[theirs]}" for ours, theirs in names.items())


OPTIONS: Mapping[str, Callable[[Any], str]] = {
    "column": "--column {}".format,
    "columns": _column,
    "count": "--choose {}".format,
    "parameters": "--intervals {}".format,
    "pause_s": "--pause {:g}".format,
}
"""How the command line writes what to change, by the names of arguments in Python."""


def fail(message: object) -> NoReturn:
    """Say what is wrong on stderr, and leave with the code for bad input."""
    if isinstance(message, InputError):
        message = advised(message.text, message.changes, OPTIONS)
    typer.echo(clean(str(message)), err=True)
    raise typer.Exit(BAD_INPUT)


def be_quiet(wanted: bool, verbose: bool = False) -> None:
    """From now on show neither progress nor notes, or with `verbose` all warnings in full; what is wrong is said."""
    _QUIET.set(wanted)
    VERBOSE.set(verbose)


def note(message: str, *, always: bool = False) -> None:
    """Tell the person something beside the result; stderr, so that results can be piped. Nobody need be there.

    ``always``: also where only results and errors are wanted, since it says why there is no result.
    """
    if _QUIET.get() and not always:
        return
    try:
        typer.echo(clean(message), err=True)
    except BrokenPipeError:
        into_nowhere(sys.stderr)


def into_nowhere(stream: TextIO) -> None:
    """Let what is still to be written to a stream go nowhere, since its reader went away."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


class MissingArgument(typer.BadParameter):
    """An argument or option that is needed here, though another form of the command does without it."""

    def format_message(self) -> str:
        """The words of the command line's own error."""
        return f"Missing {self.message}."


def usage(message: str, option: str) -> typer.BadParameter:
    """Build the error for a command line that makes no sense; raising it exits with 2."""
    return typer.BadParameter(clean_line(message), param_hint=f"'{option}'")


@contextlib.contextmanager
def noted(kind: str = "note") -> Iterator[None]:
    """Tell the warnings that Python code gives meanwhile as notes of this kind, once there was no error."""
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always")
        yield
    for warning in raised:
        note(f"{kind}: {warning.message}")


@contextlib.contextmanager
def progress_bar(what: str, then: str = "") -> Iterator[Progress | None]:
    """Give a function of (done, total) that draws a bar with the time left, or None when stderr is not a terminal.

    Where something long follows `then`, each of several steps is a line instead.
    """
    if _QUIET.get() or not sys.stderr.isatty():

        def tell(done: int, total: int) -> None:
            if total > 1:
                note(f"{what}: {done} of {total}{f'; {then} …' if done == total else ''}")

        yield tell if then else None
        return
    from tqdm import tqdm

    form, early = "{desc}: {bar} {n_fmt}/{total_fmt}, {remaining} left", "{desc}: {bar} {n_fmt}/{total_fmt}, ? left"
    size = get_terminal_size()  # 80 by 24 where a terminal does not say how large it is, and has no room for a bar
    with tqdm(desc=what, leave=False, file=sys.stderr, bar_format=early, ncols=size.columns, nrows=size.lines) as bar:

        def advance(done: int, total: int) -> None:
            bar.total, bar.bar_format = total, early if done < 0.05 * total else form  # the first steps may compile
            bar.update(done - bar.n)

        yield advance
