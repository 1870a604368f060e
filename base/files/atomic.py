"""The writer of files that are complete or absent."""

from __future__ import annotations

import os
import secrets
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

MARK = "thermicon-part"
"""What stands in the hidden name of a file or folder that is not complete."""
LONGEST_STEM = 40
"""Characters of a file's name that its draft repeats, so that long names stay within what disks take."""


class OutputError(Exception):
    """An output cannot be written where or as it was asked for; the text says what to change."""


@contextmanager
def complete_or_absent(path: Path) -> Iterator[Path]:
    """A temporary name beside ``path``, whose place it takes when the block succeeds; OutputError where it cannot."""
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


def check_folder(path: Path) -> None:
    """Fail now where the folder ``path`` could neither be used nor be made."""
    if path.is_dir():
        check_inside(path, path)
    elif path.exists() and not path.is_dir():  # it may have been made in between
        raise OutputError(f"cannot write into {path}: it is a file; give the name of a folder")
    else:
        check_inside(path, path.parent)


def check_inside(path: Path, folder: Path) -> None:
    """Fail now where ``path`` could not be written into a folder."""
    if not folder.exists():
        raise OutputError(f"cannot write {path}: the folder {folder} does not exist; make it first")
    if not folder.is_dir():
        raise OutputError(f"cannot write {path}: {folder} is a file, not a folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(f"cannot write {path}: the folder {folder} is not writable")


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
