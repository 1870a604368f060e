"""The formatter of cue texts."""

from collections.abc import Iterable

from thermicon.base.checks.arguments import checked

from ..model.format import header_lines
from ..model.units import LONGEST_NUMBER
from .grammar import grammar
from .parse import parse
from .source import Source, decode

_UNITS = ("ABSOLUTE", "DIFFERENCE", "RATE", "TIME", "CURRENT", "CURRENT_RATE", "UNIT")
_NO_BLANK_BEFORE = ("COMMA", "RSQB", "_DOTS", "LPAR", "RPAR")
_NO_BLANK_BEHIND = ("LSQB", "_DOTS", "LPAR")
Item = tuple[str, str]


@checked
def format_text(text: str | bytes, file: str = "<text>") -> str:
    r"""Return a cue text in canonical layout.

    Parameters
    ----------
    text
        A cue text without errors; bytes are decoded as UTF-8.
    file
        Name that errors show.

    Returns
    -------
    str
        A text of the same meaning, whose canonical layout is itself. Comments, units and digits are kept, except that
        ``°C`` replaces ``degC``; comments within a header move above it. Lines end with a line feed.

    Raises
    ------
    CueErrors
        With every error of the text, as ``parse``.

    Examples
    --------
    >>> print(format_text("cue 1; icon dip{cool by 6K at 3degC/s;hold for+.5 s # short\n return over 2. s}"), end="")
    cue 1
    <BLANKLINE>
    icon dip {
      cool by 6 K at 3 °C/s
      hold for 0.5 s  # short
      return over 2 s
    }
    """
    parse(text, file)
    layout, whole, end = _Layout(), Source(file, decode(text, file)).text, 0
    for token in grammar().parse_interactive(whole).iter_parse():
        if comment := whole[end : token.start_pos].strip():
            layout.take("COMMENT", comment)
        word = str(token).replace("degC", "°C") if token.type in _UNITS else str(token)
        layout.take(token.type, tidy_number(word) if token.type == "NUMBER" else word)
        end = token.end_pos or 0
    return "\n".join(layout.lines) + "\n"


def tidy_number(text: str) -> str:
    """Return a number with the digits it is written with, but no needless sign, zero or point.

    >>> [tidy_number(text) for text in ("+2", ".5", "2.", "−03", "0.50", "1E+05")]
    ['2', '0.5', '2', '-3', '0.50', '1e5']
    """
    plain = text.replace("−", "-").removeprefix("+").lower()
    mantissa, mark, exponent = plain.partition("e")
    whole, point, decimals = mantissa.removeprefix("-").partition(".")
    tidy = "-" if mantissa.startswith("-") else ""
    tidy += (whole.lstrip("0") or "0") + (point + decimals if decimals else "")
    tidy += f"e{int(exponent)}" if mark else ""
    return tidy if len(tidy) <= LONGEST_NUMBER else plain


class _Layout:
    """Takes items one by one and keeps the lines that they make."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.words: list[Item] = []
        # Comments within a header, which come to stand above it.
        self.notes: list[str] = []
        self.depth = 0
        # Of the source: nothing but blanks on this line so far, and a blank line passed since the last line written.
        self.fresh, self.gap = True, False
        # Of the lines written: the last one opens a block, or ends what a blank line follows.
        self.opened = self.ended = False

    def take(self, kind: str, word: str) -> None:
        if self.words and self.words[0][0] in ("ICON", "SET") and kind != "LBRACE":
            if kind == "COMMENT":
                self.notes.append(word)
            elif kind != "_NEWLINE":
                self.words.append((kind, word))
        elif kind == "_NEWLINE":
            self.finish()
            self.gap |= self.fresh
        elif kind == "SEMICOLON":
            self.finish()
            return
        elif kind == "COMMENT":
            self.finish()
            if self.fresh:
                self.put(word)
            else:  # it stays behind the line that stands before it in the source
                self.lines[-1] += f"  {word}"
        elif kind == "LBRACE":
            self.open()
        elif kind == "RBRACE":
            self.finish()
            self.depth -= 1
            self.gap = self.opened = False
            self.put("}")
            self.ended = self.depth == 0
        else:
            self.words.append((kind, word))
        self.fresh = kind == "_NEWLINE"

    def finish(self) -> None:
        if self.words:
            self.put(_joined(self.words))
            self.words = []
            self.ended = self.depth == 0

    def open(self) -> None:
        """Write the header of a block, below the comments within it."""
        first, *more = _header(self.words)
        for line in (*self.notes, first):
            self.put(line)
        self.lines += more
        self.words, self.notes = [], []
        self.depth += 1
        self.opened, self.gap = True, False

    def put(self, text: str) -> None:
        """Write a line, after a blank line where the source has one or where a block ends."""
        if self.lines and not self.opened and (self.gap or self.ended):
            self.lines.append("")
        self.lines.append("  " * self.depth + text)
        self.opened = self.ended = self.gap = False


def _header(words: list[Item]) -> list[str]:
    """The lines of a header, brace included; that of an icon may take one for each parameter and key."""
    if words[0][0] != "ICON":
        return [f"{_joined(words)} {{"]
    head: list[Item] = []
    parameters: list[list[Item]] = []
    keys: list[list[Item]] = []
    part, listed = head, False
    for kind, word in words:
        listed = (listed or kind == "LSQB") and kind != "RSQB"
        if kind == "LPAR" or (kind == "COMMA" and not listed):
            part = []
            parameters.append(part)
        elif kind == "KEY":
            part = [(kind, word)]
            keys.append(part)
        elif kind != "RPAR":
            part.append((kind, word))
    return header_lines(_joined(head), list(map(_joined, parameters)), list(map(_joined, keys)))


def _joined(words: Iterable[Item]) -> str:
    text, before = "", "LPAR"
    for kind, word in words:
        text += word if kind in _NO_BLANK_BEFORE or before in _NO_BLANK_BEHIND else f" {word}"
        before = kind
    return text
