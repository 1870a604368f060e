"""The user's private cache folder for this program, and sealed files in it.

A sealed file counts only where this user wrote it, nobody else can, and no byte has changed since.
"""

from __future__ import annotations

import os
import platform
import stat
import sys
import time
from collections.abc import Iterable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

WRITABLE_BY_OTHERS = stat.S_IWGRP | stat.S_IWOTH
OPENED = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


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


def sealed_content(file: Path, largest: int = 2**30) -> bytes | None:
    """What `write_sealed` wrote; None for no file, another user's, a link, a longer (bytes) or a changed one."""
    with suppress(OSError), os.fdopen(os.open(file, OPENED), "rb") as opened:
        status = os.fstat(opened.fileno())
        foreign = sys.platform != "win32" and (status.st_uid != os.geteuid() or status.st_mode & WRITABLE_BY_OTHERS)
        if stat.S_ISREG(status.st_mode) and not foreign and status.st_size <= largest:
            seal, content = opened.read(32), opened.read()
            return content if seal == _seal(file, content) else None
    return None


def write_sealed(file: Path, content: bytes) -> None:
    """Keep content whole or not at all in a private folder; raises OSError."""
    draft = file.with_name(f"{file.name}.{os.urandom(4).hex()}")
    try:
        draft.write_bytes(_seal(file, content) + content)
        draft.chmod(0o600)
        draft.replace(file)
    finally:
        draft.unlink(missing_ok=True)


def _seal(file: Path, content: bytes) -> bytes:
    """Hash of a file's name and content, so that none takes the place of another."""
    return sha256(file.name.encode() + b"\n" + content).digest()
