"""Two folders change places in one step, where the system can do that."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path

AT_FDCWD, RENAME_EXCHANGE = -100, 2
"""From Linux's fcntl.h: paths count from the current folder; both names stay, their contents change places."""


def exchange(new: Path, goal: Path, aside: Path) -> None:
    """Let a folder take the place of another one, which is then found under the name ``new`` or ``aside``.

    One step on Linux where the disk can do it. Otherwise two: between them ``goal`` is missing and whole as ``aside``.
    """
    if not swap(new, goal):
        goal.rename(aside)
        new.rename(goal)


def swap(one: Path, other: Path) -> bool:
    """Exchange two names in one step; False where system or disk cannot, and then nothing has changed.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     a, b = Path(folder) / "a", Path(folder) / "b"
    ...     _ = a.write_text("1"), b.write_text("2")
    ...     ("2" if swap(a, b) else "1") == a.read_text()
    True
    """
    if not sys.platform.startswith("linux"):
        return False
    try:
        rename = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError):
        return False
    done = rename(AT_FDCWD, os.fsencode(one), AT_FDCWD, os.fsencode(other), ctypes.c_uint(RENAME_EXCHANGE))
    return int(done) == 0
