"""Rankings that were computed before, in the user's own cache: asked for again, they are read instead of computed.

A ranking depends on nothing but what it was asked with and the code and libraries that computed it. A hash of all that
is its name. The file is a pickle, which can run code as the user who reads it: it begins with a hash of its content, is
read only from a folder that nobody else can write to, and whatever is wrong with it counts as absent.
"""

from __future__ import annotations

import hashlib
import pickle
import platform
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.userfolder import NotPrivate, cache_folder, private_folder, read_private, write_private

if TYPE_CHECKING:
    from thermicon.perception import Ranking

MOST_KEPT = 50
"""About 0.2 MB each."""
HASH_BYTES = 32
LIBRARIES = ("numpy", "scipy", "numba")


def recall(asked: str) -> Ranking | None:
    """Return the ranking that was computed before for what was asked; None where there is none.

    `asked` names everything that the result depends on, but for code and libraries.
    """
    from thermicon.perception import Ranking

    if (path := _path(asked)) is None or (data := read_private(path)) is None:
        return None
    if hashlib.sha256(data[HASH_BYTES:]).digest() != data[:HASH_BYTES]:
        return None
    with suppress(Exception):  # a pickle of another version of a class can fail in any way
        ranking = pickle.loads(data[HASH_BYTES:])
        path.touch()
        return ranking if isinstance(ranking, Ranking) else None
    return None


def remember(asked: str, ranking: Ranking) -> None:
    """Keep a ranking; where that is not possible, it is computed again the next time."""
    if (path := _path(asked)) is None:
        return
    content = pickle.dumps(ranking)
    with suppress(OSError):
        write_private(path, hashlib.sha256(content).digest() + content)
        kept = sorted(path.parent.glob("*.ranking"), key=lambda each: each.stat().st_mtime)
        for old in kept[:-MOST_KEPT]:
            old.unlink(missing_ok=True)


def _path(asked: str) -> Path | None:
    from thermicon.circuit.program import DRIVES, code_digest

    try:
        folder = private_folder(cache_folder() / "rankings")
    except NotPrivate:
        return None
    made_by = [code_digest((*DRIVES, "thermicon.perception")), platform.python_version(), platform.machine()]
    made_by += [version(name) for name in LIBRARIES]
    name = hashlib.sha256("\0".join([*made_by, asked]).encode("utf-8")).hexdigest()
    return folder / f"{name[:40]}.ranking"
