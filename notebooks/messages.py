"""Messages to the person at the terminal with exit codes; also the rig that a command's options name."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Any, NoReturn, TextIO

import typer

from thermicon.icons.model.arguments import InputError, advised
from thermicon.icons.model.clean_text import clean, clean_line

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.perception.observer.observer_model import ObserverModel

Progress = Callable[[int, int], None]

BAD_INPUT = 1
REFUSED = 3
INTERRUPTED = 130
DEFAULT_RIG = "thenar"
_QUIET: ContextVar[bool] = ContextVar("quiet", default=False)
_VERBOSE: ContextVar[bool] = ContextVar("verbose", default=False)


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
    ((ours, theirs),) = names.items()
    quote = '"' if set(theirs) & set(" ()[]/&;*|<>$'°#") else ""
    return f"--column {quote}{ours}={theirs}{quote}"


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
    _VERBOSE.set(verbose)


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


def check_changes(changes: Sequence[str]) -> None:
    """Fail with a usage error unless every ``--set`` has the form KEY=VALUE."""
    for change in changes:
        key, equals, value = change.partition("=")
        if not (key.strip() and equals and value.strip()):
            raise usage(f"{change!r} is not of the form KEY=VALUE, for example contact.area_cm2=4", "--set")


def load_rig(name: str | None, changes: Sequence[str], *, site: str | None = None, named: bool = False) -> Rig:
    """Load the rig of ``--rig``, or the usual one for a site, with the changes of ``--set``, and warn of it.

    `named`: warnings say of which rig they are.
    """
    check_changes(changes)
    from thermicon.circuit import Rig

    rig = Rig.of(name, site)
    if name is None and rig.name == site != DEFAULT_RIG:
        note(f"on the {site} rig, since the set is for that site; --rig names another")
    if changes:
        rig = rig.with_set(list(changes))
    warn_of_rig(rig, named)
    return rig


def warn_of_rig(rig: Rig, named: bool = False) -> None:
    """Warn on stderr of what is unusual about a rig: whole sentences where safety needs them, or who reads wants all.

    On a terminal the rest is one short line, once for a rig in a folder.
    """
    from thermicon.circuit.rig.rig_words import rig_warnings

    whole, brief = _VERBOSE.get() or not sys.stderr.isatty(), list[str]()
    for each in rig_warnings(rig):
        if whole or each.brief is None:
            note(f"warning: {f'{rig.name}: ' if named else ''}{each.text}")
        else:
            brief.append(each.brief)
    if brief and _is_new(f"{Path.cwd()}\n{rig.document}"):
        note(f"warning: rig {rig.name}: {'; '.join(brief)} (in full: thermicon -v)")


def _is_new(text: str) -> bool:
    """Whether this was not asked before; an empty file in the cache folder remembers it."""
    from hashlib import sha256

    from thermicon.icons.cache_folder import cache_folder

    told = cache_folder() / "told" / sha256(text.encode()).hexdigest()[:20]
    if told.exists():
        return False
    with contextlib.suppress(OSError):
        told.parent.mkdir(parents=True, exist_ok=True)
        told.touch()
    return True


def load_observer(file: Path | None, rig: Rig | None = None, needs_draws: str = "") -> ObserverModel:
    """Load the shipped observer, or that of ``--observer``, of which notes on stderr say what it cannot give.

    Draws of a laboratory that was asked on another than the `rig` are warned of; `needs_draws` says what cannot be done
    without draws, which is then refused.
    """
    from thermicon.perception.observer.observer_model import ObserverModel

    with noted("warning"):
        model = ObserverModel.load(file)
    if model.posterior is None:
        beside, cure = (
            file and file.with_suffix(".csv"),
            "give the table of draws (.csv) that pilot --keep writes beside it",
        )
        if beside and beside.exists():
            cure = f"give {beside}, which stands beside it"
        if needs_draws:
            fail(f"{model.name}: {needs_draws}, which this observer does not have: {cure}")
        note(f"note: {model.name} has no posterior draws, so that there are no intervals for a new laboratory: {cure}")
    elif (
        rig is not None
        and (held := model.posterior.header.rig)
        and held != (now := ", ".join((rig.name, *rig.changes)))
    ):
        note(f"warning: {model.name} was conditioned on the {held} rig, not on {now}: its answers say less of this one")
    return model


def check_draws(model: ObserverModel, asked: int | None, option: str, usual: int, least: int = 2) -> int:
    """The number of draws to use: what was asked for, or the usual number, or as many as the observer has.

    Fail where more are asked for than there are, and where there are fewer than `least`.
    """
    if model.posterior is not None and (held := len(model.posterior)) < least:
        fail(f"{model.name} has {held} draws, and {least} are needed: keep more with pilot --draws {2 * least}")
    if asked is None:
        if 0 < (draws := model.most_draws(usual)) < usual:
            note(f"note: {model.name} has {draws} draws: all of them are used ({option} is {usual} by default)")
        return draws
    if model.posterior is not None and asked > len(model.posterior):
        fail(f"{option} {asked}: the {model.name} posterior has {len(model.posterior)} draws: ask for as many or fewer")
    return asked


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
