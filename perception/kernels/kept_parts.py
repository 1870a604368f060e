"""Parts of a long computation that are kept until it is done so that who dies in between can go on.

They are pickles, and whoever can write one can run code as the user who reads it: only sealed files of this user's
private folder are read.
"""

from __future__ import annotations

import logging
import pickle
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from thermicon.base.files.cache_folder import (
    cache_folder,
    private_folder,
    remove_unused,
    sealed_content,
    write_sealed,
)

STALE_S = 30 * 24 * 3600.0
"""Parts of a computation that nobody went on with are removed after this time."""
MOST = 2_000_000_000
"""Bytes that are kept of all computations; what comes after them is computed again."""

_STAGES: ContextVar[list[tuple[KeptParts, int]] | None] = ContextVar("stages that are done", default=None)


@contextmanager
def kept_until_done() -> Iterator[None]:
    """Keep the parts of every stage within until all are done: who dies in the last does not begin with the first.

    Also a decorator; the outermost removes them. Where an error is raised they stay.
    """
    if _STAGES.get() is not None:
        yield
        return
    stages: list[tuple[KeptParts, int]] = []
    token = _STAGES.set(stages)
    try:
        yield
    finally:
        _STAGES.reset(token)
    for kept, count in stages:
        kept.forget(count)


@dataclass(frozen=True, slots=True)
class KeptParts:
    """Parts of the computation with a key that names it and its code; none where `folder` is None."""

    folder: Path | None
    key: str

    @classmethod
    def of(cls, key: str) -> KeptParts:
        """The parts that are kept, or can be kept, in the user's private folder; one line says why none can."""
        try:
            folder = private_folder(cache_folder() / "parts")
            remove_unused(folder.iterdir(), STALE_S)
        except OSError as problem:
            logging.getLogger("thermicon").warning("nothing is kept for a client that dies: %s", problem)
            return cls(None, key)
        return cls(folder, key)

    def whole(self, count: int) -> Iterator[tuple[int, Any]]:
        """Parts below `count` that are kept whole, with their numbers; another client may remove them meanwhile."""
        for number in range(count):
            content = None if self.folder is None else sealed_content(self._file(number))
            if content is not None:
                yield number, pickle.loads(content)

    def write(self, number: int, part: Any) -> None:
        """Keep a part where there is room for it."""
        if self.folder is None:
            return
        content = pickle.dumps(part)
        with suppress(OSError):  # a full disk, or another client that is done with the same parts
            if len(content) + sum(file.stat().st_size for file in self.folder.iterdir()) <= MOST:
                write_sealed(self._file(number), content)

    def done(self, count: int) -> None:
        """Remove the parts of a stage that is done, now or with the others that it belongs to."""
        if (stages := _STAGES.get()) is None:
            self.forget(count)
        else:
            stages.append((self, count))

    def forget(self, count: int) -> None:
        """Remove parts."""
        if self.folder is not None:
            with suppress(OSError):
                for number in range(count):
                    self._file(number).unlink(missing_ok=True)

    def _file(self, number: int) -> Path:
        assert self.folder is not None
        return self.folder / f"{self.key}-{number}"
