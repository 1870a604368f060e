"""The source text of a cue file and the places in it."""

import re
from bisect import bisect_right
from dataclasses import dataclass, field

from ..model.errors import CueError, whole_file

# Some three thousand icons; every text of this size is read or refused within a few seconds.
MOST_BYTES = 250_000
_MOST_BEHIND = 50


def _cut(number: str, mark: str, other: str) -> re.Pattern[str]:
    return re.compile(
        rf"""(?P<blank>[ \t\u00a0\u202f]+|\#[^\n]*)
          | (?P<text>"(?:[^"\\\n]|\\[^\n])*"?)
          | (?P<number>[+\-\u2212]?(?:{number})(?:[eE][+\-\u2212]?\d+)?)
          | (?P<word>(?:[^\W\d]|[°º˚℃℉])[\w°\-]*(?:/[^\W\d]+)?)
          | (?P<mark>{mark})
          | (?P<other>{other})""",
        re.VERBOSE,
    )


# Coarser than the grammar on purpose: a piece is what a reader would call one word, right or wrong. Between the
# parentheses of a family commas, dots and brackets stand close to the numbers, and lines may end.
_PIECE = _cut(r"\d[\d.,_]*|\.\d[\d.,_]*", r"[{};\n]", ".")
_FINE = _cut(r"\d[\d_]*(?:\.(?!\.)[\d_]*)?|\.\d[\d_]*", r"[{}]", r"\.\.|\n|.")

# How files begin that people hand in for text.
_OTHERS = {
    b"PK\3\4": "a Word document, a workbook or a zip archive",
    b"%PDF-": "a PDF document",
    b"\x89PNG": "a picture (PNG)",
    b"\xff\xd8\xff": "a picture (JPEG)",
}


@dataclass(frozen=True, slots=True)
class Piece:
    """One word, number, text or mark of the source, from ``start`` to before ``end``."""

    kind: str
    text: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Patch:
    """A change to the source that may cure an error: put ``text`` where ``start`` to before ``end`` is now."""

    start: int
    end: int
    text: str


@dataclass(frozen=True, slots=True)
class Finding:
    """An error by offsets, with the cures to try; it becomes a CueError when its line is known."""

    code: str
    start: int
    end: int
    what: str
    help: str = ""
    cures: tuple[Patch, ...] = ()


@dataclass(frozen=True, slots=True)
class Source:
    """A text with its file name; newlines are ``\\n`` and the last line ends with one."""

    file: str
    text: str
    lines: tuple[str, ...] = field(init=False, repr=False)
    starts: tuple[int, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        text = self.text.replace("\r\n", "\n").replace("\r", "\n")
        text = text if text.endswith("\n") else text + "\n"
        lines = tuple(text[:-1].split("\n"))
        starts = [0]
        for line in lines:
            starts.append(starts[-1] + len(line) + 1)
        object.__setattr__(self, "text", text)
        object.__setattr__(self, "lines", lines)
        object.__setattr__(self, "starts", tuple(starts[:-1]))

    def place(self, offset: int) -> tuple[int, int]:
        """Return line and column, both from 1, of a character offset."""
        row = bisect_right(self.starts, offset) - 1
        return row + 1, offset - self.starts[row] + 1

    def error(self, finding: Finding, suggestion: str | None = None) -> CueError:
        """Return a finding as an error with its line; carets stop at the end of the line."""
        line, column = self.place(finding.start)
        text = self.lines[line - 1]
        length = max(1, min(finding.end - finding.start, len(text) - column + 1))
        return CueError(
            finding.code, self.file, line, column, length, text, finding.what, finding.help, suggestion=suggestion
        )

    def pieces(self, start: int, after: int, listing: bool = False, braces: bool = False) -> list[Piece]:
        """Cut the text into pieces up to a newline, ``;`` or brace from ``after`` on, and at most 50 behind it.

        ``listing`` cuts finer and goes on over line ends; ``braces``: a pair of them at ``after`` holds values.
        """
        found: list[Piece] = []
        behind = 0
        braced = False
        for match in (_FINE if listing else _PIECE).finditer(self.text, start):
            kind = match.lastgroup or "other"
            behind += match.start() >= after
            braced |= braces and match.group() == "{" and match.start() == after
            if (kind == "mark" and match.start() >= after and not braced) or behind > _MOST_BEHIND:
                break
            braced &= match.group() != "}"
            if kind != "blank" and match.group() != "\n":
                found.append(Piece(kind, match.group(), match.start(), match.end()))
        return found

    def stop(self, start: int) -> int:
        """Return the offset of the first newline, ``;`` or brace at or behind ``start``, outside texts and comments."""
        ends = (match.start() for match in _PIECE.finditer(self.text, start) if match.lastgroup == "mark")
        return next(ends, len(self.text))

    def stop_listing(self, start: int, braces: bool) -> int:
        """Return the offset of the ``{`` behind the parentheses that ``start`` lies in, or else of ``stop``."""
        for match in _FINE.finditer(self.text, self.close(start) + 1 if braces else start):
            text = match.group()
            if text in ("{", "}") or (match.lastgroup == "word" and text in ("icon", "set")):
                return match.start() if text == "{" else self.stop(start)
        return self.stop(start)

    def close(self, brace: int) -> int:
        """Return the offset of the ``}`` that matches the ``{`` at ``brace``, or the length of the text."""
        depth = 0
        for match in _PIECE.finditer(self.text, brace):
            if match.group() == "{":
                depth += 1
            elif match.group() == "}":
                depth -= 1
                if depth == 0:
                    return match.start()
        return len(self.text)


def decode(data: str | bytes, file: str) -> str:
    """Return the text of a cue file; CueErrors when it is too large, empty, binary or not UTF-8."""
    size = len(data)
    if size > MOST_BYTES:
        raise whole_file("E004", file, f"{size:,} bytes", f"a cue file has at most {MOST_BYTES:,} bytes; split the set")
    if isinstance(data, bytes):
        for mark, kind in _OTHERS.items():
            if data.startswith(mark):
                raise whole_file("E006", file, f"this is {kind}", "a cue file is plain UTF-8 text")
        if b"\0" in data:
            what = f"a zero byte at byte offset {data.index(0)}"
            raise whole_file("E006", file, what, "a cue file is plain UTF-8 text, not UTF-16 and not a document")
        try:
            data = data.decode("utf-8")
        except UnicodeDecodeError as error:
            line = error.object.count(b"\n", 0, error.start) + 1
            what = f"byte 0x{error.object[error.start]:02X} at byte offset {error.start}, on line {line}, is not UTF-8"
            raise whole_file("E007", file, what, "save the file as UTF-8 in your editor") from None
    if "\0" in data:
        line = data.count("\n", 0, data.index("\0")) + 1
        raise whole_file("E006", file, f"a zero byte is on line {line}", "a cue file is plain UTF-8 text")
    if any("\ud800" <= char <= "\udfff" for char in data):
        raise whole_file("E007", file, "half a character (a lone surrogate) in the text", "save the file as UTF-8")
    text = data.removeprefix("\ufeff")
    if not text.strip():
        raise whole_file("E005", file, "nothing but white space", 'a cue file begins with "cue 1" and holds icons')
    return text
