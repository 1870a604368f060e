"""The formatter: a cue text in canonical layout, one statement per line; comments and numbers are kept."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ..model.format import header_lines
from ..model.units import LONGEST_NUMBER
from .parse import parse
from .source import Source, decode, grammar

_UNITS = ("ABSOLUTE", "DIFFERENCE", "RATE", "TIME", "CURRENT", "CURRENT_RATE", "UNIT")
_NO_BLANK_BEFORE = ("COMMA", "RSQB", "_DOTS", "LPAR", "RPAR")
_NO_BLANK_BEHIND = ("LSQB", "_DOTS", "LPAR")
Item = tuple[str, str]


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
        ``°C`` replaces ``degC``. Lines end with a line feed.

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
    layout = _Layout()
    for kind, word in _items(Source(file, decode(text, file)).text):
        layout.take(kind, word)
    return "\n".join(layout.lines) + "\n"


def _items(text: str) -> Iterator[Item]:
    """Yield kind and canonical spelling of every token of a sound text, and of the comments between them."""
    end = 0
    for token in grammar().parse_interactive(text).iter_parse():
        if comment := text[end : token.start_pos].strip():
            yield "COMMENT", comment
        word = str(token)
        if token.type == "NUMBER":
            word = tidy_number(word)
        elif token.type in _UNITS:
            word = word.replace("degC", "°C")
        yield token.type, word
        end = token.end_pos or 0


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
        self.header: _Header | None = None
        # Comments between the name of the set and its brace.
        self.set_notes: list[str] = []
        self.depth = 0
        # Of the source: nothing but blanks on this line so far, and a blank line passed since the last line written.
        self.fresh, self.gap = True, False
        # Of the lines written: the last one opens a block, or ends what a blank line follows.
        self.opened = self.ended = False

    def take(self, kind: str, word: str) -> None:
        """Take the next item."""
        if self.header is not None and kind != "LBRACE":
            self.header.take(kind, word, own_line=self.fresh)
        elif self.words and self.words[0][0] == "SET" and kind in ("_NEWLINE", "COMMENT"):
            self.set_notes += [word] * (kind == "COMMENT")
        elif kind == "_NEWLINE":
            self.finish()
            self.gap |= self.fresh
        elif kind == "SEMICOLON":
            self.finish()
            return
        elif kind == "COMMENT":
            self.finish()
            self.comment(word)
        elif kind == "LBRACE":
            self.open()
        elif kind == "RBRACE":
            self.finish()
            self.depth -= 1
            self.gap = self.opened = False
            self.put("}")
            self.ended = self.depth == 0
        elif kind == "ICON":
            self.header = _Header()
        else:
            self.words.append((kind, word))
        self.fresh = kind == "_NEWLINE"

    def finish(self) -> None:
        """Write the statement that was taken, if there is one."""
        if self.words:
            self.put(_joined(self.words))
            self.words = []
            self.ended = self.depth == 0

    def comment(self, text: str) -> None:
        """Write a comment: behind the line that stands before it in the source, or on a line of its own."""
        if self.fresh:
            self.put(text)
        else:
            self.lines[-1] += f"  {text}"

    def open(self) -> None:
        """Write the header of a block."""
        first, *more = self.header.lines() if self.header is not None else [f"{_joined(self.words)} {{"]
        notes, self.set_notes = self.set_notes, []
        self.put(f"{first}  {notes[0]}" if notes else first)
        self.lines += [*more, *(f"  {note}" for note in notes[1:])]
        self.words, self.header = [], None
        self.depth += 1
        self.opened, self.gap = True, False

    def put(self, text: str) -> None:
        """Write a line, after a blank line where the source has one or where a block ends."""
        if self.lines and not self.opened and (self.gap or self.ended):
            self.lines.append("")
        self.lines.append("  " * self.depth + text)
        self.opened = self.ended = self.gap = False


@dataclass(slots=True)
class _Row:
    """A part of a header: its kind (head, parameter, close, key or comment), its text, the comment behind it."""

    kind: str
    text: str
    comment: str = ""

    def line(self) -> str:
        """Return the row as a line."""
        indent = "" if self.kind in ("head", "close") else "  "
        return f"{indent}{self.text}  {self.comment}" if self.comment else indent + self.text


class _Header:
    """Takes the items of an icon's header, up to its brace, and lays them out."""

    def __init__(self) -> None:
        self.rows = [_Row("head", "icon")]
        self.words: list[Item] = [("ICON", "icon")]
        self.inside = self.listed = False

    def take(self, kind: str, word: str, own_line: bool) -> None:
        """Take the next item; ``own_line`` tells whether it is the first of its line."""
        if kind == "_NEWLINE":
            return
        if kind == "COMMENT":
            if own_line:
                self.rows.append(_Row("comment", word))
            else:
                self.part().comment = word
            return
        new = "close" if kind == "RPAR" else "key" if kind == "KEY" else ""
        if self.inside and not new and self.part().text.endswith(("(", ",")) and not self.listed:
            new = "parameter"
        if new:
            self.rows.append(_Row(new, ""))
            self.words = []
        self.words.append((kind, word))
        self.part().text = _joined(self.words)
        self.inside = (self.inside or kind == "LPAR") and kind != "RPAR"
        self.listed = (self.listed or kind == "LSQB") and kind != "RSQB"

    def part(self) -> _Row:
        """Return the part taken last that is not a comment."""
        return next(row for row in reversed(self.rows) if row.kind != "comment")

    def lines(self) -> list[str]:
        """Return the lines of the header, brace included."""
        parameters = [row.text.removesuffix(",") for row in self.rows if row.kind == "parameter"]
        keys = [row.text for row in self.rows if row.kind == "key"]
        head = self.rows[0].text.removesuffix("(")
        if not any(row.comment or row.kind == "comment" for row in self.rows):
            return header_lines(head, parameters, keys)
        close = next((n for n, row in enumerate(self.rows) if row.kind == "close"), 0)
        listed, rest = self.rows[: close + 1], self.rows[close + 1 :]
        if close and not any(row.comment or row.kind == "comment" for row in listed[:-1]):
            rows = header_lines(head, parameters, [])
            rows[-1] = rows[-1].removesuffix(" {")
            listed = [*(_Row("head", row) for row in rows[:-1]), _Row("close", rows[-1], listed[-1].comment)]
        found = [row.line() for row in (*listed, *rest)]
        if rest or listed[-1].comment:
            return [*found, "{"]
        return [*found[:-1], f"{found[-1]} {{"]


def _joined(words: Iterable[Item]) -> str:
    """Return words with single spaces between them, except beside brackets, commas and dots."""
    text, before = "", "LPAR"
    for kind, word in words:
        text += word if kind in _NO_BLANK_BEFORE or before in _NO_BLANK_BEHIND else f" {word}"
        before = kind
    return text
