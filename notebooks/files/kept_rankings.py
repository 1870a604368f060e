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
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.userfolder import (
    NotPrivate,
    cache_folder,
    opened,
    private_folder,
    read_private,
    sealed,
    write_private,
)

if TYPE_CHECKING:
    from thermicon.perception import Ranking

MOST_KEPT = 50
"""About 0.2 MB each."""
LIBRARIES = ("numpy", "scipy", "numba")


def recall(asked: str) -> Ranking | None:
    """Return the ranking that was computed before for what was asked; None where there is none.

    `asked` names everything that the result depends on, but for code and libraries.
    """
    from thermicon.perception import Ranking

    if (path := _path(asked)) is None or (content := opened(read_private(path))) is None:
        return None
    with suppress(Exception):  # a pickle of another version of a class can fail in any way
        ranking = pickle.loads(content)
        path.touch()
        return ranking if isinstance(ranking, Ranking) else None
    return None


def remember(asked: str, ranking: Ranking) -> None:
    """Keep a ranking; where that is not possible, it is computed again the next time."""
    if (path := _path(asked)) is None:
        return
    with suppress(OSError):
        write_private(path, sealed(pickle.dumps(ranking)))
        kept = sorted(path.parent.glob("*.ranking"), key=lambda each: each.stat().st_mtime)
        for old in kept[:-MOST_KEPT]:
            old.unlink(missing_ok=True)


@cache
def _made_by() -> tuple[str, ...]:
    """Code, Python, processor and libraries that compute a ranking."""
    from thermicon.circuit.program import DRIVES, code_digest

    code = code_digest((*DRIVES, "thermicon.perception"))
    return (code, platform.python_version(), platform.machine(), *map(version, LIBRARIES))


def _path(asked: str) -> Path | None:
    try:
        folder = private_folder(cache_folder() / "rankings")
    except NotPrivate:
        return None
    name = hashlib.sha256("\0".join([*_made_by(), asked]).encode("utf-8")).hexdigest()
    return folder / f"{name[:40]}.ranking"
