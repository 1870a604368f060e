"""The writer of files, which are complete or absent; also the user's private cache folder."""

from __future__ import annotations

import os
import platform
import secrets
import signal
import stat
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

MARK = "thermicon-part"
"""What stands in the hidden name of a file or folder that is not complete."""
LONGEST_STEM = 40
"""Characters of a file's name that its draft repeats, so that long names stay within what disks take."""
WRITABLE_BY_OTHERS = stat.S_IWGRP | stat.S_IWOTH


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


def cache_folder() -> Path:
    """The user's cache folder for this program: THERMICON_CACHE, or where the system keeps such things."""
    if chosen := os.environ.get("THERMICON_CACHE"):
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "thermicon"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "thermicon"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "thermicon"


def compiled_folder(numba: str, llvmlite: str) -> Path:
    """The folder of machine code that these versions compiled for this Python and this kind of processor."""
    tools = f"numba-{numba}-llvmlite-{llvmlite}-{sys.implementation.cache_tag}"
    return cache_folder() / "compiled" / f"{tools}-{platform.machine()}"


class NotPrivate(OSError):
    """A folder cannot be created, or others could write into it; the text says why and what to do."""


def private_folder(path: Path) -> Path:
    """Return a folder, created if missing, into which only this user (and the system's administrator) can write.

    Its owner and mode and those of all folders above are checked, as ssh does with its keys. On Windows, where access
    lists keep the user's own folders private, it is only created. Raises NotPrivate.
    """
    path = path.absolute()
    try:  # even to look is not allowed inside another user's private folder
        missing = [folder for folder in (path, *path.parents) if not folder.exists()]
        for folder in reversed(missing):
            folder.mkdir(mode=0o700, exist_ok=True)
    except OSError as problem:
        raise NotPrivate(f"{path} cannot be created ({problem.strerror or problem})") from None
    if sys.platform != "win32":
        real = path.resolve()
        for folder in (real, *real.parents):
            if fault := _fault(folder, folder == real):
                cure = "set THERMICON_CACHE to a folder that only you can write to (chmod go-w)"
                raise NotPrivate(f"{folder} {fault}; {cure}")
    if not os.access(path, os.W_OK | os.X_OK):
        raise NotPrivate(f"{path} is not writable")
    return path


def _fault(folder: Path, is_last: bool) -> str | None:
    status = folder.stat()
    user = os.geteuid()
    if status.st_uid != user and (is_last or status.st_uid != 0):
        return "belongs to another user"
    # A group counts as others even if it is the user's own: no number and no list says that it has no other member.
    if status.st_mode & WRITABLE_BY_OTHERS and (is_last or not status.st_mode & stat.S_ISVTX):
        return "can be written by others"
    return None


def remove_unused(files: Iterable[Path], longest_s: float) -> None:
    """Remove files that nobody read or wrote for so many s; where that fails, they stay for another time."""
    with suppress(OSError):
        for file in files:
            if time.time() - max(file.stat().st_atime, file.stat().st_mtime) > longest_s:
                file.unlink(missing_ok=True)
