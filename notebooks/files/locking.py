"""A lock that ends with its process, however that ends: a file that holds the process's number."""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

TAKEN = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)


@dataclass(frozen=True, slots=True)
class Owner:
    """Whether this process holds a lock, and a few words on the process that does otherwise."""

    path: Path
    place: int
    mine: bool
    words: str = ""

    def remove(self) -> None:
        """Remove the file of a lock that is held; whoever waits for it sees that it is gone."""
        with contextlib.suppress(OSError):
            self.path.unlink()


@contextmanager
def lock(path: Path) -> Iterator[Owner]:
    """Try to hold the lock of a file, which is made if missing, until the block ends.

    Raises FileNotFoundError where its folder is missing, or the file was removed in the same moment.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder, lock(Path(folder) / "owner") as first:
    ...     with lock(Path(folder) / "owner") as second:
    ...         first.mine, second.mine, second.words == f" (process {os.getpid()})"
    (True, False, True)
    """
    place = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
    try:
        if not take(place):
            yield Owner(path, place, False, _words(place))
            return
        if os.fstat(place).st_nlink == 0:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
        os.ftruncate(place, 0)
        os.lseek(place, 0, os.SEEK_SET)
        os.write(place, f"{os.getpid()} {socket.gethostname()}\n".encode())
        yield Owner(path, place, True)
    finally:
        os.close(place)


def take(place: int) -> bool:
    """Try to lock an open file for this process; True where the disk knows no locks."""
    if sys.platform == "win32":
        import msvcrt

        os.lseek(place, 1 << 20, os.SEEK_SET)  # behind the text, which others may read
        try:
            msvcrt.locking(place, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in TAKEN and not _runs(place)
    return True


def is_alive(process: int) -> bool:
    """Whether a process of this number runs on this machine; one that cannot be asked counts as running."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def _owner(place: int) -> tuple[int | None, str]:
    """Number and machine of the process that wrote itself into a lock."""
    os.lseek(place, 0, os.SEEK_SET)
    number, _, machine = os.read(place, 200).decode("utf-8", "replace").strip().partition(" ")
    return (int(number) if number.isdecimal() else None), machine


def _runs(place: int) -> bool:
    number, machine = _owner(place)
    return number is not None and (machine != socket.gethostname() or is_alive(number))


def _words(place: int) -> str:
    number, machine = _owner(place)
    elsewhere = f" on {machine}" if machine and machine != socket.gethostname() else ""
    return "" if number is None else f" (process {number}{elsewhere})"
