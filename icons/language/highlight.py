"""Colours for cue text: a Pygments lexer, which ``pygmentize``, Sphinx, mkdocs and rich find once it is installed.

It is called ``cue`` and, for the day when Pygments knows the CUE configuration language, ``thermal-cue``. Words and
units come from ``words`` and ``units``; only those that stand inside of a statement are listed here.
"""

import re
from collections.abc import Callable
from typing import Any, ClassVar

from pygments.lexer import RegexLexer, bygroups, default, words
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Whitespace

from ..model.units import UNITS
from ..model.words import CONTROLS, NOT_YET, VOCABULARY

CLAUSES = ("by", "to", "at", "over", "for", "every", "in", "step", "starting", "cut", "most", "least", "up", "down")
_METADATA = VOCABULARY["header"]
_SETTINGS = tuple(word for word in VOCABULARY["set"] if word not in _METADATA)
KEYWORDS = frozenset((*VOCABULARY["file"], *_METADATA, *_SETTINGS, *VOCABULARY["icon"], *CLAUSES))
SPELLINGS = tuple(sorted({unit for units in UNITS.values() for unit in units if unit}, key=len, reverse=True))

# Both as in the grammar; a test compares them.
NUMBER = r"[+\-\u2212]?([0-9]+(\.(?!\.)[0-9]*)?|\.[0-9]+)([eE][+\-\u2212]?[0-9]+)?"
NAME = r"[^\W\d_](?:[^\W_]|-)*(?:_[^\W\d_](?:[^\W_]|-)*=-?[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?)*"
_each: Callable[..., Any] = bygroups
_BLANK = r"[ \t\u00a0\u202f]+"
_END = r"(?![^\W_]|-)"
_UNIT = "|".join(map(re.escape, SPELLINGS))
_VERSION = re.compile(r"\ufeff?(?:[ \t]*(?:#[^\n]*)?[;\n])*[ \t]*cue[ \t]+[0-9]")


class CueLexer(RegexLexer):
    """Cue text as Pygments tokens; a word that the language does not know is a plain name, and no error."""

    name: ClassVar[str] = "Thermal cue"
    aliases: ClassVar[list[str]] = ["cue", "thermal-cue"]
    filenames: ClassVar[list[str]] = ["*.cue"]
    mimetypes: ClassVar[list[str]] = ["text/x-thermal-cue"]

    tokens: ClassVar = {
        "root": [
            (r"\s+", Whitespace),
            (r"#[^\n]*", Comment.Single),
            (r'"', String.Double, "text"),
            # A name may be any word, "hold" too, so it is recognised by what stands before or after it.
            (rf"(icon)({_BLANK})({NAME})", _each(Keyword.Declaration, Whitespace, Name.Function)),
            (rf"(play)({_BLANK})({NAME})", _each(Keyword, Whitespace, Name.Function)),
            (rf"(set)({_BLANK})({NAME})", _each(Keyword.Declaration, Whitespace, Name.Class)),
            (rf"(control)({_BLANK})({'|'.join(CONTROLS)}){_END}", _each(Keyword, Whitespace, Keyword.Constant)),
            (rf"(site|control)({_BLANK})({NAME})", _each(Keyword, Whitespace, Name.Constant)),
            (rf"(starting)({_BLANK})(warm|cool|up|down){_END}", _each(Keyword, Whitespace, Keyword.Constant)),
            (rf"(at)({_BLANK})(most|least){_END}", _each(Keyword, Whitespace, Keyword)),
            (rf"({'|'.join(_METADATA)})({_BLANK})?(?=\")", _each(Name.Attribute, Whitespace)),
            (
                rf"(by|to|at|over|for|every|repeat|total)({_BLANK})(?!at{_END})({NAME})",
                _each(Keyword, Whitespace, Name.Variable),
            ),
            (rf"({NAME})(?={_BLANK}in{_BLANK}?[\[+\-\u2212.0-9])", Name.Variable),
            (words(VOCABULARY["file"], suffix=_END), Keyword.Declaration),
            (words((*_SETTINGS, *VOCABULARY["icon"], *CLAUSES), suffix=_END), Keyword),
            (words(tuple(NOT_YET), suffix=_END), Keyword.Reserved),
            (r"\.\.", Operator),
            (NUMBER, Number, "unit"),
            (r"\]", Punctuation, "unit"),
            (r"[{};(),\[]", Punctuation),
            (NAME, Name),
        ],
        "unit": [  # what may stand behind a number, or behind a list of them
            (rf"({_BLANK})?({_UNIT})(?![^\W_]|[-/])", _each(Whitespace, Keyword.Type), "#pop"),
            default("#pop"),
        ],
        "text": [
            (r'\\["\\n]', String.Escape),
            (r'[^"\\\n]+', String.Double),
            (r'"|(?=\n)', String.Double, "#pop"),
        ],
    }

    # Pygments makes it a static method.
    def analyse_text(text: str) -> float:  # type: ignore[override,misc]
        """Tell cue text from other files called ``.cue`` by its version line."""
        return 1.0 if _VERSION.match(text) else 0.0
