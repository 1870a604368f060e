"""The parser of cue text with tables that are kept for the versions that made them.

Tables are a pickle, and whoever can write it can run code as the user who reads it: only a file that this user wrote
into a private folder is read, and only if it is whole.
"""

from __future__ import annotations

import sys
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib import resources
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.base.files.cache_folder import (
    NotPrivate,
    cache_folder,
    private_folder,
    remove_unused,
    sealed_content,
    write_sealed,
)

if TYPE_CHECKING:
    from lark import Lark

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
    if kept is not None and (tables := sealed_content(kept)) is not None:
        return lark.Lark.load(BytesIO(tables))
    made = lark.Lark(text, parser="lalr", lexer="contextual", propagate_positions=True, maybe_placeholders=False)
    if kept is not None:
        _keep(made, kept)
    return made


def _keep(made: Lark, file: Path) -> None:
    tables = BytesIO()
    made.save(tables)
    remove_unused(file.parent.iterdir(), STALE_S)
    with suppress(OSError):  # a full disk
        write_sealed(file, tables.getvalue())
