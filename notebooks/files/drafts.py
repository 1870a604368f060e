"""Drafts: what a command writes under a hidden name first. Those of processes that were killed are swept."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .locking import is_alive, take

MARK = "thermicon-part"
NAMED = re.compile(rf"\..*\.(\d+)-\d+\.{MARK}(\..*)?")
LONGEST_STEM = 40
"""Characters of a file's name that its draft repeats, so that long names stay within what disks take."""

OLD_S = 86_400.0
"""Age of a draft whose process number runs: older ones belong to an earlier process of that number."""

_COUNT = itertools.count()


@contextmanager
def draft_of(goal: Path) -> Iterator[Path]:
    """An empty draft beside a file, locked while the block runs, and gone when it ends unless it was renamed.

    Drafts that killed processes left in the same folder are removed first.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder, draft_of(Path(folder) / "a.csv") as draft:
    ...     draft.name.startswith(".a."), draft.suffix
    (True, '.csv')
    """
    sweep(goal.parent)
    draft = goal.with_name(f".{goal.stem[:LONGEST_STEM]}.{os.getpid()}-{next(_COUNT)}.{MARK}{goal.suffix.lower()}")
    place = os.open(draft, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
    try:
        if os.name == "nt":
            os.close(place)  # an open file cannot be renamed there
        else:
            take(place)
        yield draft
    finally:
        draft.unlink(missing_ok=True)
        if os.name != "nt":
            os.close(place)


def sweep(folder: Path) -> None:
    """Remove this person's drafts of processes that are gone from a folder; nothing else is ever touched."""
    if os.name != "posix":
        return
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.startswith(".") and (named := NAMED.fullmatch(entry.name)) is not None:
                with contextlib.suppress(OSError):
                    _sweep(Path(entry.path), int(named[1]))


def _sweep(draft: Path, process: int) -> None:
    state = draft.lstat()
    if not stat.S_ISREG(state.st_mode) or state.st_uid != os.geteuid():
        return
    if process != os.getpid() and is_alive(process) and time.time() - state.st_mtime < OLD_S:
        return
    place = os.open(draft, os.O_RDWR | os.O_NOFOLLOW)
    try:
        if take(place):  # else it is being written: by this process, or on another machine that shares the disk
            draft.unlink()
    finally:
        os.close(place)
