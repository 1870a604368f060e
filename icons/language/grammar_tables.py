"""The parser of cue text, with its tables kept in the user's cache: making them takes longer than reading a file."""

import hashlib
import io
from contextlib import suppress
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

from ..atomic import OutputError
from ..userfolder import NotPrivate, cache_folder, opened, private_folder, read_private, sealed, write_private

if TYPE_CHECKING:
    from lark import Lark


@cache
def grammar() -> "Lark":
    """Return the parser made of ``grammar.lark``; on first use, from the tables kept for this text, if there are any.

    >>> grammar().options.parser
    'lalr'
    """
    import lark

    text = resources.files("thermicon.icons").joinpath("grammar.lark").read_text(encoding="utf-8")
    name = hashlib.sha256(f"{lark.__version__}\0{text}".encode()).hexdigest()[:40]
    try:
        kept = private_folder(cache_folder() / "grammar") / name
    except NotPrivate:
        return built(text)
    if (parser := unpacked(read_private(kept))) is None:
        parser = built(text)
        with suppress(OutputError):
            write_private(kept, packed(parser))
    return parser


def built(text: str) -> "Lark":
    """Return the parser of a grammar, its tables computed."""
    from lark import Lark

    return Lark(text, parser="lalr", lexer="contextual", propagate_positions=True, maybe_placeholders=False)


def packed(parser: "Lark") -> bytes:
    """Return the tables of a parser as bytes that begin with their own hash."""
    tables = io.BytesIO()
    parser.save(tables)
    return sealed(tables.getvalue())


def unpacked(data: bytes | None) -> "Lark | None":
    """Return the parser of packed tables; None where there are none, or where they are damaged.

    >>> unpacked(b"damaged") is None
    True
    """
    if (tables := opened(data)) is None:
        return None
    from lark import Lark

    try:
        return Lark.load(io.BytesIO(tables))
    except Exception:  # of another version of lark that has the same number
        return None
