"""Where long runs keep their finished parts, so that the same command goes on where a killed one stopped."""

from __future__ import annotations

import hashlib
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from thermicon.icons.userfolder import cache_folder, private_folder

from .outputs import check_folder

LONG_PAIRS = 30_000
"""Icons × people from which parts are kept without being asked to: below it, to start again takes seconds."""
STALE_S = 14 * 24 * 3600.0


@contextmanager
def kept(asked: Path | None, pairs: int, what: str) -> Iterator[Path | None]:
    """A folder for finished parts: the one asked for, which stays, or for long work one in the user's cache.

    That one is named after `what` is done and goes when it is done; what runs that never ended left there goes after
    two weeks. None for short work, and where the cache cannot be written or others can write it too.
    """
    if asked is not None:
        check_folder(asked)
        yield asked
        return
    if pairs < LONG_PAIRS:
        yield None
        return
    own = cache_folder() / "parts" / hashlib.sha256(what.encode("utf-8")).hexdigest()[:32]
    try:
        private_folder(own)
        os.utime(own)
    except OSError:
        yield None
        return
    _forget_stale(own.parent)
    yield own
    shutil.rmtree(own, ignore_errors=True)


def _forget_stale(parts: Path) -> None:
    for entry in parts.iterdir():
        with suppress(OSError):
            if time.time() - entry.stat().st_mtime > STALE_S:
                shutil.rmtree(entry, ignore_errors=True)
