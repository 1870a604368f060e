"""Files that commands write: looked at before long work starts, complete or absent when it ends."""

from __future__ import annotations

import os
import secrets
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

STDOUT = Path("-")
TRACE_SUFFIXES = (".csv", ".parquet")
NETLIST_SUFFIXES = (".cir", ".net", ".sp")
SUBCIRCUIT_SUFFIXES = (".lib", ".sub", *NETLIST_SUFFIXES)
FIGURE_SUFFIXES = (".png", ".pdf", ".svg")
MARK = "thermicon-part"
"""What stands in the hidden name of a file or folder that is not complete."""
LONGEST_STEM = 40
"""Characters of a file's name that its draft repeats, so that long names stay within what disks take."""


class OutputError(Exception):
    """An output cannot be written where or as it was asked for; the text says what to change."""


def check_output(path: Path, suffixes: Sequence[str], what: str) -> None:
    """Fail now, with the reason, where writing ``path`` would fail later.

    ``suffixes`` are the file types on offer (empty: any), ``what`` names the thing written. ``-`` is always fine.
    """
    if path == STDOUT:
        return
    if path.is_dir():
        raise OutputError(f"cannot write {path}: it is a folder; give the name of a file")
    if suffixes and path.suffix.lower() not in suffixes:
        offer = " or ".join(suffixes)
        found = f"not {path.suffix}" if path.suffix else "and this name has no ending"
        raise OutputError(f"cannot write {path}: {what} is written as {offer}, {found}")
    if path.suffix.lower() == ".parquet":
        from thermicon.circuit.inputs import require_pyarrow

        require_pyarrow(f"cannot write {path}", OutputError)
    _check_folder(path, path.parent)
    if path.exists() and not os.access(path, os.W_OK):
        raise OutputError(f"cannot write {path}: the file exists and is read-only")


def check_separate(inputs: Sequence[str | Path], outputs: Sequence[Path | None]) -> None:
    """Fail where an output is a file that the command reads, or two outputs are the same file."""
    seen = {Path(name).resolve(): "is read by this command" for name in inputs if Path(name).is_file()}
    for path in outputs:
        if path is None or path == STDOUT:
            continue
        place = path.resolve()
        if place in seen:
            raise OutputError(f"cannot write {path}: the file {seen[place]}; give another name")
        seen[place] = "is another output of this command"


def check_folder(path: Path) -> None:
    """Fail now where the folder ``path`` could neither be used nor be made."""
    if path.is_dir():
        _check_folder(path, path)
    elif path.exists() and not path.is_dir():  # it may have been made in between
        raise OutputError(f"cannot write into {path}: it is a file; give the name of a folder")
    else:
        _check_folder(path, path.parent)


def _check_folder(path: Path, folder: Path) -> None:
    if not folder.exists():
        raise OutputError(f"cannot write {path}: the folder {folder} does not exist; make it first")
    if not folder.is_dir():
        raise OutputError(f"cannot write {path}: {folder} is a file, not a folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(f"cannot write {path}: the folder {folder} is not writable")


@contextmanager
def complete_or_absent(path: Path) -> Iterator[Path]:
    """A temporary name beside ``path`` to write to; it takes the place of ``path`` only when the block succeeds.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with complete_or_absent(Path(folder) / "a.txt") as draft:
    ...         _ = draft.write_text("done")
    ...     [found.name for found in Path(folder).iterdir()]
    ['a.txt']
    """
    goal = path.resolve()
    if goal.exists() and not goal.is_file():
        yield goal  # a pipe or a device: nothing to replace
        return
    draft = goal.with_name(f".{goal.stem[:LONGEST_STEM]}.{secrets.token_hex(4)}.{MARK}{goal.suffix.lower()}")
    try:
        draft.touch(exist_ok=False)
        try:
            yield draft
            draft.replace(goal)
        finally:
            draft.unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from error


@contextmanager
def stopped_cleanly() -> Iterator[None]:
    """Let a polite request to end (SIGTERM) act like Ctrl-C, so that what was begun is tidied up."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def kept_text(folder: Path, there: Sequence[str]) -> str:
    """That files of a folder are there already and were kept.

    >>> kept_text(Path("out"), ["a.csv"]), kept_text(Path("out"), ["a.csv", "b.csv", "c.csv"])
    ('out/a.csv already exists and was kept', 'out/a.csv and 2 more already exist and were kept')
    """
    if len(there) == 1:
        return f"{folder / there[0]} already exists and was kept"
    return f"{folder / there[0]} and {len(there) - 1} more already exist and were kept"
