"""Colours of a notebook's cells: a cell of cue text is cue text, any other one is Python."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from pygments.lexer import Lexer
from pygments.lexers.python import Python3Lexer
from pygments.token import Comment, _TokenType

from thermicon.icons.language.highlight import CueLexer

MAGIC = re.compile(r"%%?\w+[^\n]*\n?")


class CellLexer(Lexer):
    """Lexer of a cell that may begin with a magic line."""

    name, aliases = "Notebook cell", ("ipython3",)

    def get_tokens_unprocessed(self, text: str) -> Iterator[tuple[int, _TokenType, str]]:
        """Yield place, kind and text of each token."""
        magic = MAGIC.match(text)
        begin = magic.end() if magic else 0
        if magic:
            yield 0, Comment.Special, magic[0]
        rest: Any = CueLexer() if text.startswith("%%cue") else Python3Lexer()
        for place, kind, value in rest.get_tokens_unprocessed(text[begin:]):
            yield begin + place, kind, value
