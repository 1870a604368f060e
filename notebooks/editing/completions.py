"""What may follow in a cue text, for completion: taken from the tables of the grammar.

Each context (the file, a set, an icon) is a tree: its branches are the terminals that a statement may go on with.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from thermicon.icons.model.units import Kind

CONTEXTS = {"file": "cue 1\n", "set": "cue 1\nset a {\n", "icon": "cue 1\nicon a {\n"}
"""The text behind which each context begins."""

ENDS = frozenset({"_NEWLINE", "SEMICOLON", "RBRACE", "LBRACE", "LPAR", "RPAR", "COMMA", "BROKEN", "$END"})
"""Terminals that end a statement, or that nobody needs help with."""

LONGEST, LONGEST_HEADER = 12, 5
"""Terminals of a statement that are followed; a header may repeat its keys without end."""

UNIT_TERMINALS = ("ABSOLUTE", "DIFFERENCE", "RATE", "TIME", "CURRENT", "CURRENT_RATE")
"""Terminals that are a unit; each is called as its kind in ``thermicon.icons.model.units``."""

Tree = dict[str, Any]


@lru_cache(maxsize=1)
def completions() -> dict[str, Any]:
    """Return ``trees`` by context, ``words`` by terminal, and an example of each statement.

    >>> found = completions()
    >>> sorted(found["trees"]["icon"]["DIRECTION"]), found["words"]["DIRECTION"]
    (['BY', 'TO'], ['cool', 'warm'])
    >>> sorted(found["trees"]["icon"]["DIRECTION"]["BY"]["NUMBER"]), found["words"]["DIFFERENCE"]
    (['DIFFERENCE'], ['°C', 'degC', 'K'])
    """
    from thermicon.icons.language.source import grammar
    from thermicon.icons.model.words import CONTROLS, EXAMPLES

    trees = {}
    for context, text in CONTEXTS.items():
        parser = grammar().parse_interactive(text)
        for _ in parser.iter_parse():
            pass
        trees[context] = _tree(parser, LONGEST_HEADER if context == "file" else LONGEST)
    used = _names(list(trees.values()))
    words = {name: _words(name) for name in sorted(used) if name not in ("NUMBER", "NAME", "STRING", "TITLE")}
    examples = {word: text.partition('"')[2].partition('"')[0] for word, text in EXAMPLES.items() if '"' in text}
    return {"trees": trees, "words": words, "examples": examples, "controls": list(CONTROLS)}


def _tree(parser: Any, depth: int) -> Tree:
    """The terminals that a parser accepts here, each with what it accepts after them."""
    from lark import Token

    branches: Tree = {}
    for name in sorted(parser.accepts() - ENDS):
        after = parser.copy()
        after.feed_token(Token(name, "1"))
        branches[name] = _tree(after, depth - 1) if depth > 1 else {}
    return branches


def _names(trees: list[Tree]) -> set[str]:
    return {name for tree in trees for name in tree} | {
        name for tree in trees for name in _names([each for each in tree.values() if each])
    }


@lru_cache(maxsize=128)
def _words(terminal: str) -> list[str]:
    """The spellings of a terminal, in the order of the units or of the grammar."""
    from thermicon.icons.language.source import grammar
    from thermicon.icons.model.units import UNITS

    if terminal in UNIT_TERMINALS:
        return list(UNITS[cast("Kind", terminal.lower())])
    pattern = next(each.pattern for each in grammar().terminals if each.name == terminal)
    if pattern.type == "str":
        return [pattern.value]
    return sorted(pattern.value.removeprefix("(?:").removesuffix(")").replace("\\", "").split("|"))
