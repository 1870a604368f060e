"""The parser of cue text, whose tables are kept with the versions that made them.

Tables are a pickle, and whoever can write it can run code as the user who reads it: only a file that this user wrote
into a private folder is read, and only if it is whole.
"""

from __future__ import annotations

import os
import stat
import sys
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib import resources
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.base.files.cache_folder import (
    WRITABLE_BY_OTHERS,
    NotPrivate,
    cache_folder,
    private_folder,
    remove_unused,
)

if TYPE_CHECKING:
    from lark import Lark

HOW = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
STALE_S = 90 * 24 * 3600.0
"""Tables that were not used for this long are removed."""


@cache
def grammar() -> Lark:
    """The parser made of ``grammar.lark``."""
    import lark

    text = resources.files("thermicon.icons").joinpath("grammar.lark").read_text(encoding="utf-8")
    made_by = f"lark {lark.__version__} {sys.implementation.cache_tag}\n{Path(__file__).read_text('utf-8')}\n{text}"
    try:
        kept = private_folder(cache_folder() / "grammar") / sha256(made_by.encode()).hexdigest()[:40]
    except NotPrivate:
        kept = None
    if kept is not None and (tables := own_content(kept)) is not None:
        return lark.Lark.load(BytesIO(tables))
    made = lark.Lark(text, parser="lalr", lexer="contextual", propagate_positions=True, maybe_placeholders=False)
    if kept is not None:
        _keep(made, kept)
    return made


def own_content(file: Path) -> bytes | None:
    """What `_keep` wrote; None for no file, one of another user or that others can write, a link, and a broken one."""
    with suppress(OSError), os.fdopen(os.open(file, HOW), "rb") as opened:
        status = os.fstat(opened.fileno())
        if sys.platform != "win32" and (status.st_uid != os.geteuid() or status.st_mode & WRITABLE_BY_OTHERS):
            return None
        if stat.S_ISREG(status.st_mode):
            digest, content = opened.read(32), opened.read()
            return content if sha256(content).digest() == digest else None
    return None


def _keep(made: Lark, file: Path) -> None:
    from thermicon.base.files.atomic import OutputError, complete_or_absent

    tables = BytesIO()
    made.save(tables)
    remove_unused(file.parent.iterdir(), STALE_S)
    with suppress(OutputError, OSError), complete_or_absent(file) as draft:
        draft.chmod(0o600)
        draft.write_bytes(sha256(tables.getvalue()).digest() + tables.getvalue())
